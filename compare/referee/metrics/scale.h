/* The scales of a scene: what dimensionless metrics are divided by, and the bounds beyond which a
 * frame cannot be valid. The validity checks of a frame are here too. */
#ifndef PLUMB_SCALE_H
#define PLUMB_SCALE_H

#include "metrics.h"
#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* The scales of one scene. */
typedef struct pl_scale {
    int dynamic_count;
    /* J: initial kinetic energy + M |g| H, where H is the extent along gravity of the bounding
     * spheres of the dynamic bodies at the start; 1 J where that is 0. */
    double energy;
    /* N s: sum over dynamic bodies of m |v0| + |I w0| / r + m |g| T, with the bounding radius r and
     * the duration T, + sum over forces of |F| T_F with each force's own duration T_F; at least
     * 1e-300. */
    double momentum;
    /* N m s: momentum x (the largest distance of a dynamic body's centre from the origin at the
     * start, plus its r). */
    double angular_momentum;
    double speed_bound;  /* m/s: no point of a body is faster in a valid run; see scale.c */
    double travel_bound; /* m: no body goes farther in a valid run */
} pl_scale;

/* The scales of the scene's initial state. */
pl_scale pl_scale_of(const pl_scene *scene);

/* PL_ENDING_NONFINITE, with body and step in `error`, when a number of a dynamic body or of a static
 * one's pose is NaN or infinite, or the orientation of a dynamic one has a squared norm outside
 * 1/2 .. 2. */
pl_ending pl_check_finite(const pl_scene *scene, const pl_body_state *bodies, long step,
                          pl_error *error);

/* PL_ENDING_DIVERGED, with the reason in `error`, when a point of a dynamic body is faster than
 * scale->speed_bound, when one is farther than scale->travel_bound from where it began, or when the current `energy_gain` (the metric) exceeds 10. A free fall,
 * however long, gains no energy. */
pl_ending pl_check_bounds(const pl_scene *scene, const pl_scale *scale, const pl_body_state *bodies,
                          double energy_gain, long step, pl_error *error);

#endif
