/* The steps that make a geometry, called by geometry.c in this order. */
#ifndef PE_GEOMETRY_BUILD_H
#define PE_GEOMETRY_BUILD_H

#include "geometry.h"

/* Volume, centre of mass and principal inertia: the exact integrals over the solid inside the
 * triangles, whose indices and numbers must be valid. The principal axes are right-handed. A solid
 * whose products of inertia vanish keeps its own axes. volume <= 0: the surface is inside out, and
 * the rest has no meaning. */
pe_geometry_frame pe_geometry_mass(const pe_geometry_def *def);

/* Finds the faces, edges and fans of *g from its vertices and triangles. Takes memory from
 * g->arena, and from `work` for the time of the call. PE_BAD_ARGUMENT reports where the surface is
 * open, has no area or, if it must be convex, is not. */
pe_status pe_geometry_find_surface(pe_geometry *g, bool must_be_convex,
                                   const pe_allocator *allocator, pe_workspace work,
                                   pe_error *error);

/* Makes g->nodes, and sorts the triangles and their arrays in the order of the leaves. Takes memory
 * as pe_geometry_find_surface does. */
pe_status pe_geometry_make_tree(pe_geometry *g, const pe_allocator *allocator, pe_workspace work,
                                pe_error *error);

/* Diagonalises the symmetric matrix a. Its diagonal then holds the eigenvalues, and the columns of
 * the rotation `axes` are the principal axes. Off-diagonal entries of rounding are left, so that a
 * matrix that is diagonal keeps its own axes. */
void pe_principal_axes(double a[3][3], double axes[3][3]);

#endif
