/* Files of meshes. */
#ifndef PLUMB_MESH_FILE_H
#define PLUMB_MESH_FILE_H

#include "plumb/scene.h"

/* The solid within the faces of a Wavefront .obj file; the caller frees *polyhedron by
 * pl_polyhedron_free. PL_BAD_INPUT says PATH:LINE: what was expected, what was found. */
pl_status pl_polyhedron_of_file(const char *path, pl_polyhedron **polyhedron, pl_error *error);

#endif
