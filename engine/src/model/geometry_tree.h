/* The tree of boxes around the triangles of a solid. */
#ifndef PE_GEOMETRY_TREE_H
#define PE_GEOMETRY_TREE_H

#include "geometry.h"

/* Fills g->nodes, taking from g->arena, and puts the triangles and what belongs to them in the
 * order of its leaves. */
pe_status pe_geometry_make_tree(pe_geometry *g, const pe_allocator *allocator, pe_workspace work,
                                pe_error *error);

#endif
