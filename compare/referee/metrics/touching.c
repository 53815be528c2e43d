/* Penetration depth is max(0, -gap) in m, over all pairs, frame by frame.
 *
 * Islands are two partitions by disjoint sets: of this frame, and of this frame and the last
 * together. Source: Galler and Fischer 1964; path halving, Tarjan and van Leeuwen 1984. */
#include "touching.h"

#include "series.h"

#include <math.h>
#include <string.h>

/* ---- Penetration ---- */

struct pl_penetration {
    const pl_scene *scene;
    pl_series depth; /* of each touching pair (gap <= 0) at each step */
    long step;       /* of the current frame */
    double deepest;  /* so far in the current frame */
    long rest_from;  /* first step of the last second */
    double rest_sum;
    long rest_count;
    bool touched_static;
    int unknown_a, unknown_b; /* the first pair whose gap could not be computed */
    long unknown_step;        /* -1: none */
};

pl_penetration *pl_penetration_create(const pl_scene *scene, pl_arena *arena)
{
    pl_penetration *p = pl_arena_take(arena, 1, sizeof *p);
    if (p == NULL || !pl_series_init(&p->depth, arena)) {
        return NULL;
    }
    p->scene = scene;
    p->unknown_step = -1;
    p->rest_from = pl_scene_steps(scene) - lround(1 / scene->dt) + 1;
    return p;
}

void pl_penetration_begin(pl_penetration *p, long step)
{
    p->step = step;
    p->deepest = 0;
}

void pl_penetration_see(pl_penetration *p, const pl_near_pair *pair)
{
    const pl_body *bodies = p->scene->bodies;
    if (pair->status != PL_OK) {
        if (p->unknown_step < 0) {
            p->unknown_step = p->step;
            p->unknown_a = pair->a;
            p->unknown_b = pair->b;
        }
    } else if (pair->gap <= 0) {
        p->touched_static =
            p->touched_static || bodies[pair->a].is_static || bodies[pair->b].is_static;
        p->deepest = fmax(p->deepest, -pair->gap);
        if (p->step > 0) {
            pl_series_add(&p->depth, -pair->gap, p->step);
        }
    }
}

void pl_penetration_end(pl_penetration *p)
{
    if (p->step > 0 && p->step >= p->rest_from) {
        p->rest_sum += p->deepest;
        p->rest_count += 1;
    }
}

bool pl_penetration_touched_static(const pl_penetration *p)
{
    return p->touched_static;
}

void pl_penetration_metrics(const pl_penetration *p, pl_metric *item)
{
    double mean = p->rest_count > 0 ? p->rest_sum / (double)p->rest_count : 0;
    item[PL_METRIC_PENETRATION_MAX] = pl_series_metric(&p->depth, p->depth.max);
    item[PL_METRIC_PENETRATION_REST] = pl_metric_value(mean);
    if (p->unknown_step >= 0) {
        item[PL_METRIC_PENETRATION_MAX] = item[PL_METRIC_PENETRATION_REST] =
            pl_metric_failed("no gap found for \"%.30s\" and \"%.30s\" at step %ld",
                             p->scene->bodies[p->unknown_a].name,
                             p->scene->bodies[p->unknown_b].name, p->unknown_step);
    }
}

/* ---- Islands ---- */

struct pl_islands {
    const pl_scene *scene;
    int *now, *both; /* (body_count): parents; a root is its own parent and the least of its set */
    double *sum;     /* (body_count): by root */
};

static void separate(int *parents, int count)
{
    for (int i = 0; i < count; ++i) {
        parents[i] = i;
    }
}

pl_islands *pl_islands_create(const pl_scene *scene, pl_arena *arena)
{
    size_t count = (size_t)scene->body_count;
    pl_islands *islands = pl_arena_take(arena, 1, sizeof *islands);
    if (islands == NULL) {
        return NULL;
    }
    *islands = (pl_islands){.scene = scene,
                            .now = pl_arena_take(arena, count, sizeof *islands->now),
                            .both = pl_arena_take(arena, count, sizeof *islands->both),
                            .sum = pl_arena_take(arena, count, sizeof *islands->sum)};
    if (arena->failed) {
        return NULL;
    }
    separate(islands->now, scene->body_count);
    separate(islands->both, scene->body_count);
    return islands;
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

void pl_islands_begin(pl_islands *islands)
{
    int count = islands->scene->body_count;
    memcpy(islands->both, islands->now, (size_t)count * sizeof *islands->both);
    separate(islands->now, count);
}

void pl_islands_join(pl_islands *islands, int a, int b)
{
    unite(islands->now, a, b);
    unite(islands->both, a, b);
}

double pl_islands_largest(pl_islands *islands, const double *growth)
{
    const pl_scene *scene = islands->scene;
    double largest = -HUGE_VAL;
    memset(islands->sum, 0, (size_t)scene->body_count * sizeof *islands->sum);
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            islands->sum[root_of(islands->both, i)] += growth[i];
        }
    }
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static && root_of(islands->both, i) == i) {
            largest = fmax(largest, isnan(islands->sum[i]) ? HUGE_VAL : islands->sum[i]);
        }
    }
    return largest > -HUGE_VAL ? largest : 0;
}
