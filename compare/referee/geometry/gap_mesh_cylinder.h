/* The gap of a mesh and a cylinder, the one bounded shape that has neither a flat surface nor a
 * core that has. */
#ifndef PLUMB_GAP_MESH_CYLINDER_H
#define PLUMB_GAP_MESH_CYLINDER_H

#include "surface.h"

/* As pl_gap_mesh; `axes` and `offset` are the cylinder's pose in the mesh's frame. */
pl_status pl_gap_mesh_cylinder(const pl_surface *mesh, const pl_shape *cylinder,
                               const pl_axes *axes, pl_vec offset, double within, double *gap);

#endif
