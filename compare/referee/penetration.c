/* Depth = max(0, -gap) over all pairs that the broad phase leaves, a frame at a time. */
#include "referee/penetration.h"

#include "referee/broad_phase.h"
#include "referee/gap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct pl_penetration {
    const pl_scene *scene;
    pl_broad_phase *broad_phase;
    pl_series depth;
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
    p->broad_phase = pl_broad_phase_create(scene);
    if (p->broad_phase == NULL || !pl_series_init(&p->depth)) {
        pl_penetration_destroy(p);
        return NULL;
    }
    return p;
}

void pl_penetration_destroy(pl_penetration *p)
{
    if (p != NULL) {
        pl_broad_phase_destroy(p->broad_phase);
        pl_series_free(&p->depth);
        free(p);
    }
}

/* Static bodies are where the scene has them, whatever an engine says. */
static pl_placed_shape place(const pl_scene *scene, const pl_body_state *bodies, int body)
{
    const pl_body *b = &scene->bodies[body];
    pl_placed_shape placed = {.shape = &b->shape};
    memcpy(placed.position, b->is_static ? b->position : bodies[body].position,
           sizeof placed.position);
    memcpy(placed.orientation, b->is_static ? b->orientation : bodies[body].orientation,
           sizeof placed.orientation);
    return placed;
}

/* One frame in the making. */
typedef struct frame_depth {
    pl_penetration *penetration;
    const pl_body_state *bodies;
    long step;
    double deepest;
} frame_depth;

static void see_pair(void *context, int a, int b)
{
    frame_depth *frame = context;
    pl_penetration *p = frame->penetration;
    pl_placed_shape placed_a = place(p->scene, frame->bodies, a);
    pl_placed_shape placed_b = place(p->scene, frame->bodies, b);
    double gap = 0;
    if (pl_gap(&placed_a, &placed_b, &gap) != PL_OK) {
        if (p->unknown_step < 0) {
            p->unknown_step = frame->step;
            p->unknown_a = a;
            p->unknown_b = b;
        }
    } else if (gap <= 0) {
        p->touched_static =
            p->touched_static || p->scene->bodies[a].is_static || p->scene->bodies[b].is_static;
        frame->deepest = fmax(frame->deepest, -gap);
        if (frame->step > 0) {
            pl_series_add(&p->depth, -gap, frame->step);
        }
    }
}

void pl_penetration_see(pl_penetration *p, long step, const pl_body_state *bodies)
{
    frame_depth frame = {.penetration = p, .bodies = bodies, .step = step};
    pl_broad_phase_each_pair(p->broad_phase, bodies, see_pair, &frame);
    if (step > 0 && step >= p->rest_from) {
        p->rest_sum += frame.deepest;
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
