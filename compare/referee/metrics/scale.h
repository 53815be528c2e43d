/* The scene's own scales, against which the referee's dimensionless metrics and bounds are
 * measured. */
#ifndef PLUMB_SCALE_H
#define PLUMB_SCALE_H

#include "plumb/scene.h"

typedef struct pl_scale {
    int dynamic_count;
    double gravity; /* |g|, m/s^2 */
    /* J: initial kinetic energy + M |g| H, where H is the extent along gravity of the bounding
     * spheres of the dynamic bodies at the start; 1 J where that vanishes. */
    double energy;
    /* N s: sum of m |v0| + |I w0| / r + M |g| T + |F| T_F over bodies (bounding radius r), the
     * duration T and each force's own duration T_F; at least 1e-300. */
    double momentum;
    /* N m s: momentum x the largest distance of a dynamic body's centre from the origin at the
     * start + its r. */
    double angular_momentum;
    /* m/s: no point of a body can rightly be faster: see scale.c. */
    double speed_bound;
} pl_scale;

pl_scale pl_scale_of(const pl_scene *scene);

#endif
