/* Cubes in random orientations fall on the floor and on each other.
 *
 * They start at rest, each in its own cell of a lattice of n / columns^2 layers. Chaotic, so that
 * what is judged is overlap. */
#include "catalogue.h"
#include "draw.h"
#include "scene_builder.h"

#include <math.h>

enum { COUNT, COLUMNS, HEIGHT, FRICTION, DT, DURATION, PARAM_COUNT };

static const double half = 0.5; /* m */
static const double gap = 0.1;  /* m, between the cells */

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 27,
               .min = 1,
               .max = 5000,
               .integer = true,
               .unit = "1",
               .help = "cubes"},
    [COLUMNS] = {.name = "columns",
                 .value = 3,
                 .min = 1,
                 .max = 100,
                 .integer = true,
                 .unit = "1",
                 .help = "cells of a layer in x and in y"},
    [HEIGHT] = {.name = "height",
                .value = 1,
                .min = 0,
                .max = 100,
                .unit = "m",
                .help = "of the lowest cells above the floor"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(4),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    pl_random random = {.state = seed};
    pl_builder builder = pl_build_begin(scene, pl_scenario_falling_cubes.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    const int columns = (int)values[COLUMNS];
    const double cell = 2 * half * sqrt(3) + gap;
    pl_build_floor(&builder, 0, 0, 1, 0);
    for (int i = 0; i < (int)values[COUNT]; i++) {
        pl_body cube = pl_body_default();
        cube.shape = pl_shape_box(half, half, half);
        pl_draw_orientation(&random, cube.orientation);
        cube.position[0] = (i % columns + 0.5) * cell;
        cube.position[1] = (i / columns % columns + 0.5) * cell;
        cube.position[2] = values[HEIGHT] + (i / columns / columns + 0.5) * cell;
        pl_build_body(&builder, &cube, "cube %d", i + 1);
    }
    pl_build_judge(&builder, pl_scenario_falling_cubes.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_falling_cubes = {
    .name = "falling-cubes",
    .title = "Falling cubes",
    .description = "Cubes in random orientations fall on the floor and on each other, and come to "
                   "lie in a heap: impacts of edges and corners. Figure 2 of the source "
                   "paper, " PL_SOURCE_PAPER ".",
    .reference = "no closed form for the motion; no overlap at any time: penetration 0",
    .expected = "ok: the cubes come to lie in a heap; no two bodies overlap at any time",
    .source = "impenetrability",
    .primary_error = "penetration_max",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
