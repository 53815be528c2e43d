/* Narrow phase: the contact points of a pair of placed shapes. */
#ifndef PE_COLLIDE_H
#define PE_COLLIDE_H

#include "model/geometry.h"
#include "model/world.h"

/* One point as a collider finds it. */
typedef struct pe_pair_point {
    pe_vec3 position; /* world, halfway between the surfaces */
    double separation;
    uint64_t feature; /* names the features that touch: other points of the patch have others */
} pe_pair_point;

/* A patch of contact: points that share one normal. count 0: farther apart than the margin. */
typedef struct pe_pair_manifold {
    pe_vec3 normal;   /* unit, from the first shape to the second */
    bool normal_on_b; /* it turns with the second shape; else, at small turns, with the first */
    double least_margin, end_margin; /* m: the same points at every margin in [least, end) */
    int count;
    pe_pair_point item[PE_MAX_POINTS];
} pe_pair_manifold;

/* A shape where it is, with the scale of its tolerances. */
typedef struct pe_placed {
    const pe_shape *shape;
    const pe_geometry *geometry; /* of a hull or mesh; else NULL */
    const pe_pose *pose;         /* of the body's axes: see geometry.h */
    double size;                 /* m, pe_shape_size */
} pe_placed;

/* Patches of two shapes with a gap of at most `margin`: all kinds but plane against plane. Convex
 * shapes have one at most. `patches` has room for PE_MAX_MANIFOLDS. Returns how many there are; -1
 * when out of memory, which only meshes take, from `work`. Swapping the shapes swaps the normal. */
int pe_collide(pe_placed a, pe_placed b, double margin, pe_workspace work,
               pe_pair_manifold *patches);

/* A collider of convex shapes, by kinds; it finds *hits empty (as pe_pair_manifold_clear makes it).
 */
typedef void pe_collider(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits);

pe_collider pe_collide_plane_sphere, pe_collide_plane_box, pe_collide_plane_capsule,
    pe_collide_plane_cylinder, pe_collide_plane_hull;
pe_collider pe_collide_sphere_sphere, pe_collide_sphere_box, pe_collide_sphere_cylinder;
pe_collider pe_collide_box_box, pe_collide_box_cylinder;
pe_collider pe_collide_capsule_cylinder;
pe_collider pe_collide_cylinder_cylinder, pe_collide_cylinder_hull;
/* Of a capsule and a sphere or capsule. */
pe_collider pe_collide_capsule_or_sphere;
/* Of sphere, box, capsule and hull, where one at least is a box or a hull. */
pe_collider pe_collide_polytopes;

/* Any shape against a mesh: returns as pe_collide does. */
int pe_collide_with_mesh(pe_placed other, pe_placed mesh, double margin, pe_workspace work,
                         pe_pair_manifold *patches);

/* Makes it empty, without touching the points. */
static inline void pe_pair_manifold_clear(pe_pair_manifold *hits)
{
    hits->normal_on_b = false;
    hits->least_margin = -HUGE_VAL;
    hits->end_margin = HUGE_VAL;
    hits->count = 0;
}

#endif
