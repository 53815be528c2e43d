#include "shape_check.h"

#include "check_number.h"

static bool check_half_extents(const double half_extents[3], pl_complaint *complaint)
{
    pl_path_push_key(&complaint->path, "half_extents");
    for (int k = 0; k < 3; k++) {
        pl_path_push_index(&complaint->path, k);
        if (!pl_check_positive(complaint, NULL, half_extents[k])) {
            return false;
        }
        pl_path_pop(&complaint->path);
    }
    pl_path_pop(&complaint->path);
    return true;
}

bool pl_check_shape(const pl_shape *shape, pl_complaint *complaint)
{
    switch (shape->kind) {
    case PL_SHAPE_PLANE:
        return pl_check_unit(complaint, "normal", shape->normal, 3, "a unit vector") &&
               pl_check_is_finite(complaint, "offset", shape->offset);
    case PL_SHAPE_SPHERE:
        return pl_check_positive(complaint, "radius", shape->radius);
    case PL_SHAPE_BOX:
        return check_half_extents(shape->half_extents, complaint);
    case PL_SHAPE_CAPSULE:
    case PL_SHAPE_CYLINDER:
        return pl_check_positive(complaint, "radius", shape->radius) &&
               pl_check_positive(complaint, "half_height", shape->half_height);
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        return true; /* pl_polyhedron_of_hull and pl_polyhedron_of_mesh have seen to it */
    default:
        return pl_complain_of(complaint, "type", "expected a known shape, found number %d",
                              (int)shape->kind);
    }
}

bool pl_check_polyhedron(const pl_shape *shape, const pl_address_list *polyhedra,
                         pl_complaint *complaint)
{
    if (shape->kind != PL_SHAPE_HULL && shape->kind != PL_SHAPE_MESH) {
        return true;
    }
    if (pl_address_list_find(polyhedra, shape->polyhedron) < 0) {
        return pl_complain(complaint, "expected a polyhedron of the scene, found %s",
                           shape->polyhedron == NULL ? "none" : "another");
    }
    if (shape->polyhedron->convex != (shape->kind == PL_SHAPE_HULL)) {
        return pl_complain_of(complaint, "type", "expected a %s for this polyhedron, found a %s",
                              shape->polyhedron->convex ? "hull" : "mesh",
                              shape->kind == PL_SHAPE_HULL ? "hull" : "mesh");
    }
    return true;
}
