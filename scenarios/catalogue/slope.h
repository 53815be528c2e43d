/* A flat block on an inclined plane, shared by the scenarios slope-* and slide-to-stop.
 *
 * The plane goes through the origin with normal n = (sin a, 0, cos a), so downhill is
 * t = (cos a, 0, -sin a). The block, half extents (0.5, 0.5, 0.25) m and mass 1 kg, lies on it with
 * its centre at 0.25 n, turned by a about y. */
#ifndef PLUMB_SLOPE_H
#define PLUMB_SLOPE_H

#include "scene_builder.h"

/* Half width over half height: a block with more friction than that tips before it slides. */
#define PL_SLOPE_TIPPING 2.0

#define PL_PARAM_SLOPE_FRICTION                                                                    \
    {                                                                                              \
        .name = "friction", .value = 0.5, .min = 0, .max = 1.9, .unit = "1",                       \
        .help = "Coulomb coefficient; below 2, where the block would tip"                          \
    }

typedef struct pl_slope {
    double angle; /* rad, 0 to 1.6 */
    double sine, cosine;
    double friction;
} pl_slope;

pl_slope pl_slope_of(double angle, double friction);

/* The block holds on iff tan(angle) < friction; g (sin - friction cos) along the slope otherwise.
 */
bool pl_slope_holds(const pl_slope *slope);

/* Adds the plane and the block, which starts with `velocity` (world, m/s); returns the block's
 * index, -1 after a failure. */
int pl_build_slope(pl_builder *builder, const pl_slope *slope, const double velocity[3]);

#endif
