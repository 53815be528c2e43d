/* The signed distance of a cylinder and another cylinder, a convex polyhedron or a segment. */
#ifndef PE_CYLINDER_GAP_H
#define PE_CYLINDER_GAP_H

#include "cylinder.h"
#include "narrow_phase/convex/polytope.h"

/* What a gap is wanted for. */
typedef struct pe_gap_query {
    double size;     /* m, of the smaller shape: the scale of tolerances */
    double bias;     /* m: another direction must separate more than a face or a cap by this */
    double limit;    /* m: a direction that separates by more ends the search */
    bool face_first; /* of a face and a cap within the bias of each other, the face is taken */
} pe_gap_query;

/* ---- Two cylinders ---- */

/* The features that meet. */
typedef enum pe_cylinder_meeting {
    PE_CAP_A, /* along a's axis */
    PE_CAP_B,
    PE_SIDES,  /* across both axes */
    PE_SIDE_A, /* a's side, b's rim */
    PE_SIDE_B,
    PE_RIMS
} pe_cylinder_meeting;

/* The gap of two cylinders, and the features between which it is. */
typedef struct pe_cylinder_gap {
    double distance; /* m; negative when they overlap */
    pe_vec3 normal;  /* unit, from a to b */
    pe_cylinder_meeting kind;
    pe_vec3 on_a;   /* a point of a that realises the gap */
    double outside; /* m: how far the opposite point is outside b, by the bias or by rounding */
} pe_cylinder_gap;

/* The gap of two cylinders in the same axes. False if it exceeds query->limit. */
bool pe_cylinder_pair_gap(const pe_cylinder *a, const pe_cylinder *b, const pe_gap_query *query,
                          pe_cylinder_gap *gap);

/* ---- A cylinder and a polytope ---- */

/* The features that meet; the polytope's comes first. */
typedef enum pe_meeting {
    PE_FACE_CYLINDER, /* along the face's normal */
    PE_CORNER_CAP,    /* along the axis */
    PE_EDGE_SIDE,
    PE_CORNER_CYLINDER, /* along the line from the corner to the nearest point or to the axis */
    PE_EDGE_RIM
} pe_meeting;

/* The gap of a polytope and a cylinder, and the features between which it is. */
typedef struct pe_meeting_gap {
    double distance; /* m, of the polytope's core from the cylinder; negative when they overlap */
    pe_vec3 normal;  /* unit, from the polytope to the cylinder */
    pe_meeting kind;
    int index; /* of the face, edge or vertex */
} pe_meeting_gap;

/* Where an edge is nearest to the cylinder, given its gap, as the fraction from its first vertex to
 * its second. If that is many places, any of them. */
double pe_cylinder_edge_place(const pe_polytope *p, const pe_cylinder *c,
                              const pe_meeting_gap *gap);

/* The gap of a polytope's core and a cylinder in the same axes. False if it exceeds query->limit.
 * O(vertices + edges + faces). */
bool pe_cylinder_polytope_gap(const pe_polytope *p, const pe_cylinder *c, const pe_gap_query *query,
                              pe_meeting_gap *gap);

/* Fills the empty manifold of a polytope with the pose given and a cylinder: pe_collide for a core
 * that is not a shape. query.limit is the margin, query.face_first that the polytope is the first
 * shape; the bias is not used. */
void pe_cylinder_polytope_contact(const pe_polytope *p, const pe_pose *pose, pe_placed cylinder,
                                  pe_gap_query query, pe_pair_manifold *manifold);

#endif
