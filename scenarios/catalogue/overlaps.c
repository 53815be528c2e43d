/* Bodies that start in overlap: with static bodies, with each other, and between static bodies that
 * leave them no room. */
#include "catalogue.h"

/* Unit cubes and a ball, each group far from the others.
 *
 * Where a body can be parted from what it overlaps, the least way out is unique, and it ends there,
 * at rest: out of a floor, out of the top or the side of a static block, and two equal cubes out of
 * each other, each by half. Where static bodies on both sides leave no room there is no way out. The
 * cubes between two walls, and between the floor and a ceiling, are in the middle, and by symmetry
 * nothing moves them. No way out takes more energy than the lift against gravity, so nothing is
 * thrown: a body that ends elsewhere has been moved by more than what was asked for. That is judged
 * (rest_position_error). `lift` shows what was thrown upwards even if it fell back to its place, and
 * penetration_rest is at best the overlap of the two that stay. */

enum { OVERLAPPING_START_OVERLAP, OVERLAPPING_START_FRICTION };

static const double half = 0.5;                       /* m, of a cube and of a ball */
static const double block_half = 1, wall_half = 0.25; /* m */
static const double spacing = 6;                      /* m, of the groups along x */

static const pl_param overlapping_start_params[] = {
    {"overlap", 0.3, 0, 0.45, false, "m", "of each pair, of bodies of 1 m"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(4),
};

static void build_static(pl_builder *b, const char *name, pl_shape box, double x, double z)
{
    pl_body block = pl_body_at(box, x, 0, z);
    block.is_static = true;
    pl_build_body(b, &block, "%s", name);
}

/* Adds a body that ends at (x, 0, z), and starts `off` farther along an axis. */
static void build_off(pl_builder *b, const char *name, pl_shape shape, double x, double z, int axis,
                      double off)
{
    const pl_body body = pl_body_at(shape, x, 0, z);
    const int index = pl_build_body(b, &body, "%s", name);
    pl_build_rest(b, index);
    pl_build_start_off(b, index, axis, off);
}

static void overlapping_start_build(pl_builder *b, const double *values)
{
    enum { X, Y, Z };
    const double overlap = values[OVERLAPPING_START_OVERLAP], top = 2 * block_half + half;
    const pl_shape cube = pl_shape_box(half, half, half), ball = pl_shape_sphere(half);
    const pl_shape block = pl_shape_box(block_half, block_half, block_half);
    const pl_shape wall = pl_shape_box(wall_half, block_half, block_half);
    const pl_shape ceiling = pl_shape_box(block_half, block_half, wall_half);
    double x = 0;
    pl_build_floor(b);
    b->scene->collapse_distance = half;
    build_off(b, "in the floor", cube, x, half, Z, -overlap);

    x += spacing;
    build_static(b, "block", block, x, block_half);
    build_off(b, "in the top", cube, x, top, Z, -overlap);

    x += spacing;
    build_static(b, "stand", block, x, block_half);
    build_off(b, "ball in the top", ball, x, top, Z, -overlap);

    x += spacing;
    build_static(b, "wall", wall, x, block_half);
    build_off(b, "in the wall", cube, x + wall_half + half, half, X, -overlap);

    x += spacing;
    build_off(b, "left of two", cube, x - half, half, X, overlap / 2);
    build_off(b, "right of two", cube, x + half, half, X, -overlap / 2);

    x += spacing;
    build_static(b, "left wall", wall, x - wall_half - half + overlap, block_half);
    build_static(b, "right wall", wall, x + wall_half + half - overlap, block_half);
    build_off(b, "between walls", cube, x, half, X, 0);

    x += spacing;
    build_static(b, "ceiling", ceiling, x, 1 + wall_half - 2 * overlap);
    build_off(b, "under the ceiling", cube, x, half - overlap, Z, 0);
}

const pl_scenario pl_scenario_overlapping_start = {
    .name = "overlapping-start",
    .title = "Start within static bodies",
    .description = "Cubes and a ball that start deep in a floor, a block, a wall and each other, "
                   "and two that have no room between static bodies: whether overlap is mended "
                   "gently, and left where it cannot be.",
    .reference = "what can be parted ends at rest by the shortest way out, and what cannot be "
                 "parted stays where it is",
    .expected = "ok: five bodies come out and lie or stand next to what they were in, two stay",
    .source = "impenetrability, statics and symmetry",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .provokes = "overlap mended in one step, or turned into speed: bodies are thrown, and those "
                "without room leave sideways, through what holds them; a right engine moves none "
                "by more than its overlap",
    PL_PARAMS(overlapping_start_params),
    .build = overlapping_start_build};
