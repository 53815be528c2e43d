/* One body of each kind of shape, at rest on the floor.
 *
 * It starts where it rests: the height of its frame over its lowest face, edge or line. A sphere is
 * not among them, because nothing keeps one from rolling. */
#include "catalogue.h"
#include "solids.h"

#include <math.h>
#include <string.h>

enum { SHAPE, MESH, FRICTION, DT, DURATION, PARAM_COUNT };
enum { BOX, CYLINDER_ON_CAP, CYLINDER_ON_SIDE, CAPSULE, TETRAHEDRON, ICOSAHEDRON, ANGLE, TORUS };

static const pl_param params[PARAM_COUNT] = {
    [SHAPE] = {.name = "shape",
               .value = BOX,
               .min = BOX,
               .max = TORUS,
               .integer = true,
               .unit = "1",
               .help = "0 box, 1 cylinder on its cap, 2 cylinder on its side, 3 capsule, 4 "
                       "tetrahedron, 5 icosahedron, 6 L, 7 torus"},
    [MESH] = {.name = "mesh",
              .value = 0,
              .min = 0,
              .max = 1,
              .integer = true,
              .unit = "1",
              .help = "1: box, tetrahedron and icosahedron as meshes; L and torus always are"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static const double side = 0.5;                           /* m */
static const double radius = 0.3, half_height = 0.4;      /* m, of the round ones */
static const double ring_radius = 0.5, tube_radius = 0.2; /* m, of the torus */
enum { AROUND = 24, SIDES = 12 };

/* Turns the z axis into y. */
static void lay_down(pl_body *body)
{
    body->orientation[0] = sqrt(0.5);
    body->orientation[1] = -sqrt(0.5);
}

/* The polyhedra; returns the height of the frame. */
static double shape_polyhedron(pl_builder *builder, int shape, bool mesh, pl_body *body)
{
    double height = 0;
    pl_solid solid = {0};
    const char *name = "L";
    switch (shape) {
    case BOX:
        name = "cube";
        solid = pl_solid_box(side, side, side);
        height = side;
        break;
    case TETRAHEDRON:
        name = "tetrahedron";
        solid = pl_solid_tetrahedron(2 * side, &height);
        break;
    case ICOSAHEDRON:
        name = "icosahedron";
        solid = pl_solid_icosahedron(side, &height);
        break;
    case TORUS:
        name = "torus";
        solid = pl_solid_torus(ring_radius, tube_radius, AROUND, SIDES);
        height = pl_torus_half_height(tube_radius, SIDES);
        break;
    default:
        solid = pl_solid_angle(2 * side, 0.6 * side, side);
        break;
    }
    bool convex = !mesh && shape != ANGLE && shape != TORUS;
    const pl_polyhedron *polyhedron = pl_build_solid(builder, &solid, convex, name);
    if (polyhedron != NULL) {
        body->shape = pl_shape_of(polyhedron);
    }
    return height;
}

static void shape_body(pl_builder *builder, int shape, bool mesh, pl_body *body)
{
    switch (shape) {
    case CYLINDER_ON_CAP:
        body->shape = pl_shape_cylinder(radius, half_height);
        body->position[2] = half_height;
        return;
    case CYLINDER_ON_SIDE:
    case CAPSULE:
        body->shape = shape == CAPSULE ? pl_shape_capsule(radius, half_height)
                                       : pl_shape_cylinder(radius, half_height);
        body->position[2] = radius;
        lay_down(body);
        return;
    default:
        break;
    }
    if (shape == BOX && !mesh) {
        body->shape = pl_shape_box(side, side, side);
        body->position[2] = side;
    } else {
        body->position[2] = shape_polyhedron(builder, shape, mesh, body);
    }
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_rest_shape.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body body = pl_body_default();
    shape_body(&builder, (int)values[SHAPE], values[MESH] != 0, &body);
    pl_build_rest(&builder, pl_build_body(&builder, &body, "body"));
    pl_build_judge(&builder, pl_scenario_rest_shape.primary_error, 0.5);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_rest_shape = {
    .name = "rest-shape",
    .title = "Each shape at rest",
    .description = "One body on the floor, where it rests: whether its contact points hold it, at "
                   "its own height, without rocking, rolling or turning.",
    .reference = "z = the frame's height over the lowest face, edge or line",
    .expected = "ok: the body at rest where it began",
    .source = "by geometry: a regular tetrahedron's face is at edge / sqrt(24) from its middle, an "
              "icosahedron's at edge (3 sqrt(3) + sqrt(15)) / 12",
    .primary_error = "rest_position_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
