/* Penetration depth is max(0, -gap) in m, over all pairs, frame by frame.
 *
 * Islands are two partitions by disjoint sets: of this frame, and of this frame and the last
 * together. Source: Galler and Fischer 1964; path halving, Tarjan and van Leeuwen 1984. */
#include "modules.h"

#include <math.h>
#include <string.h>

static void separate(int *parents, int count)
{
    for (int i = 0; i < count; ++i) {
        parents[i] = i;
    }
}

pl_touching *pl_touching_create(const pl_scene *scene, pl_series *depths, pl_arena *arena)
{
    size_t count = (size_t)scene->body_count;
    pl_touching *t = pl_arena_take(arena, 1, sizeof *t);
    t->scene = scene;
    t->depths = depths;
    t->bodies = pl_arena_take(arena, count, sizeof *t->bodies);
    t->rest_from = pl_scene_steps(scene) - lround(1 / scene->dt) + 1;
    t->unknown_step = -1;
    t->now = pl_arena_take(arena, count, sizeof *t->now);
    t->both = pl_arena_take(arena, count, sizeof *t->both);
    t->sum = pl_arena_take(arena, count, sizeof *t->sum);
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
    for (int i = 0; i < t->scene->body_count; ++i) {
        pl_touched *body = &t->bodies[i];
        *body = (pl_touched){.met_before = body->met, .depth_before = body->depth};
    }
}

void pl_touching_see(void *touching, const pl_near_pair *pair)
{
    pl_touching *t = touching;
    const pl_body *bodies = t->scene->bodies;
    t->bodies[pair->a].met = t->bodies[pair->b].met = true;
    if (bodies[pair->a].is_static || bodies[pair->b].is_static) {
        t->met_static = true;
    } else {
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
        t->bodies[pair->a].depth -= pair->gap;
        t->bodies[pair->b].depth -= pair->gap;
        if (t->step > 0) {
            pl_series_add(t->depths, -pair->gap, t->step);
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

int pl_touching_island(pl_touching *t, int body)
{
    return root_of(t->both, body);
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

static void *create(const pl_run_view *view, pl_arena *arena)
{
    (void)arena;
    view->series[PL_METRIC_PENETRATION_MAX]->applies = view->scene->body_count > 1;
    return view->touching;
}

/* Both metrics are PL_METRIC_FAILED if the gap of any pair could not be computed. */
static void collect(void *state, const pl_run_view *view, pl_metric *item)
{
    const pl_touching *t = state;
    if (view->scene->body_count < 2) {
        return;
    }
    item[PL_METRIC_PENETRATION_REST] =
        pl_metric_value(t->rest_count > 0 ? t->rest_sum / (double)t->rest_count : 0);
    if (t->unknown_step >= 0) {
        item[PL_METRIC_PENETRATION_MAX] = item[PL_METRIC_PENETRATION_REST] =
            pl_metric_failed("no gap found for \"%.30s\" and \"%.30s\" at step %ld",
                             t->scene->bodies[t->unknown_a].name,
                             t->scene->bodies[t->unknown_b].name, t->unknown_step);
    }
}

const pl_module pl_touching_module = {.create = create, .collect = collect};
