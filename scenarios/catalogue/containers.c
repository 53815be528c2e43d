/* Bodies of random sizes and orientations that fall into a container.
 *
 * They start apart, each in its own cell of a lattice over the floor, with random velocities to the
 * sides. The walls are as far apart as the lattice is wide. The motion is chaotic and has no closed
 * form; it is judged by what all right answers have in common: see converged.c. */
#include "catalogue.h"
#include "solids.h"

#include <math.h>
#include <stdio.h>

static const double sideways = 1; /* m/s, at most, in x and in y */
static const double density = 1;  /* kg/m^3 */

/* ---- Shapes ---- */

typedef enum family { SPHERES, BOXES, BOTH, MESHES, ALL, STONES } family;

/* Which shapes are drawn. All rings are one mesh, and all hulls of ALL one icosahedron. */
typedef struct kit {
    family shape;
    double least, most; /* m: radius, or half extent of a box */
    pl_shape ring;
    pl_shape hull;
} kit;

enum { AROUND = 25, SIDES = 10 }; /* 500 triangles */

static kit make_kit(pl_builder *b, family shape, double least, double most)
{
    kit k = {.shape = shape, .least = least, .most = most};
    if (shape == MESHES || shape == ALL) {
        pl_solid solid = pl_solid_torus(0.7 * most, 0.3 * most, AROUND, SIDES);
        k.ring = pl_build_solid(b, &solid, false, "ring");
    }
    if (shape == ALL) {
        double height;
        pl_solid solid = pl_solid_icosahedron(most, &height);
        k.hull = pl_build_solid(b, &solid, true, "icosahedron");
    }
    return k;
}

static double draw_size(pl_random *random, const kit *k)
{
    return pl_draw_uniform(random, k->least, k->most);
}

static pl_shape draw_box(pl_random *random, const kit *k)
{
    double half_extents[3];
    for (int i = 0; i < 3; ++i) {
        half_extents[i] = draw_size(random, k);
    }
    return pl_shape_box(half_extents[0], half_extents[1], half_extents[2]);
}

static pl_shape draw_stone(pl_builder *b, const kit *k)
{
    char name[PL_NAME_SIZE];
    snprintf(name, sizeof name, "stone %d", b->scene->body_count);
    return pl_build_stone(b, name, k->least, k->most);
}

static pl_shape draw_shape(pl_builder *b, const kit *k)
{
    pl_random *random = &b->random;
    if (k->shape == MESHES) {
        return k->ring;
    }
    if (k->shape == STONES) {
        return draw_stone(b, k);
    }
    if (k->shape == SPHERES || (k->shape == BOTH && pl_random_unit(random) < 0.5)) {
        return pl_shape_sphere(draw_size(random, k));
    }
    switch (k->shape == ALL ? (int)(6 * pl_random_unit(random)) : 0) {
    case 1:
        return pl_shape_sphere(draw_size(random, k));
    case 2:
        return pl_shape_capsule(0.5 * k->most, pl_draw_uniform(random, 0.4 * k->most, k->most));
    case 3:
        return pl_shape_cylinder(draw_size(random, k), k->least);
    case 4:
        return k->hull;
    case 5:
        return k->ring;
    default:
        return draw_box(random, k);
    }
}

/* ---- Filling a container ---- */

/* A lattice of cells over the floor, one for each body. */
typedef struct lattice {
    int count;   /* bodies */
    int columns; /* cells of a layer in x and in y */
    double cell; /* m */
} lattice;

/* The side of a cell that holds a body of the kit in any orientation, `gap` (m) from the next. */
static double cell_of(const kit *k, double gap)
{
    const bool round = k->shape == SPHERES || k->shape == MESHES || k->shape == STONES;
    return 2 * k->most * (round ? 1 : sqrt(3)) + gap;
}

/* Adds body i, in its cell. */
static void build_body(pl_builder *b, int i, const kit *k, const lattice *l)
{
    pl_random *random = &b->random;
    pl_body body = pl_body_at(draw_shape(b, k), 0, 0, 0);
    if (b->status != PL_OK) {
        return;
    }
    body.mass = density * pl_shape_volume(&body.shape);
    pl_draw_orientation(random, body.orientation);
    body.position[0] = (i % l->columns + 0.5) * l->cell;
    body.position[1] = (i / l->columns % l->columns + 0.5) * l->cell;
    const int layer = i / l->columns / l->columns;
    body.position[2] = (layer + 0.5) * l->cell;
    body.velocity[0] = pl_draw_uniform(random, -sideways, sideways);
    body.velocity[1] = pl_draw_uniform(random, -sideways, sideways);
    pl_build_body(b, &body, "body %d", i + 1);
}

static void build_bodies(pl_builder *b, const kit *k, const lattice *l)
{
    for (int i = 0; i < l->count && b->status == PL_OK; ++i) {
        build_body(b, i, k, l);
    }
}

/* Adds the floor and four planes around the lattice. */
static void build_planes(pl_builder *b, const lattice *l)
{
    const double width = l->columns * l->cell;
    pl_build_floor(b);
    pl_build_plane(b, "left", 0, 1, 0, 0, 0);
    pl_build_plane(b, "right", 0, -1, 0, 0, -width);
    pl_build_plane(b, "front", 0, 0, 1, 0, 0);
    pl_build_plane(b, "back", 0, 0, -1, 0, -width);
}

/* Adds the floor and four static boxes around the lattice, as high as it is. */
static void build_walls(pl_builder *b, const lattice *l)
{
    static const char *const names[] = {"left", "right", "front", "back"};
    const int layers = (l->count - 1) / (l->columns * l->columns) + 1;
    const double half = l->columns * l->cell / 2, high = layers * l->cell / 2, thick = 0.5;
    pl_build_floor(b);
    for (int i = 0; i < 4; ++i) {
        const double away = i % 2 == 0 ? -thick : 2 * half + thick;
        pl_body wall =
            i < 2 ? pl_body_at(pl_shape_box(thick, half + 2 * thick, high), away, half, high)
                  : pl_body_at(pl_shape_box(half, thick, high), half, away, high);
        wall.is_static = true;
        pl_build_body(b, &wall, "%s", names[i]);
    }
}

/* The least number of columns whose lattice is `high` times as high as wide, or less. */
static int columns_for(int count, int high)
{
    int columns = 1;
    while (high * columns * columns * columns < count) {
        ++columns;
    }
    return columns;
}

/* A lattice for so many bodies, `high` times as high as wide or less, with little between them. */
static lattice dense_lattice(const kit *k, double bodies, int high)
{
    const int count = (int)bodies;
    return (lattice){count, columns_for(count, high), cell_of(k, 0.05)};
}

#define PL_PARAM_BODIES(count, most)                                                               \
    {                                                                                              \
        "n", count, 1, most, true, "1", "number of bodies"                                         \
    }
#define PL_POURED                                                                                  \
    .reference = "no closed form for the motion; " PL_CHAOTIC_REFERENCE,                           \
    .expected = "ok: the bodies come to rest in the container, but for what still rolls; no two "  \
                "overlap at any time",                                                             \
    .source = PL_CHAOTIC_SOURCE, PL_CHAOTIC_JUDGED

/* ---- Loose pile ---- */

enum { PILE_COUNT, PILE_SHAPE, PILE_COLUMNS, PILE_GAP, PILE_FRICTION };

static const pl_param pile_params[] = {
    PL_PARAM_BODIES(100, 100000),
    {"shape", BOTH, SPHERES, ALL, true, "1",
     "0 spheres, 1 boxes, 2 either at random, 3 rings of 500 triangles, 4 any of the shapes"},
    {"columns", 0, 0, 1000, true, "1",
     "cells of the lattice in x and in y; 0: so many that it is about twice as high as wide"},
    {"gap", 0.1, 0, 100, false, "m",
     "between two cells: with a wide one bodies rain down, each for itself"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(4),
};

static void pile_build(pl_builder *b, const double *values)
{
    const kit k = make_kit(b, (family)values[PILE_SHAPE], 0.35, 0.5);
    const int count = (int)values[PILE_COUNT], columns = (int)values[PILE_COLUMNS];
    const lattice l = {count, columns > 0 ? columns : columns_for(count, 2),
                       cell_of(&k, values[PILE_GAP])};
    build_planes(b, &l);
    build_bodies(b, &k, &l);
}

const pl_scenario pl_scenario_pile = {
    .name = "pile",
    .title = "Loose pile",
    .description = "Bodies of random sizes and orientations fall into a box of planes: contacts in "
                   "every direction that come and go at every step, none of them stacked.",
    .provokes =
        "many bodies of odd shapes at once, meshes that are hollow among them: bodies pass into "
        "each other or are thrown, and a step takes too long; a right engine keeps them apart "
        "and lets them come to rest",
    PL_POURED,
    PL_PARAMS(pile_params),
    .build = pile_build};

/* ---- A container that comes to rest ---- */

enum { CONTAINER_COUNT, CONTAINER_FRICTION };

static const pl_param container_params[] = {
    PL_PARAM_BODIES(100, 5000),
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(30),
};

static void container_build(pl_builder *b, const double *values)
{
    const kit k = make_kit(b, BOXES, 0.15, 0.3);
    const lattice l = dense_lattice(&k, values[CONTAINER_COUNT], 4);
    build_walls(b, &l);
    build_bodies(b, &k, &l);
}

const pl_scenario pl_scenario_container = {
    .name = "container",
    .title = "Boxes poured into a container",
    .description =
        "Boxes of random sizes are poured into a container, wedge between its walls, and "
        "lie there for most of the run: whether a heap comes to rest, stays where it "
        "is, and costs no more than that.",
    PL_POURED,
    PL_PARAMS(container_params),
    .build = container_build};

/* ---- Rubble ---- */

enum { RUBBLE_COUNT, RUBBLE_FRICTION };

static const pl_param rubble_params[] = {
    PL_PARAM_BODIES(300, 5000),
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(6),
};

static void rubble_build(pl_builder *b, const double *values)
{
    const kit k = make_kit(b, STONES, 0.2, 0.4);
    const lattice l = dense_lattice(&k, values[RUBBLE_COUNT], 3);
    build_planes(b, &l);
    build_bodies(b, &k, &l);
}

const pl_scenario pl_scenario_rubble = {
    .name = "rubble",
    .title = "Rubble of stones",
    .description = "Convex stones of random shapes, no two alike, fall into a box of planes: "
                   "contacts of vertices, edges and faces of any angle.",
    PL_POURED,
    PL_PARAMS(rubble_params),
    .build = rubble_build};

/* ---- Medley ---- */

enum { MEDLEY_COUNT, MEDLEY_FRICTION };

static const pl_param medley_params[] = {
    PL_PARAM_BODIES(80, 5000),
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(6),
};

static void medley_build(pl_builder *b, const double *values)
{
    const kit k = make_kit(b, ALL, 0.2, 0.5);
    const lattice l = dense_lattice(&k, values[MEDLEY_COUNT], 2);
    build_planes(b, &l);
    build_bodies(b, &k, &l);
}

const pl_scenario pl_scenario_medley = {
    .name = "medley",
    .title = "Medley of shapes",
    .description =
        "Boxes, spheres, capsules, cylinders, icosahedra and rings of 500 triangles, "
        "of masses that differ more than tenfold, fall into a box of planes: every pair of "
        "shapes in one heap.",
    PL_POURED,
    PL_PARAMS(medley_params),
    .build = medley_build};
