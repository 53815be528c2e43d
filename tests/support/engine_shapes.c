#include "engine_shapes.h"

#include "check.h"
#include "polyhedra.h"
#include "rotation_for_tests.h"

#include <math.h>
#include <string.h>

bool knows(const pl_engine_choice *choice, pl_shape_kind kind)
{
    return (choice->engine->capabilities & (uint32_t)PL_NEEDS_PLANE << kind) != 0;
}

const char *kind_name(pl_shape_kind kind)
{
    return pl_needs_name((uint32_t)PL_NEEDS_PLANE << kind);
}

double solid_width(pl_shape_kind kind, double half, int axis)
{
    static const double of_box[3] = {0.8, 0.9, 1};
    double share = kind == PL_SHAPE_CAPSULE && axis < 2 ? 0.5 : 1;
    return half * (kind >= PL_SHAPE_HULL ? of_box[axis] : share);
}

/* The frame of hulls and meshes: a vertex v along the solid's axes is at middle + turn v. */
static const double middle[3] = {0.7, -0.4, 0.9}, turn[4] = {0.5, -0.1, 0.7, 0.5};

static pl_shape polyhedron_shape(pl_scene *scene, pl_shape_kind kind, double half)
{
    const double origin[3] = {0, 0, 0};
    double widths[3], corners[8][3];
    for (int k = 0; k < 3; ++k) {
        widths[k] = solid_width(kind, half, k);
    }
    pl_scene straight = pl_scene_default();
    const pl_polyhedron *box = box_mesh(&straight, widths, origin, 1), *made = NULL;
    const int(*triangles)[3] = (const int(*)[3])box->triangles;
    assert_int_equal(box->vertex_count, 8);
    for (int i = 0; i < 8; ++i) {
        to_world(turn, box->vertices[i], corners[i]);
        for (int k = 0; k < 3; ++k) {
            corners[i][k] += middle[k];
        }
    }
    pl_status status =
        kind == PL_SHAPE_HULL
            ? pl_scene_add_hull(scene, NULL, (const double(*)[3])corners, 8, &made, NULL)
            : pl_scene_add_mesh(scene, NULL, (const double(*)[3])corners, 8, triangles,
                                box->triangle_count, &made, NULL);
    assert_int_equal(status, PL_OK);
    pl_scene_free(&straight);
    return pl_shape_of(made);
}

static pl_shape solid_shape(pl_scene *scene, pl_shape_kind kind, double half)
{
    switch (kind) {
    case PL_SHAPE_PLANE:
        return pl_shape_plane(0, 0, 1, half);
    case PL_SHAPE_SPHERE:
        return pl_shape_sphere(half);
    case PL_SHAPE_BOX:
        return pl_shape_box(half, half, half);
    case PL_SHAPE_CAPSULE:
        return pl_shape_capsule(half / 2, half / 2);
    case PL_SHAPE_CYLINDER:
        return pl_shape_cylinder(half, half);
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        break;
    }
    return polyhedron_shape(scene, kind, half);
}

pl_body solid_body(pl_scene *scene, pl_shape_kind kind, double half, const double at[3], int axis,
                   double angle)
{
    const double back[4] = {turn[0], -turn[1], -turn[2], -turn[3]};
    double solid[4] = {cos(angle / 2), 0, 0, 0}, from_frame[3];
    pl_body body = pl_body_default();
    body.shape = solid_shape(scene, kind, half);
    solid[1 + axis] = sin(angle / 2);
    memcpy(body.position, at, sizeof body.position);
    memcpy(body.orientation, solid, sizeof solid);
    if (body.shape.polyhedron != NULL) {
        quaternion_product(solid, back, body.orientation);
        to_world(body.orientation, middle, from_frame);
        for (int k = 0; k < 3; ++k) {
            body.position[k] -= from_frame[k];
        }
    }
    return body;
}
