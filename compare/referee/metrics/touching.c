/* Penetration depth is max(0, -gap) in m, over all pairs, frame by frame.
 *
 * Islands are two partitions by disjoint sets: of this frame, and of this frame and the last
 * together. Source: Galler and Fischer 1964; path halving, Tarjan and van Leeuwen 1984. */
#include "modules.h"

#include "series.h"

#include <math.h>
#include <string.h>

struct pl_touching {
    const pl_scene *scene;
    long step; /* of the current frame */

    pl_series depth; /* of each touching pair (gap <= 0) at each step */
    double deepest;  /* so far in the current frame */
    long rest_from;  /* first step of the last second */
    double rest_sum; /* of the deepest of each frame */
    long rest_count;
    bool met_static;
    int unknown_a, unknown_b; /* the first pair whose gap could not be computed */
    long unknown_step;        /* -1: none */

    int *now, *both; /* (body_count): parents; a root is its own parent and the least of its set */
    double *sum;     /* (body_count): by root */
    bool *met, *last_met;         /* (body_count): meets another body in a frame */
    double *depths, *last_depths; /* (body_count): sums of a body's overlaps in a frame, m */
};

static void separate(int *parents, int count)
{
    for (int i = 0; i < count; ++i) {
        parents[i] = i;
    }
}

pl_touching *pl_touching_create(const pl_scene *scene, pl_arena *arena)
{
    size_t count = (size_t)scene->body_count;
    pl_touching *t = pl_arena_take(arena, 1, sizeof *t);
    pl_series_init(&t->depth, arena);
    t->scene = scene;
    t->rest_from = pl_scene_steps(scene) - lround(1 / scene->dt) + 1;
    t->unknown_step = -1;
    t->now = pl_arena_take(arena, count, sizeof *t->now);
    t->both = pl_arena_take(arena, count, sizeof *t->both);
    t->sum = pl_arena_take(arena, count, sizeof *t->sum);
    t->met = pl_arena_take(arena, count, sizeof *t->met);
    t->last_met = pl_arena_take(arena, count, sizeof *t->last_met);
    t->depths = pl_arena_take(arena, count, sizeof *t->depths);
    t->last_depths = pl_arena_take(arena, count, sizeof *t->last_depths);
    separate(t->now, scene->body_count);
    return t;
}

static int root_of(int *parents, int body)
{
    while (parents[body] != body) {
        parents[body] = parents[parents[body]];
        body = parents[body];
    }
    return body;
}

static void unite(int *parents, int a, int b)
{
    int root_a = root_of(parents, a), root_b = root_of(parents, b);
    parents[root_a > root_b ? root_a : root_b] = root_a > root_b ? root_b : root_a;
}

void pl_touching_begin(pl_touching *t, long step)
{
    t->step = step;
    t->deepest = 0;
    memcpy(t->both, t->now, (size_t)t->scene->body_count * sizeof *t->both);
    separate(t->now, t->scene->body_count);
    memcpy(t->last_depths, t->depths, (size_t)t->scene->body_count * sizeof *t->depths);
    memset(t->depths, 0, (size_t)t->scene->body_count * sizeof *t->depths);
    memcpy(t->last_met, t->met, (size_t)t->scene->body_count * sizeof *t->met);
    memset(t->met, 0, (size_t)t->scene->body_count * sizeof *t->met);
}

void pl_touching_see(void *touching, const pl_near_pair *pair)
{
    pl_touching *t = touching;
    const pl_body *bodies = t->scene->bodies;
    if (pair->meets) {
        t->met[pair->a] = t->met[pair->b] = true;
    }
    if (pair->meets && (bodies[pair->a].is_static || bodies[pair->b].is_static)) {
        t->met_static = true;
    } else if (pair->meets) {
        unite(t->now, pair->a, pair->b);
        unite(t->both, pair->a, pair->b);
    }
    if (pair->status != PL_OK) {
        if (t->unknown_step < 0) {
            t->unknown_step = t->step;
            t->unknown_a = pair->a;
            t->unknown_b = pair->b;
        }
    } else if (pair->gap <= 0) {
        t->deepest = fmax(t->deepest, -pair->gap);
        t->depths[pair->a] -= pair->gap;
        t->depths[pair->b] -= pair->gap;
        if (t->step > 0) {
            pl_series_add(&t->depth, -pair->gap, t->step);
        }
    }
}

void pl_touching_end(pl_touching *t)
{
    if (t->step > 0 && t->step >= t->rest_from) {
        t->rest_sum += t->deepest;
        t->rest_count += 1;
    }
}

bool pl_touching_static(const pl_touching *t)
{
    return t->met_static;
}

int pl_touching_island(pl_touching *t, int body)
{
    return root_of(t->both, body);
}

double pl_touching_deepest(const pl_touching *t)
{
    return t->deepest;
}

double pl_touching_depth(const pl_touching *t, int body)
{
    return t->depths[body] + t->last_depths[body];
}

bool pl_touching_flew(const pl_touching *t, int body)
{
    return !t->met[body] && !t->last_met[body];
}

double pl_touching_island_max(pl_touching *t, const double *growth)
{
    const pl_scene *scene = t->scene;
    double largest = -HUGE_VAL;
    memset(t->sum, 0, (size_t)scene->body_count * sizeof *t->sum);
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            t->sum[root_of(t->both, i)] += growth[i];
        }
    }
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static && root_of(t->both, i) == i) {
            largest = fmax(largest, isnan(t->sum[i]) ? HUGE_VAL : t->sum[i]);
        }
    }
    return largest > -HUGE_VAL ? largest : 0;
}

/* Both metrics are PL_METRIC_FAILED if the gap of any pair could not be computed. */
static void collect(void *state, const pl_run_view *view, pl_metric *item)
{
    (void)state;
    const pl_touching *t = view->touching;
    if (view->scene->body_count < 2) {
        return;
    }
    double mean = t->rest_count > 0 ? t->rest_sum / (double)t->rest_count : 0;
    item[PL_METRIC_PENETRATION_MAX] = pl_series_metric(&t->depth, t->depth.max);
    item[PL_METRIC_PENETRATION_REST] = pl_metric_value(mean);
    if (t->unknown_step >= 0) {
        item[PL_METRIC_PENETRATION_MAX] = item[PL_METRIC_PENETRATION_REST] =
            pl_metric_failed("no gap found for \"%.30s\" and \"%.30s\" at step %ld",
                             t->scene->bodies[t->unknown_a].name,
                             t->scene->bodies[t->unknown_b].name, t->unknown_step);
    }
}

const pl_module pl_touching_module = {NULL, NULL, collect, .needs_no_motion = false};
