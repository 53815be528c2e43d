/* Volume, centre of mass and principal inertia of a polyhedron. */
#ifndef PE_GEOMETRY_MASS_H
#define PE_GEOMETRY_MASS_H

#include "geometry.h"

/* The exact integrals over the solid within the triangles, whose indices and numbers are right. The
 * principal axes are right-handed; a solid whose products of inertia vanish keeps its own axes.
 * volume <= 0: the surface is inside out, and the rest has no meaning. */
pe_geometry_frame pe_geometry_mass(const pe_geometry_def *def);

/* Turns the symmetric matrix a to its principal axes, the columns of the rotation `axes`; its
 * eigenvalues are then its diagonal. Off-diagonal entries of rounding are left, so that a matrix
 * that is diagonal keeps its own axes. */
void pe_principal_axes(double a[3][3], double axes[3][3]);

#endif
