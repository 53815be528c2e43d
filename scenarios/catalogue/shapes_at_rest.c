/* Shapes other than boxes and spheres at rest: one of each kind on the floor, and linked rings. */
#include "catalogue.h"
#include "solids.h"

#include <math.h>

/* Of a torus. */
enum { AROUND = 24, SIDES = 12 };

/* One body of each kind of shape, at rest on the floor.
 *
 * It starts where it rests: the height of its frame over its lowest face, edge or line. A sphere is
 * not among them, because nothing keeps one from rolling. */

enum { REST_SHAPE_SHAPE, REST_SHAPE_MESH, REST_SHAPE_FRICTION };
enum { BOX, CYLINDER_ON_CAP, CYLINDER_ON_SIDE, CAPSULE, TETRAHEDRON, ICOSAHEDRON, ANGLE, TORUS };

static const pl_param rest_shape_params[] = {
    {"shape", BOX, BOX, TORUS, true, "1",
     "0 box, 1 cylinder on its cap, 2 cylinder on its side, 3 capsule, 4 tetrahedron, 5 "
     "icosahedron, 6 L, 7 torus"},
    {"mesh", 0, 0, 1, true, "1",
     "1: box, tetrahedron and icosahedron as meshes; L and torus always are"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static const double side = 0.5;                      /* m */
static const double radius = 0.3, half_height = 0.4; /* m, of the round ones */
static const double rest_shape_ring_radius = 0.5,
                    rest_shape_tube_radius = 0.2; /* m, of the torus */

/* Turns the z axis into y. */
static void lay_down(pl_body *body)
{
    body->orientation[0] = sqrt(0.5);
    body->orientation[1] = -sqrt(0.5);
}

/* The polyhedra; returns the height of the frame. */
static double shape_polyhedron(pl_builder *b, int shape, bool mesh, pl_body *body)
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
        solid = pl_solid_torus(rest_shape_ring_radius, rest_shape_tube_radius, AROUND, SIDES);
        height = pl_torus_half_height(rest_shape_tube_radius, SIDES);
        break;
    default:
        solid = pl_solid_angle(2 * side, 0.6 * side, side);
        break;
    }
    bool convex = !mesh && shape != ANGLE && shape != TORUS;
    body->shape = pl_build_solid(b, &solid, convex, name);
    return height;
}

static void shape_body(pl_builder *b, int shape, bool mesh, pl_body *body)
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
        body->position[2] = shape_polyhedron(b, shape, mesh, body);
    }
}

static void rest_shape_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    pl_body body = pl_body_default();
    shape_body(b, (int)values[REST_SHAPE_SHAPE], values[REST_SHAPE_MESH] != 0, &body);
    pl_build_rest(b, pl_build_body(b, &body, "body"));
    b->scene->collapse_distance = 0.5;
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
    PL_ACCEPT_AT_REST,
    PL_PARAMS(rest_shape_params),
    .build = rest_shape_build};

/* Rings that hang in each other, as links of a chain.
 *
 * Both are tori of straight pieces. The upper one stands still in the plane y = 0; the lower one,
 * in the plane x = 0, hangs from it: the middle of the innermost flat side of one lies on that of
 * the other, at a hole's radius below the upper and above the lower centre. Each side holds the
 * other like a saddle. */

enum { LINKED_RINGS_DROP, LINKED_RINGS_COUNT, LINKED_RINGS_FRICTION };

static const double linked_rings_ring_radius = 0.5, linked_rings_tube_radius = 0.15; /* m */

static const pl_param linked_rings_params[] = {
    {"drop", 0, 0, 0.3, false, "m", "height from which the lowest ring falls into the one above"},
    {"rings", 1, 1, 50, true, "1", "rings that hang, each from the one above"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void linked_rings_build(pl_builder *b, const double *values)
{
    pl_solid solid =
        pl_solid_torus(linked_rings_ring_radius, linked_rings_tube_radius, AROUND, SIDES);
    pl_body ring = pl_body_at(pl_build_solid(b, &solid, false, "ring"), 0, 0, 0);
    ring.is_static = true;
    ring.orientation[0] = ring.orientation[1] = sqrt(0.5); /* its axis along y */
    pl_build_body(b, &ring, "upper ring");

    ring.is_static = false;
    const double hole =
        pl_torus_hole(linked_rings_ring_radius, linked_rings_tube_radius, AROUND, SIDES);
    const int count = (int)values[LINKED_RINGS_COUNT];
    for (int i = 1; i <= count; ++i) {
        ring.orientation[1] = i % 2 == 0 ? sqrt(0.5) : 0;
        ring.orientation[2] = i % 2 == 0 ? 0 : sqrt(0.5); /* its axis along x */
        ring.position[2] = -2 * i * hole;
        const int lower = i == 1 ? pl_build_body(b, &ring, "lower ring")
                                 : pl_build_body(b, &ring, "lower ring %d", i);
        pl_build_rest(b, lower);
        pl_build_start_off(b, lower, 2, i == count ? values[LINKED_RINGS_DROP] : 0);
    }
    b->scene->collapse_distance = linked_rings_ring_radius;
}

const pl_scenario pl_scenario_linked_rings = {
    .name = "linked-rings",
    .title = "Ring hanging in a ring",
    .description =
        "Two tori of triangles, linked: neither is convex, and where they touch both are "
        "hollow. Whether one hangs in the other without passing through.",
    .reference = "each centre hangs two inner radii below the one above",
    .expected = "ok: each ring hangs in the one above, at rest",
    .source = "by symmetry",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(linked_rings_params),
    .build = linked_rings_build};
