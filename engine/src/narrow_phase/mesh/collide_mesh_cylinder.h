/* What the parts of the collider of a cylinder and a mesh share. All is in the mesh's axes. */
#ifndef PE_COLLIDE_MESH_CYLINDER_H
#define PE_COLLIDE_MESH_CYLINDER_H

#include "collide_mesh.h"
#include "narrow_phase/cylinder/cylinder.h"

/* What names a contact on a face beside the face: a point of the cylinder, or one that an edge or a
 * corner of the face bounds. */
typedef enum pe_cylinder_point {
    PE_AT_RIM,        /* and the three after it: four directions of the face's axes */
    PE_AT_LOWEST = 4, /* of the cylinder */
    PE_AT_LINE_END,   /* and the one after it: the lowest line of the side */
    PE_AT_NEAREST = 7,
    PE_AT_ENTRY,  /* where an edge comes below the cylinder; 4 more for each next edge */
    PE_AT_EXIT,   /* where it leaves it again */
    PE_AT_CORNER, /* 4 more for each next vertex */
} pe_cylinder_point;

/* A contact of the cylinder along a face's normal, by a point of the cylinder and its height. */
pe_touch pe_cylinder_touch(const pe_facet *f, int point, pe_vec3 on_a, double height);

/* The same at an edge or a vertex of the mesh. */
static inline int pe_cylinder_point_of(pe_cylinder_point point, int index)
{
    return (int)point + 4 * index;
}

/* Least cosine between a face's normal and the axis of a cylinder whose cap lies along it, nearly.
 */
#define PE_CAP_ON_FACE 0.98

/* Adds the points of the cylinder over the triangle, as seen along its normal, that span what of it
 * lies over the face: heights from `low` to `high`. `size`: m, of the smaller shape. Edges inside a
 * face bound nothing, so that its triangles together say what the whole face would. */
void pe_cylinder_touches_on_facet(const pe_cylinder *c, const pe_solid *mesh, const pe_facet *f,
                                  double size, double low, double high, pe_touches *list);

/* The point of the triangle within the cylinder that is nearest to the axis; false: there is none.
 */
bool pe_cylinder_facet_point(const pe_cylinder *c, const pe_facet *f, pe_vec3 *x);

/* How far it is from a point in the cylinder, along the unit direction n, to its surface. */
double pe_cylinder_translation(const pe_cylinder *c, pe_vec3 x, pe_vec3 n);

/* Where on the mesh a triangle is nearest along a direction. */
typedef struct pe_cylinder_place {
    enum {
        PE_NOWHERE,     /* the mesh does not have the direction there */
        PE_ON_FACE,     /* along its normal */
        PE_BESIDE_FACE, /* at an edge or a vertex of it, along its normal but for PE_BESIDE */
        PE_AT_EDGE,
        PE_AT_VERTEX
    } kind;
    int face;      /* on or beside which it is; else -1 */
    uint64_t name; /* of the nearest point there, as a feature */
} pe_cylinder_place;

/* Sine of the angle up to which a direction at an edge is a face's: that of one patch. */
#define PE_BESIDE 1e-3

/* What of the triangle is last along the unit direction `out`, away from the mesh, if the mesh has
 * that direction there. `by_faces`: edges and vertices may be beside faces. `size`: m, of the
 * smaller shape. */
pe_cylinder_place pe_cylinder_find_place(const pe_solid *mesh, double size, pe_facet *f,
                                         pe_vec3 out, bool by_faces);

/* Points of the cylinder and the triangle, which is in the axes of `mesh`, as of two convex shapes.
 * `size`: m, of the smaller shape. */
void pe_collide_cylinder_facet(pe_placed cylinder, const pe_facet *f, const pe_pose *mesh,
                               double size, double margin, pe_pair_manifold *hits);

#endif
