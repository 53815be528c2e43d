/* Bodies of random sizes and orientations, dropped into a box of planes.
 *
 * They start apart, each in its own cell of a lattice over the floor, with random velocities to the
 * sides, and fall into a loose pile. The motion is chaotic and has no closed form; what every right
 * answer shares is that no two bodies ever overlap. */
#include "catalogue.h"
#include "draw.h"
#include "solids.h"

#include <math.h>

enum { COUNT, SHAPE, COLUMNS, GAP, FRICTION, DT, DURATION, PARAM_COUNT };
enum { SPHERES, BOXES, BOTH, MESHES, ALL };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 100,
               .min = 1,
               .max = 5000,
               .integer = true,
               .unit = "1",
               .help = "number of bodies"},
    [SHAPE] = {.name = "shape",
               .value = BOTH,
               .min = SPHERES,
               .max = ALL,
               .integer = true,
               .unit = "1",
               .help = "0 spheres, 1 boxes, 2 either at random, 3 rings of 500 triangles, 4 any of "
                       "the shapes"},
    [COLUMNS] = {.name = "columns",
                 .value = 0,
                 .min = 0,
                 .max = 1000,
                 .integer = true,
                 .unit = "1",
                 .help = "cells of the lattice in x and in y; 0: so many that it is about twice "
                         "as high as wide"},
    [GAP] = {.name = "gap",
             .value = 0.1,
             .min = 0,
             .max = 100,
             .unit = "m",
             .help = "between two cells: with a wide one bodies rain down, each for itself"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(4),
};

static const double least_half = 0.35, most_half = 0.5; /* m: radius, or half extent of a box */
static const double sideways = 1;                       /* m/s, at most, in x and in y */
static const double density = 1;                        /* kg/m^3 */

/* What bodies share: all rings are one mesh, and all hulls one icosahedron. */
typedef struct kit {
    int shape;
    const pl_polyhedron *ring, *hull;
} kit;

enum { AROUND = 25, SIDES = 10 }; /* 500 triangles */

static kit make_kit(pl_builder *builder, int shape)
{
    kit k = {.shape = shape};
    if (shape == MESHES || shape == ALL) {
        pl_solid solid = pl_solid_torus(0.7 * most_half, 0.3 * most_half, AROUND, SIDES);
        k.ring = pl_build_solid(builder, &solid, false, "ring");
    }
    if (shape == ALL) {
        double height;
        pl_solid solid = pl_solid_icosahedron(most_half, &height);
        k.hull = pl_build_solid(builder, &solid, true, "icosahedron");
    }
    return k;
}

static pl_shape draw_box(pl_random *random)
{
    double x = pl_draw_uniform(random, least_half, most_half),
           y = pl_draw_uniform(random, least_half, most_half);
    return pl_shape_box(x, y, pl_draw_uniform(random, least_half, most_half));
}

static pl_shape draw_shape(pl_random *random, const kit *k)
{
    if (k->shape == MESHES) {
        return pl_shape_of(k->ring);
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
        return pl_shape_of(k->hull);
    case 5:
        return pl_shape_of(k->ring);
    default:
        return draw_box(random);
    }
}

/* Body i in cell i, of side `cell`, of a lattice `columns` wide and deep. */
static void build_body(pl_builder *builder, pl_random *random, int i, const kit *k, int columns,
                       double cell)
{
    pl_body body = pl_body_default();
    body.shape = draw_shape(random, k);
    body.mass = density * pl_shape_volume(&body.shape);
    pl_draw_orientation(random, body.orientation);
    body.position[0] = (i % columns + 0.5) * cell;
    body.position[1] = (i / columns % columns + 0.5) * cell;
    body.position[2] = (i / columns / columns + 0.5) * cell;
    body.velocity[0] = pl_draw_uniform(random, -sideways, sideways);
    body.velocity[1] = pl_draw_uniform(random, -sideways, sideways);
    pl_build_body(builder, &body, "body %d", i + 1);
}

static void build_side(pl_builder *builder, double nx, double ny, double offset, const char *name)
{
    pl_body side = pl_body_default();
    side.is_static = true;
    side.shape = pl_shape_plane(nx, ny, 0, offset);
    pl_build_body(builder, &side, "%s", name);
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    pl_random random = {.state = seed};
    pl_builder builder = pl_build_begin(scene, pl_scenario_pile.name, values[DT], values[DURATION],
                                        values[FRICTION], error);
    const int count = (int)values[COUNT], shape = (int)values[SHAPE];
    int columns = values[COLUMNS] > 0 ? (int)values[COLUMNS] : 1;
    while (values[COLUMNS] == 0 && 2 * columns * columns * columns < count) {
        columns++;
    }
    double cell = 2 * most_half * (shape == SPHERES || shape == MESHES ? 1 : sqrt(3)) + values[GAP];
    pl_build_floor(&builder, 0, 0, 1, 0);
    build_side(&builder, 1, 0, 0, "left");
    build_side(&builder, -1, 0, -columns * cell, "right");
    build_side(&builder, 0, 1, 0, "front");
    build_side(&builder, 0, -1, -columns * cell, "back");
    const kit shared = make_kit(&builder, shape);
    for (int i = 0; i < count && builder.status == PL_OK; i++) {
        build_body(&builder, &random, i, &shared, columns, cell);
    }
    pl_build_judge(&builder, pl_scenario_pile.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_pile = {
    .name = "pile",
    .title = "Loose pile",
    .description = "Bodies of random sizes and orientations fall into a box of planes: contacts in "
                   "every direction that come and go at every step, none of them stacked.",
    .reference = "no closed form for the motion; no overlap at any time: penetration 0",
    .expected = "ok: the bodies come to rest in the box; no two overlap at any time",
    .source = "impenetrability",
    .primary_error = "penetration_max",
    .provokes =
        "many bodies of odd shapes at once, meshes that are hollow among them: bodies pass into "
        "each other or are thrown, and a step takes too long; a right engine keeps them apart "
        "and lets them come to rest",
    .needs =
        PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
