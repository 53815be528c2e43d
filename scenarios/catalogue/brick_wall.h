/* A brick wall in running bond along x, shared by the scenarios wall and wall-collapse.
 *
 * Bricks of 1 x 0.5 x 0.5 m and 1 kg touch exactly. Brick c of an even row has its centre at x = c;
 * odd rows are moved by half a brick, with a half brick of 0.5 kg at either end. So the wall goes
 * from x = -0.5 to columns - 0.5, y = -0.25 to 0.25, z = 0 to rows / 2, and every row weighs
 * `columns` kg. */
#ifndef PLUMB_BRICK_WALL_H
#define PLUMB_BRICK_WALL_H

#include "scene_builder.h"

/* m */
#define PL_BRICK_LENGTH 1.0
#define PL_BRICK_HEIGHT 0.5

/* The wall's parameters, with the scenario's default. */
#define PL_PARAM_BRICK_ROWS(rows)                                                                  \
    {                                                                                              \
        .name = "rows", .value = rows, .min = 1, .max = 100, .integer = true, .unit = "1",         \
        .help = "rows of bricks"                                                                   \
    }
#define PL_PARAM_BRICK_COLUMNS(columns)                                                            \
    {                                                                                              \
        .name = "columns", .value = columns, .min = 1, .max = 200, .integer = true, .unit = "1",   \
        .help = "bricks in a row"                                                                  \
    }

/* Adds the floor z = 0 and the wall; with `expect_rest`, every brick is expected to stay. */
void pl_build_brick_wall(pl_builder *builder, int rows, int columns, bool expect_rest);

#endif
