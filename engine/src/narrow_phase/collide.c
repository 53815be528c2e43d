/* Dispatch of the narrow phase by the kinds of the two shapes. */
#include "collide.h"

/* Rows and columns as in pe_shape_kind. The lower triangle is the upper one with the shapes
 * swapped. A mesh needs memory, so that its column has another type. */
static pe_collider *const colliders[PE_SHAPE_MESH][PE_SHAPE_MESH] = {
    {NULL, pe_collide_plane_sphere, pe_collide_plane_box, pe_collide_plane_capsule,
     pe_collide_plane_cylinder, pe_collide_plane_hull},
    {NULL, pe_collide_sphere_sphere, pe_collide_sphere_box, pe_collide_capsule_or_sphere,
     pe_collide_sphere_cylinder, pe_collide_polytopes},
    {NULL, NULL, pe_collide_box_box, pe_collide_polytopes, pe_collide_polytope_cylinder,
     pe_collide_polytopes},
    {NULL, NULL, NULL, pe_collide_capsule_or_sphere, pe_collide_polytope_cylinder,
     pe_collide_polytopes},
    {NULL, NULL, NULL, NULL, pe_collide_cylinder_cylinder, pe_collide_cylinder_hull},
    {NULL, NULL, NULL, NULL, NULL, pe_collide_polytopes},
};
static pe_mesh_collider *const mesh_colliders[PE_SHAPE_MESH + 1] = {
    pe_collide_plane_mesh,    pe_collide_solid_mesh, pe_collide_solid_mesh, pe_collide_solid_mesh,
    pe_collide_cylinder_mesh, pe_collide_solid_mesh, pe_collide_solid_mesh,
};

/* A mesh that is a small convex polyhedron is collided as a hull. */
static pe_shape_kind kind_of(pe_placed p)
{
    pe_shape_kind kind = p.shape->kind;
    return kind == PE_SHAPE_MESH && pe_geometry_is_polytope(p.geometry) ? PE_SHAPE_HULL : kind;
}

int pe_collide(pe_placed a, pe_placed b, double margin, pe_workspace work,
               pe_pair_manifold *manifolds)
{
    pe_shape_kind kind_a = kind_of(a), kind_b = kind_of(b);
    bool swap = kind_a > kind_b;
    pe_placed first = swap ? b : a, second = swap ? a : b;
    pe_shape_kind low = swap ? kind_b : kind_a, high = swap ? kind_a : kind_b;
    int count;
    if (high == PE_SHAPE_MESH) {
        count = mesh_colliders[low](first, second, margin, work, manifolds);
    } else {
        pe_pair_manifold_clear(manifolds);
        colliders[low][high](first, second, margin, manifolds);
        count = manifolds->count > 0;
    }
    for (int i = 0; i < count && swap; ++i) {
        manifolds[i].normal = pe_scale(-1, manifolds[i].normal);
        manifolds[i].normal_on_b = !manifolds[i].normal_on_b;
    }
    return count;
}
