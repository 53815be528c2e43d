/* Narrow phase: the contact manifolds of a pair of placed shapes. */
#ifndef PE_COLLIDE_H
#define PE_COLLIDE_H

#include "model/geometry.h"
#include "model/world.h"

/* A manifold point as the narrow phase finds it. */
typedef struct pe_pair_point {
    pe_vec3 position; /* world, halfway between the surfaces */
    double separation;
    uint64_t feature; /* the features that touch, unique in its manifold: see feature_id.h */
} pe_pair_point;

/* A contact manifold: points that share one normal. It is empty if the gap exceeds the margin. */
typedef struct pe_pair_manifold {
    pe_vec3 normal;   /* unit, from the first shape to the second */
    bool normal_on_b; /* the normal turns with the second shape; else, at small turns, the first */
    double least_margin, end_margin; /* m: the same points at every margin in [least, end) */
    int count;
    pe_pair_point item[PE_MAX_POINTS];
} pe_pair_manifold;

/* A shape with its pose and the scale of its tolerances. */
typedef struct pe_placed {
    const pe_shape *shape;
    const pe_geometry *geometry; /* of a hull or mesh; else NULL */
    const pe_pose *pose;         /* of the body's axes: see geometry.h */
    double size;                 /* m, pe_shape_size */
} pe_placed;

/* Fills `manifolds`, which has room for PE_MAX_MANIFOLDS, for two shapes whose gap is at most
 * `margin` (m). Handles all pairs of kinds except two planes; convex shapes have at most one
 * manifold. Returns the number of manifolds, or -1 when out of memory; only meshes take memory,
 * from `work`. Swapping the shapes reverses the normal. */
int pe_collide(pe_placed a, pe_placed b, double margin, pe_workspace work,
               pe_pair_manifold *manifolds);

/* A collider of convex shapes of given kinds. It is called with an empty manifold (see
 * pe_pair_manifold_clear) and leaves it empty if the gap exceeds `margin`. */
typedef void pe_collider(pe_placed a, pe_placed b, double margin, pe_pair_manifold *manifold);

pe_collider pe_collide_plane_sphere, pe_collide_plane_box, pe_collide_plane_capsule,
    pe_collide_plane_cylinder, pe_collide_plane_hull;
pe_collider pe_collide_sphere_sphere, pe_collide_sphere_box, pe_collide_sphere_cylinder;
pe_collider pe_collide_box_box;
pe_collider pe_collide_cylinder_cylinder, pe_collide_cylinder_hull;
/* Of a box or capsule and a cylinder. */
pe_collider pe_collide_polytope_cylinder;
/* Of a capsule and a sphere or capsule. */
pe_collider pe_collide_capsule_or_sphere;
/* Of sphere, box, capsule and hull, where at least one is a box or a hull. */
pe_collider pe_collide_polytopes;

/* A collider of a shape of given kind and a mesh. Returns what pe_collide does. */
typedef int pe_mesh_collider(pe_placed other, pe_placed mesh, double margin, pe_workspace work,
                             pe_pair_manifold *manifolds);

pe_mesh_collider pe_collide_plane_mesh, pe_collide_cylinder_mesh;
/* Of a mesh and a sphere, box, capsule, hull or mesh. */
pe_mesh_collider pe_collide_solid_mesh;

/* Removes all points. The manifold then holds at every margin. */
static inline void pe_pair_manifold_clear(pe_pair_manifold *manifold)
{
    manifold->normal_on_b = false;
    manifold->least_margin = -HUGE_VAL;
    manifold->end_margin = HUGE_VAL;
    manifold->count = 0;
}

/* Narrows the range of margins by a point with this separation. Returns whether the point lies
 * within the margin. */
static inline bool pe_pair_manifold_within(pe_pair_manifold *manifold, double separation,
                                           double margin)
{
    if (separation > margin) {
        manifold->end_margin = pe_min(manifold->end_margin, separation);
        return false;
    }
    manifold->least_margin = pe_max(manifold->least_margin, separation);
    return true;
}

/* The axes of one body seen from another: x = turn x_other + offset. */
typedef struct pe_transform {
    pe_mat3 turn;
    pe_vec3 offset; /* m */
} pe_transform;

static inline pe_vec3 pe_transform_point(const pe_transform *t, pe_vec3 x)
{
    return pe_add(pe_rotate(&t->turn, x), t->offset);
}

/* The inverse of pe_transform_point. */
static inline pe_vec3 pe_transform_back(const pe_transform *t, pe_vec3 x)
{
    return pe_unrotate(&t->turn, pe_sub(x, t->offset));
}

/* From the body's axes to the world, and back. */
static inline pe_vec3 pe_pose_to_world(const pe_pose *pose, pe_vec3 x)
{
    return pe_add(pose->position, pe_rotate(&pose->rotation, x));
}

static inline pe_vec3 pe_pose_to_body(const pe_pose *pose, pe_vec3 x)
{
    return pe_unrotate(&pose->rotation, pe_sub(x, pose->position));
}

#endif
