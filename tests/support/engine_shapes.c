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

/* `middle` is that of the solid in the shape's frame. */
static pl_shape solid_shape(pl_scene *scene, pl_shape_kind kind, double half, double middle[3])
{
    const double halves[3] = {half, half, half};
    memset(middle, 0, 3 * sizeof *middle);
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
    memcpy(middle, (double[]){0.7, -0.4, 0.9}, 3 * sizeof *middle);
    const pl_polyhedron *mesh = box_mesh(scene, halves, middle, 1), *hull = NULL;
    if (kind == PL_SHAPE_MESH) {
        return pl_shape_of(mesh);
    }
    const double(*corners)[3] = (const double(*)[3])mesh->vertices;
    assert_int_equal(pl_scene_add_hull(scene, NULL, corners, mesh->vertex_count, &hull, NULL),
                     PL_OK);
    return pl_shape_of(hull);
}

pl_body solid_body(pl_scene *scene, pl_shape_kind kind, double half, const double at[3], int axis,
                   double angle)
{
    double middle[3], turned[3];
    pl_body body = pl_body_default();
    body.shape = solid_shape(scene, kind, half, middle);
    body.orientation[0] = cos(angle / 2);
    body.orientation[1 + axis] = sin(angle / 2);
    to_world(body.orientation, middle, turned);
    for (int k = 0; k < 3; k++) {
        body.position[k] = at[k] - turned[k];
    }
    return body;
}
