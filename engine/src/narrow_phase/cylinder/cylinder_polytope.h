/* The signed distance of a cylinder and a convex polyhedron or a segment. */
#ifndef PE_CYLINDER_POLYTOPE_H
#define PE_CYLINDER_POLYTOPE_H

#include "cylinder.h"
#include "narrow_phase/convex/polytope.h"

/* What meets what: the polytope's feature first. */
typedef enum pe_meeting {
    PE_FACE_CYLINDER, /* along the face's normal */
    PE_CORNER_CAP,    /* along the axis */
    PE_EDGE_SIDE,
    PE_CORNER_CYLINDER, /* along the line from the corner to the nearest point or to the axis */
    PE_EDGE_RIM
} pe_meeting;

typedef struct pe_meeting_gap {
    double distance; /* m, of the polytope's core from the cylinder; negative when they overlap */
    pe_vec3 normal;  /* unit, from the polytope to the cylinder */
    pe_meeting kind;
    int index; /* of the face, edge or vertex */
} pe_meeting_gap;

/* Where an edge is nearest to the cylinder that meets it along `normal` at the distance given, in
 * parts of the way from its first vertex to its second; where that is many places, any. */
double pe_cylinder_edge_place(const pe_polytope *p, const pe_cylinder *c,
                              const pe_meeting_gap *gap);

/* The gap of a polytope and a cylinder in the same axes. Of a face and a cap that come within
 * `bias` (m) of each other, the face is taken if `face_first`; any other meeting must be better
 * than both by as much. `size` is that of the smaller shape. False as soon as some direction
 * separates them by more than `limit`. O(vertices + edges + faces). */
bool pe_cylinder_polytope_gap(const pe_polytope *p, const pe_cylinder *c, double size, double bias,
                              bool face_first, double limit, pe_meeting_gap *gap);

#endif
