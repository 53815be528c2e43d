/* What the pyramids of cylinders and of spheres share: a floor whose friction is not that between
 * the bodies upon it. */
#ifndef PLUMB_ROUND_PYRAMID_H
#define PLUMB_ROUND_PYRAMID_H

#include "scene_builder.h"

/* m; a tenth of the radius. */
#define PL_ROUND_COLLAPSE 0.05

#define PL_PARAM_ROUND_FRICTION(default)                                                           \
    {                                                                                              \
        .name = "friction", .value = default, .min = 0, .max = 10, .unit = "1",                    \
        .help = "Coulomb coefficient between the bodies"                                           \
    }
#define PL_PARAM_ROUND_FLOOR_FRICTION                                                              \
    {                                                                                              \
        .name = "floor_friction", .value = 1, .min = 0, .max = 10, .unit = "1",                    \
        .help = "Coulomb coefficient of the floor"                                                 \
    }

/* Begins the scene, with the floor; bodies are of material 0. */
pl_builder pl_build_round_pyramid(pl_scene *scene, const char *name, double dt, double duration,
                                  double friction, double floor_friction, pl_error *error);

#endif
