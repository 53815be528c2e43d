/* Depth = max(0, -gap) over all pairs, a frame at a time. */
#include "penetration.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct pl_penetration {
    const pl_scene *scene;
    pl_series depth;
    long step;      /* of the frame in the making */
    double deepest; /* so far in it */
    long rest_from; /* first step of the last second */
    double rest_sum;
    long rest_count;
    bool touched_static;
    int unknown_a, unknown_b; /* the first pair whose gap could not be found */
    long unknown_step;        /* -1: none */
};

pl_penetration *pl_penetration_create(const pl_scene *scene)
{
    pl_penetration *p = calloc(1, sizeof *p);
    if (p == NULL) {
        return NULL;
    }
    p->scene = scene;
    p->unknown_step = -1;
    p->rest_from = pl_scene_steps(scene) - lround(1 / scene->dt) + 1;
    if (!pl_series_init(&p->depth)) {
        pl_penetration_destroy(p);
        return NULL;
    }
    return p;
}

void pl_penetration_destroy(pl_penetration *p)
{
    if (p != NULL) {
        pl_series_free(&p->depth);
        free(p);
    }
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

static pl_metric unless_unknown(const pl_penetration *p, pl_metric metric)
{
    if (p->unknown_step >= 0) {
        metric = (pl_metric){.state = PL_METRIC_FAILED};
        (void)snprintf(metric.reason, sizeof metric.reason,
                       "no gap found for \"%.30s\" and \"%.30s\" at step %ld",
                       p->scene->bodies[p->unknown_a].name, p->scene->bodies[p->unknown_b].name,
                       p->unknown_step);
    }
    return metric;
}

pl_metric pl_penetration_max(const pl_penetration *p)
{
    return unless_unknown(p, pl_series_metric(&p->depth, p->depth.max));
}

pl_metric pl_penetration_rest(const pl_penetration *p)
{
    double mean = p->rest_count > 0 ? p->rest_sum / (double)p->rest_count : 0;
    return unless_unknown(p, (pl_metric){.state = PL_METRIC_VALUE, .value = mean});
}
