/* Metrics of the pairs of bodies that touch: how deep they penetrate each other, and the islands
 * that they form.
 *
 * An island of a step consists of bodies that touch, directly or through others, in the frame
 * before or in the frame after the step. Energy that passes from body to body in a step stays
 * within one island. Static bodies join nothing, because no energy passes through them. */
#ifndef PLUMB_TOUCHING_H
#define PLUMB_TOUCHING_H

#include "referee/geometry/candidate_pairs.h"
#include "series.h"

/* What a body touched in the frames before and after the last step. */
typedef struct pl_touched {
    bool met, met_before;       /* another body (pl_near_pair); neither: it flew through the step */
    double depth, depth_before; /* sum of its overlaps, m */
} pl_touched;

/* The state of these metrics over a run. */
typedef struct pl_touching {
    const pl_scene *scene;
    pl_series *depths;  /* of each touching pair (gap <= 0) after each step, m */
    pl_touched *bodies; /* (body_count) */
    double deepest;     /* overlap of the last frame, m */
    bool met_static;    /* a dynamic body met a static one, whose impulses are then possible */

    long step;       /* of the current frame */
    long rest_from;  /* first step of the last second */
    double rest_sum; /* of the deepest of each frame */
    long rest_count;
    int unknown_a, unknown_b; /* the first pair whose gap could not be computed */
    long unknown_step;        /* -1: none */
    int *now, *both; /* (body_count): parents; a root is its own parent and the least of its set */
    double *sum;     /* (body_count): by root */
} pl_touching;

/* `scene` and `depths` must outlive it. Memory of the arena. */
pl_touching *pl_touching_create(const pl_scene *scene, pl_series *depths, pl_arena *arena);

/* Begins the frame after step number `step`. Step 0 (the start) has no penetration. */
void pl_touching_begin(pl_touching *touching, long step);

/* Takes one pair of the frame. `touching` is a pl_touching. */
void pl_touching_see(void *touching, const pl_near_pair *pair);

/* Ends the frame, after all of its pairs. */
void pl_touching_end(pl_touching *touching);

/* The largest sum of `growth`, (body_count), over an island of the last step; the entries of static
 * bodies are not read. 0 in a scene without dynamic bodies. A NaN counts as infinite. */
double pl_touching_island_max(pl_touching *touching, const double *growth);

/* The island of the last step that a dynamic body is in, by the least index of its bodies. */
int pl_touching_island(pl_touching *touching, int body);

#endif
