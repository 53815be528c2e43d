/* A cylinder and one triangle of a mesh, all in the mesh's axes. */
#ifndef PE_MESH_CYLINDER_FACET_H
#define PE_MESH_CYLINDER_FACET_H

#include "narrow_phase/cylinder/cylinder.h"
#include "touches.h"

/* A cylinder and a mesh that are tested against each other. */
typedef struct pe_cylinder_mesh {
    pe_placed cylinder, mesh;
    pe_cylinder c; /* in the mesh's axes */
    pe_solid solid;
    double size; /* m, of the smaller shape: the scale of tolerances */
} pe_cylinder_mesh;

/* The feature of a touch on a face, besides the face: a point of the cylinder, or one that an edge
 * or a corner of the face bounds. */
typedef enum pe_rim_point {
    PE_AT_RIM,        /* and the next three: four directions of the face's axes */
    PE_AT_LOWEST = 4, /* of the cylinder */
    PE_AT_LINE_END,   /* and the next one: the lowest line of the side */
    PE_AT_NEAREST = 7,
    PE_AT_ENTRY,  /* where an edge comes below the cylinder; 4 more for each next edge */
    PE_AT_EXIT,   /* where it leaves again */
    PE_AT_CORNER, /* 4 more for each next vertex */
} pe_rim_point;

/* A touch along a face's normal, by a point of the cylinder (a pe_rim_point) and its height. */
pe_touch pe_cylinder_touch(const pe_facet *f, int point, pe_vec3 on_a, double height);

/* Adds the points of the cylinder over the triangle, as seen along its normal, that bound the part
 * of the cylinder over the face, with heights from `low` to `high`. Edges inside a face bound
 * nothing, so that its triangles together give what the whole face would. */
void pe_cylinder_touches_on_facet(const pe_cylinder_mesh *pair, const pe_facet *f, double low,
                                  double high, pe_touches *list);

/* The point of the triangle in the cylinder that is nearest to the axis. False: there is none. */
bool pe_cylinder_facet_point(const pe_cylinder *c, const pe_facet *f, pe_vec3 *x);

/* The distance from a point in the cylinder, along the unit direction n, to its surface. */
double pe_cylinder_exit(const pe_cylinder *c, pe_vec3 x, pe_vec3 n);

/* The place on the mesh where a triangle is nearest along a direction. */
typedef struct pe_cylinder_place {
    enum {
        PE_NOWHERE,      /* the mesh does not face that direction there */
        PE_ON_FACE,      /* along its normal */
        PE_NEXT_TO_EDGE, /* at an edge or a vertex of a face, along its normal except for
                            PE_NEXT_TO_FACE */
        PE_AT_EDGE,
        PE_AT_VERTEX
    } kind;
    int face;         /* of PE_ON_FACE and PE_NEXT_TO_EDGE; else -1 */
    uint64_t feature; /* id of the nearest point there */
} pe_cylinder_place;

/* The feature of the triangle that is last along the unit direction `out`, away from the mesh, if
 * the mesh faces that direction there. `by_faces`: edges and vertices may be next to faces. */
pe_cylinder_place pe_cylinder_find_place(const pe_cylinder_mesh *pair, pe_facet *f, pe_vec3 out,
                                         bool by_faces);

/* The manifold of the cylinder and the triangle, as of two convex shapes, in the world. */
void pe_collide_cylinder_facet(const pe_cylinder_mesh *pair, const pe_facet *f, double margin,
                               pe_pair_manifold *manifold);

#endif
