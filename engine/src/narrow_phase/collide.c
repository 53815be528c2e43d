/* The table of colliders by kinds of shape. */
#include "collide.h"

/* Rows and columns as in pe_shape_kind, meshes apart; the lower triangle is the upper one with the
 * shapes swapped. */
static pe_collider *const colliders[PE_SHAPE_MESH][PE_SHAPE_MESH] = {
    {NULL, pe_collide_plane_sphere, pe_collide_plane_box, pe_collide_plane_capsule,
     pe_collide_plane_cylinder, pe_collide_plane_hull},
    {NULL, pe_collide_sphere_sphere, pe_collide_sphere_box, pe_collide_capsule_or_sphere,
     pe_collide_sphere_cylinder, pe_collide_polytopes},
    {NULL, NULL, pe_collide_box_box, pe_collide_polytopes, pe_collide_box_cylinder,
     pe_collide_polytopes},
    {NULL, NULL, NULL, pe_collide_capsule_or_sphere, pe_collide_capsule_cylinder,
     pe_collide_polytopes},
    {NULL, NULL, NULL, NULL, pe_collide_cylinder_cylinder, pe_collide_cylinder_hull},
    {NULL, NULL, NULL, NULL, NULL, pe_collide_polytopes},
};

/* A mesh that is a small convex polyhedron is collided as the hull that it is. */
static pe_shape_kind kind_of(pe_placed p)
{
    pe_shape_kind kind = p.shape->kind;
    return kind == PE_SHAPE_MESH && pe_geometry_is_polytope(p.geometry) ? PE_SHAPE_HULL : kind;
}

/* Of shapes in the order of the table. */
static int collide_in_order(pe_placed a, pe_placed b, double margin, pe_workspace work,
                            pe_pair_manifold *patches)
{
    if (kind_of(b) == PE_SHAPE_MESH) {
        return pe_collide_with_mesh(a, b, margin, work, patches);
    }
    pe_pair_manifold_clear(patches);
    colliders[kind_of(a)][kind_of(b)](a, b, margin, patches);
    return patches->count > 0;
}

int pe_collide(pe_placed a, pe_placed b, double margin, pe_workspace work,
               pe_pair_manifold *patches)
{
    if (kind_of(a) <= kind_of(b)) {
        return collide_in_order(a, b, margin, work, patches);
    }
    int count = collide_in_order(b, a, margin, work, patches);
    for (int i = 0; i < count; ++i) {
        patches[i].normal = pe_scale(-1, patches[i].normal);
        patches[i].normal_on_b = !patches[i].normal_on_b;
    }
    return count;
}
