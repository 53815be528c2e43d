/* Questions about one solid of triangles, all in its own axes. */
#ifndef PE_SOLID_QUERY_H
#define PE_SOLID_QUERY_H

#include "bvh.h"
#include "mesh_solid.h"

/* A walk over the triangles of a solid near a box. */
typedef struct pe_facet_walk {
    const pe_solid *solid;
    pe_node box;
    pe_bvh_pair trees;
    pe_bvh_walk walk;
    int next, end; /* triangles left of the current leaf */
} pe_facet_walk;

/* Starts a walk near the point x. Do not copy the walk. */
void pe_walk_near_point(const pe_solid *solid, pe_vec3 x, pe_facet_walk *walk);

/* Starts a walk near the segment from x to x + d. Do not copy the walk. */
void pe_walk_near_segment(const pe_solid *solid, pe_vec3 x, pe_vec3 d, pe_facet_walk *walk);

/* The next triangle of a leaf whose box may be within `bound` (m). False: there are no more. The
 * bound may shrink from call to call. */
bool pe_walk_next(pe_facet_walk *walk, double bound, pe_facet *facet);

/* A vertex that is farthest along d. */
pe_vec3 pe_solid_support(const pe_solid *solid, pe_vec3 d);

/* The point of the surface nearest to x. */
pe_vec3 pe_solid_nearest_point(const pe_solid *solid, pe_vec3 x);

/* Whether the point lies in the solid. */
bool pe_solid_contains(const pe_solid *solid, pe_vec3 x);

/* The distance from x along d, in units of d, to where the surface is crossed outwards; 0: it is
 * not crossed within d. Crossings within the slack count, so that rounding does not decide. */
double pe_solid_exit(const pe_solid *solid, pe_vec3 x, pe_vec3 d, double slack);

/* Whether a triangle of another face crosses the segment from x along d to the face. Its ends do
 * not count, nor do neighbours of the face: where two faces make a sharp edge, a point under one
 * lies next to the other, and still leaves the solid over the edge. */
bool pe_solid_blocks(const pe_solid *solid, pe_vec3 x, pe_vec3 d, int face, double slack);

#endif
