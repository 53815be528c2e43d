/* Many cubes on the floor: apart from each other, and falling. */
#include "catalogue.h"
#include "solids.h"

#include <math.h>

static const double half = 0.5; /* m, of a cube */

/* Cubes side by side on the floor that do not touch: the scene of the source paper's Table 1. */

enum { BLOCKS_COUNT, BLOCKS_MESH, BLOCKS_FRICTION };

static const pl_param blocks_params[] = {
    {"n", 200, 1, 100000, true, "1", "number of cubes"},
    {"mesh", 1, 0, 1, true, "1", "0: boxes; 1: meshes of 12 triangles, as in the source paper"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(2),
};

static const double spacing = 1.5; /* m */

static void blocks_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    pl_body cube = pl_body_at(pl_shape_box(half, half, half), 0, 0, 0);
    if (values[BLOCKS_MESH] != 0) {
        pl_solid solid = pl_solid_box(half, half, half);
        cube.shape = pl_build_solid(b, &solid, false, "cube");
    }
    const int count = (int)values[BLOCKS_COUNT];
    int columns = 1;
    while (columns * columns < count) {
        ++columns;
    }
    for (int i = 0; i < count; ++i) {
        const int row = i / columns;
        cube.position[0] = spacing * (i % columns);
        cube.position[1] = spacing * row;
        cube.position[2] = half;
        pl_build_rest(b, pl_build_body(b, &cube, "cube %d", i + 1));
    }
    b->scene->collapse_distance = half;
}

const pl_scenario pl_scenario_blocks = {
    .name = "blocks",
    .title = "Cubes on the floor",
    .description =
        "Cubes that lie on the floor apart from each other: no stack, so the time is all "
        "collision detection and many small contact problems.",
    .reference = "every cube stays where it is",
    .expected = "ok: every cube at rest where it began",
    .source = "statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(blocks_params),
    .build = blocks_build};

/* Cubes in random orientations fall on the floor and on each other.
 *
 * They start at rest, each in its own cell of a lattice of n / columns^2 layers. The motion is
 * chaotic and judged by what all right answers have in common: see converged.c. */

enum { FALLING_CUBES_COUNT, FALLING_CUBES_COLUMNS, FALLING_CUBES_HEIGHT, FALLING_CUBES_FRICTION };

static const double gap = 0.1; /* m, between the cells */

static const pl_param falling_cubes_params[] = {
    {"n", 27, 1, 5000, true, "1", "cubes"},
    {"columns", 3, 1, 100, true, "1", "cells of a layer in x and in y"},
    {"height", 1, 0, 100, false, "m", "of the lowest cells above the floor"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(4),
};

static void falling_cubes_build(pl_builder *b, const double *values)
{
    const int columns = (int)values[FALLING_CUBES_COLUMNS];
    const double cell = 2 * half * sqrt(3) + gap;
    pl_build_floor(b);
    for (int i = 0; i < (int)values[FALLING_CUBES_COUNT]; ++i) {
        pl_body cube = pl_body_at(pl_shape_box(half, half, half), 0, 0, 0);
        pl_draw_orientation(&b->random, cube.orientation);
        cube.position[0] = (i % columns + 0.5) * cell;
        cube.position[1] = (i / columns % columns + 0.5) * cell;
        const int layer = i / columns / columns;
        cube.position[2] = values[FALLING_CUBES_HEIGHT] + (layer + 0.5) * cell;
        pl_build_body(b, &cube, "cube %d", i + 1);
    }
}

const pl_scenario pl_scenario_falling_cubes = {
    .name = "falling-cubes",
    .title = "Falling cubes",
    .description = "Cubes in random orientations fall on the floor and on each other, and come to "
                   "lie in a heap: impacts of edges and corners. Figure 2 of the source "
                   "paper, " PL_SOURCE_PAPER ".",
    .reference = "no closed form for the motion; " PL_CHAOTIC_REFERENCE,
    .expected = "ok: the cubes come to lie in a heap; no two bodies overlap at any time",
    .source = PL_CHAOTIC_SOURCE,
    PL_CHAOTIC_JUDGED,
    PL_PARAMS(falling_cubes_params),
    .build = falling_cubes_build};
