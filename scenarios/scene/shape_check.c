#include "shape_check.h"

#include "base/diagnostic.h"

static bool check_half_extents(const double half_extents[3], pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "half_extents");
    for (int k = 0; k < 3; k++) {
        pl_path_push_index(&diagnostic->path, k);
        if (!pl_check_positive(diagnostic, NULL, half_extents[k])) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

bool pl_check_shape(const pl_shape *shape, pl_diagnostic *diagnostic)
{
    switch (shape->kind) {
    case PL_SHAPE_PLANE:
        return pl_check_unit(diagnostic, "normal", shape->normal, 3, "a unit vector") &&
               pl_check_is_finite(diagnostic, "offset", shape->offset);
    case PL_SHAPE_SPHERE:
        return pl_check_positive(diagnostic, "radius", shape->radius);
    case PL_SHAPE_BOX:
        return check_half_extents(shape->half_extents, diagnostic);
    case PL_SHAPE_CAPSULE:
    case PL_SHAPE_CYLINDER:
        return pl_check_positive(diagnostic, "radius", shape->radius) &&
               pl_check_positive(diagnostic, "half_height", shape->half_height);
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        return true; /* pl_polyhedron_of_hull and pl_polyhedron_of_mesh have seen to it */
    default:
        return pl_complain_of(diagnostic, "type", "expected a known shape, found number %d",
                              (int)shape->kind);
    }
}

bool pl_check_polyhedron(const pl_shape *shape, const pl_pointer_map *polyhedra,
                         pl_diagnostic *diagnostic)
{
    if (shape->kind != PL_SHAPE_HULL && shape->kind != PL_SHAPE_MESH) {
        return true;
    }
    if (pl_pointer_map_find(polyhedra, shape->polyhedron) < 0) {
        return pl_complain(diagnostic, "expected a polyhedron of the scene, found %s",
                           shape->polyhedron == NULL ? "none" : "another");
    }
    if (shape->polyhedron->convex != (shape->kind == PL_SHAPE_HULL)) {
        return pl_complain_of(diagnostic, "type", "expected a %s for this polyhedron, found a %s",
                              shape->polyhedron->convex ? "hull" : "mesh",
                              shape->kind == PL_SHAPE_HULL ? "hull" : "mesh");
    }
    return true;
}
