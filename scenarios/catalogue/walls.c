/* Brick walls in running bond: one along x, at rest and hit by a ball, and houses of four.
 *
 * Bricks of 1 x 0.5 x 0.5 m and 1 kg touch exactly. Brick c of an even row has its centre at x = c;
 * odd rows are moved by half a brick, with a half brick of 0.5 kg at either end. So the wall goes
 * from x = -0.5 to columns - 0.5, y = -0.25 to 0.25, z = 0 to rows / 2, and every row weighs
 * `columns` kg. */
#include "catalogue.h"

#include <math.h>

static const double brick_length = 1, brick_height = 0.5; /* m */

#define PL_PARAM_ROWS(rows)                                                                        \
    {                                                                                              \
        "rows", rows, 1, 100, true, "1", "rows of bricks"                                          \
    }
#define PL_PARAM_COLUMNS(columns)                                                                  \
    {                                                                                              \
        "columns", columns, 1, 200, true, "1", "bricks in a row"                                   \
    }

/* `length` is that along x; density is the same for half bricks. */
static void build_brick(pl_builder *b, int row, int place, double x, double length,
                        bool expect_rest)
{
    pl_body brick = pl_body_at(pl_shape_box(length / 2, brick_height / 2, brick_height / 2), x, 0,
                               (row + 0.5) * brick_height);
    brick.mass = length / brick_length;
    int index = pl_build_body(b, &brick, "brick %d.%d", row + 1, place + 1);
    if (expect_rest) {
        pl_build_rest(b, index);
    }
}

/* Adds the floor z = 0 and the wall. With `expect_rest`, every brick is expected to stay. */
static void build_wall(pl_builder *b, int rows, int columns, bool expect_rest)
{
    const double half = brick_length / 2;
    pl_build_floor(b);
    for (int row = 0; row < rows; ++row) {
        if (row % 2 == 0) {
            for (int c = 0; c < columns; ++c) {
                build_brick(b, row, c, c, brick_length, expect_rest);
            }
            continue;
        }
        build_brick(b, row, 0, -half / 2, half, expect_rest);
        for (int c = 1; c < columns; ++c) {
            build_brick(b, row, c, c - half, brick_length, expect_rest);
        }
        build_brick(b, row, columns, columns - half - half / 2, half, expect_rest);
    }
}

/* A brick wall at rest. It stands by statics: every brick lies on its row below over its whole
 * length. */

enum { WALL_ROWS, WALL_COLUMNS, WALL_FRICTION };

static const pl_param wall_params[] = {
    PL_PARAM_ROWS(10),
    PL_PARAM_COLUMNS(10),
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void wall_build(pl_builder *b, const double *values)
{
    build_wall(b, (int)values[WALL_ROWS], (int)values[WALL_COLUMNS], true);
    b->scene->collapse_distance = brick_height / 2;
}

const pl_scenario pl_scenario_wall = {
    .name = "wall",
    .title = "Brick wall at rest",
    .description =
        "A wall of bricks in running bond that touch exactly: many bodies and closed loops of "
        "contacts, where a stack has a chain.",
    .reference = "every brick stays where it is",
    .expected = "ok: every brick at rest where it began",
    .source = "statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(wall_params),
    .build = wall_build};

/* A city of houses, each of four brick walls of equal length that are bonded at their corners.
 *
 * In a row each wall has `columns` whole bricks. It begins at a corner of the house and ends half a
 * brick, its thickness, before the other one, which belongs to the next wall. So the house is
 * columns + 1/2 m long and wide. From row to row the two corners of a wall change their roles, which
 * moves its bricks by half a brick: the running bond of the wall above, without half bricks. Every
 * brick lies over its whole length on the row below, so that it stands by statics. */

enum { CITY_HOUSES, CITY_ROWS, CITY_COLUMNS, CITY_FRICTION };
enum { MOST_BRICKS = 100000 };

static const double street = 2; /* m, between two houses */

static const pl_param city_params[] = {
    {"houses", 4, 1, 25000, true, "1", "of four walls; all together have at most 100000 bricks"},
    PL_PARAM_ROWS(6),
    PL_PARAM_COLUMNS(3),
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

/* Adds row `row` of the house whose corner of least x and y is there. */
static void build_ring(pl_builder *b, int house, int row, int columns, double x, double y)
{
    const double long_half = brick_length / 2, half = brick_height / 2;
    for (int i = 0; i < 4 * columns; ++i) {
        /* The walls in the order of a walk around the house: south, east, north, west. */
        const int wall = i / columns;
        const bool along_x = wall % 2 == 0, far_side = wall == 1 || wall == 2;
        const bool moved = (wall >= 2) != (row % 2 == 1);
        const double along = (i % columns + (moved ? 1 : 0.5)) * brick_length;
        const double across = half + (far_side ? columns * brick_length : 0);
        const pl_shape shape =
            pl_shape_box(along_x ? long_half : half, along_x ? half : long_half, half);
        const pl_body brick =
            pl_body_at(shape, x + (along_x ? along : across), y + (along_x ? across : along),
                       (row + 0.5) * brick_height);
        pl_build_rest(b, pl_build_body(b, &brick, "brick %d.%d.%d", house + 1, row + 1, i + 1));
    }
}

static void city_build(pl_builder *b, const double *values)
{
    const int houses = (int)values[CITY_HOUSES], rows = (int)values[CITY_ROWS];
    const int columns = (int)values[CITY_COLUMNS];
    if ((double)houses * rows * columns * 4 > MOST_BRICKS) {
        pl_build_refuse(b, "expected at most %d bricks, found 4 * houses * rows * columns = %.0f",
                        MOST_BRICKS, (double)houses * rows * columns * 4);
        return;
    }
    const double pitch = columns * brick_length + brick_height + street;
    int side = 1;
    while (side * side < houses) {
        ++side;
    }
    pl_build_floor(b);
    b->scene->collapse_distance = brick_height / 2;
    for (int i = 0; i < houses * rows; ++i) {
        const int house = i / rows, column = house % side, line = house / side;
        build_ring(b, house, i % rows, columns, column * pitch, line * pitch);
    }
}

const pl_scenario pl_scenario_city = {
    .name = "city",
    .title = "City of brick walls",
    .description = "Houses of four brick walls that are bonded at their corners, on one floor, at "
                   "rest: many walls at once, each with closed loops of contacts in itself and "
                   "around the house.",
    .reference = "every brick stays where it is",
    .expected = "ok: every brick of every house at rest where it began",
    .source = "statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(city_params),
    .build = city_build};

/* A brick wall hit by a heavy ball.
 *
 * The ball, of radius 1 m, starts 3 m before the wall at the middle of its length, 0.3 m above half
 * its height but never below the floor, and flies at it along +y. The motion is chaotic and has no
 * closed form; it is judged by what all right answers have in common: see converged.c. */

enum {
    WALL_COLLAPSE_ROWS,
    WALL_COLLAPSE_COLUMNS,
    WALL_COLLAPSE_MASS,
    WALL_COLLAPSE_SPEED,
    WALL_COLLAPSE_FRICTION
};

static const pl_param wall_collapse_params[] = {
    PL_PARAM_ROWS(10),
    PL_PARAM_COLUMNS(10),
    {"mass", 100, 1e-3, 1e6, false, "kg", "of the ball"},
    {"speed", 20, 0, 1000, false, "m/s", "of the ball towards the wall"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

static void wall_collapse_build(pl_builder *b, const double *values)
{
    const double radius = 1;
    build_wall(b, (int)values[WALL_COLLAPSE_ROWS], (int)values[WALL_COLLAPSE_COLUMNS], false);
    pl_body ball =
        pl_body_at(pl_shape_sphere(radius), values[WALL_COLLAPSE_COLUMNS] * brick_length / 2, -3,
                   fmax(values[WALL_COLLAPSE_ROWS] * brick_height / 2 + 0.3, radius));
    ball.mass = values[WALL_COLLAPSE_MASS];
    ball.velocity[1] = values[WALL_COLLAPSE_SPEED];
    pl_build_body(b, &ball, "ball");
}

const pl_scenario pl_scenario_wall_collapse = {
    .name = "wall-collapse",
    .title = "Brick wall hit by a ball",
    .description =
        "A hundred bricks and a ball of 100 kg at 20 m/s: impact, collapse and a pile, with "
        "contacts that come and go at every step.",
    .reference = "no closed form for the motion; " PL_CHAOTIC_REFERENCE,
    .expected = "ok: the ball breaks the wall; no two bodies overlap at any time",
    .source = PL_CHAOTIC_SOURCE,
    PL_CHAOTIC_JUDGED,
    PL_PARAMS(wall_collapse_params),
    .build = wall_collapse_build};
