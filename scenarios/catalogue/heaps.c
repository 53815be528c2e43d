/* Many bodies on the floor: cubes apart from each other, cubes that fall, and a loose pile. */
#include "catalogue.h"
#include "solids.h"

#include <math.h>

static const double half = 0.5; /* m, of a cube */

/* Cubes side by side on the floor that do not touch: the scene of the source paper's Table 1. */

enum { BLOCKS_COUNT, BLOCKS_MESH, BLOCKS_FRICTION };

static const pl_param blocks_params[] = {
    {"n", 200, 1, 90000, true, "1", "number of cubes"},
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
    .source = "impenetrability, conservation of energy and momentum",
    .primary_error = "chaotic_error",
    PL_CHAOTIC_ACCEPTANCE,
    PL_PARAMS(falling_cubes_params),
    .build = falling_cubes_build};

/* Bodies of random sizes and orientations, dropped into a box of planes.
 *
 * They start apart, each in its own cell of a lattice over the floor, with random velocities to the
 * sides, and fall into a loose pile. The motion is chaotic and has no closed form; it is
 * judged by what all right answers have in common: see converged.c. */

enum { PILE_COUNT, PILE_SHAPE, PILE_COLUMNS, PILE_GAP, PILE_FRICTION };
enum { SPHERES, BOXES, BOTH, MESHES, ALL };

static const pl_param pile_params[] = {
    {"n", 100, 1, 5000, true, "1", "number of bodies"},
    {"shape", BOTH, SPHERES, ALL, true, "1",
     "0 spheres, 1 boxes, 2 either at random, 3 rings of 500 triangles, 4 any of the shapes"},
    {"columns", 0, 0, 1000, true, "1",
     "cells of the lattice in x and in y; 0: so many that it is about twice as high as wide"},
    {"gap", 0.1, 0, 100, false, "m",
     "between two cells: with a wide one bodies rain down, each for itself"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(4),
};

static const double least_half = 0.35, most_half = 0.5; /* m: radius, or half extent of a box */
static const double sideways = 1;                       /* m/s, at most, in x and in y */
static const double density = 1;                        /* kg/m^3 */

/* Shapes that bodies share: all rings are one mesh, and all hulls one icosahedron. */
typedef struct kit {
    int shape;
    pl_shape ring;
    pl_shape hull;
} kit;

enum { AROUND = 25, SIDES = 10 }; /* 500 triangles */

static kit make_kit(pl_builder *b, int shape)
{
    kit k = {.shape = shape};
    if (shape == MESHES || shape == ALL) {
        pl_solid solid = pl_solid_torus(0.7 * most_half, 0.3 * most_half, AROUND, SIDES);
        k.ring = pl_build_solid(b, &solid, false, "ring");
    }
    if (shape == ALL) {
        double height;
        pl_solid solid = pl_solid_icosahedron(most_half, &height);
        k.hull = pl_build_solid(b, &solid, true, "icosahedron");
    }
    return k;
}

static pl_shape draw_box(pl_random *random)
{
    double half_extents[3];
    for (int k = 0; k < 3; ++k) {
        half_extents[k] = pl_draw_uniform(random, least_half, most_half);
    }
    return pl_shape_box(half_extents[0], half_extents[1], half_extents[2]);
}

static pl_shape draw_shape(pl_random *random, const kit *k)
{
    if (k->shape == MESHES) {
        return k->ring;
    }
    if (k->shape == SPHERES || (k->shape == BOTH && pl_random_unit(random) < 0.5)) {
        return pl_shape_sphere(pl_draw_uniform(random, least_half, most_half));
    }
    switch (k->shape == ALL ? (int)(6 * pl_random_unit(random)) : 0) {
    case 1:
        return pl_shape_sphere(pl_draw_uniform(random, least_half, most_half));
    case 2:
        return pl_shape_capsule(0.5 * most_half, pl_draw_uniform(random, 0.2, 0.5));
    case 3:
        return pl_shape_cylinder(pl_draw_uniform(random, least_half, most_half), least_half);
    case 4:
        return k->hull;
    case 5:
        return k->ring;
    default:
        return draw_box(random);
    }
}

/* Body i in cell i, of side `cell`, of a lattice `columns` wide and deep. */
static void build_body(pl_builder *b, pl_random *random, int i, const kit *k, int columns,
                       double cell)
{
    pl_body body = pl_body_at(draw_shape(random, k), 0, 0, 0);
    body.mass = density * pl_shape_volume(&body.shape);
    pl_draw_orientation(random, body.orientation);
    body.position[0] = (i % columns + 0.5) * cell;
    body.position[1] = (i / columns % columns + 0.5) * cell;
    const int layer = i / columns / columns;
    body.position[2] = (layer + 0.5) * cell;
    body.velocity[0] = pl_draw_uniform(random, -sideways, sideways);
    body.velocity[1] = pl_draw_uniform(random, -sideways, sideways);
    pl_build_body(b, &body, "body %d", i + 1);
}

static void pile_build(pl_builder *b, const double *values)
{
    const int count = (int)values[PILE_COUNT], shape = (int)values[PILE_SHAPE];
    int columns = values[PILE_COLUMNS] > 0 ? (int)values[PILE_COLUMNS] : 1;
    while (values[PILE_COLUMNS] == 0 && 2 * columns * columns * columns < count) {
        ++columns;
    }
    double cell =
        2 * most_half * (shape == SPHERES || shape == MESHES ? 1 : sqrt(3)) + values[PILE_GAP];
    pl_build_floor(b);
    pl_build_plane(b, "left", 0, 1, 0, 0, 0);
    pl_build_plane(b, "right", 0, -1, 0, 0, -columns * cell);
    pl_build_plane(b, "front", 0, 0, 1, 0, 0);
    pl_build_plane(b, "back", 0, 0, -1, 0, -columns * cell);
    const kit shared = make_kit(b, shape);
    for (int i = 0; i < count && b->status == PL_OK; ++i) {
        build_body(b, &b->random, i, &shared, columns, cell);
    }
}

const pl_scenario pl_scenario_pile = {
    .name = "pile",
    .title = "Loose pile",
    .description = "Bodies of random sizes and orientations fall into a box of planes: contacts in "
                   "every direction that come and go at every step, none of them stacked.",
    .reference = "no closed form for the motion; " PL_CHAOTIC_REFERENCE,
    .expected = "ok: the bodies come to rest in the box; no two overlap at any time",
    .source = "impenetrability, conservation of energy and momentum",
    .primary_error = "chaotic_error",
    PL_CHAOTIC_ACCEPTANCE,
    .provokes =
        "many bodies of odd shapes at once, meshes that are hollow among them: bodies pass into "
        "each other or are thrown, and a step takes too long; a right engine keeps them apart "
        "and lets them come to rest",
    PL_PARAMS(pile_params),
    .build = pile_build};
