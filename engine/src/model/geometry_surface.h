/* The faces and edges of a surface of triangles. */
#ifndef PE_GEOMETRY_SURFACE_H
#define PE_GEOMETRY_SURFACE_H

#include "geometry.h"

/* Fills everything of *g but the tree from its vertices and triangles, taking from g->arena; `work`
 * is for what is needed meanwhile. PE_BAD_ARGUMENT says where the surface is open, without area or,
 * where it must be, not convex. */
pe_status pe_geometry_find_surface(pe_geometry *g, bool must_be_convex,
                                   const pe_allocator *allocator, pe_workspace work,
                                   pe_error *error);

#endif
