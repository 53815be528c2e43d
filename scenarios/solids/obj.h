/* Wavefront .obj files: the faces of solids.
 *
 * The reader takes `v` x y z, without the weight and the colour that may follow, and `f` with three
 * or more corners v, v/vt, v//vn or v/vt/vn. A corner is the number of a vertex from 1 or, if
 * negative, counts back from the last vertex before the face. The reader skips vt, vn, o, g, s,
 * usemtl, mtllib and the like, and also points and lines (p, l), which bound no solid. It refuses
 * curves, curved surfaces and every word that the format does not have. A # begins a comment; a
 * backslash at the end of a line joins the next one.
 *
 * A face of more corners becomes triangles; it must be flat to a thousandth of its size and not
 * cross itself. Where the faces do not close as they are numbered, vertices of one place, the same
 * to the bit, are one: programs write a vertex once for each normal or texture that it has. A face
 * then loses repeated neighbouring corners. */
#ifndef PLUMB_OBJ_H
#define PLUMB_OBJ_H

#include "plumb/scene.h"

#include <stddef.h>

/* The vertices and triangles of a file. Begins as zeros. */
typedef struct pl_obj {
    double (*vertices)[3]; /* (vertex_count), as in the file, from 0 */
    int (*triangles)[3];   /* (triangle_count) */
    int *lines; /* (triangle_count): the line, from 1, where the triangle's face begins */
    int vertex_count;
    int triangle_count;
} pl_obj;

/* Reads the text of an .obj file; `label` stands for the file's name in messages. PL_BAD_INPUT
 * says FILE:LINE: what was expected, what was found; *obj is then empty. The caller frees it.
 * Before the first vertex no word of the text is shown: it may be another's file. */
pl_status pl_obj_read_text(const char *text, size_t length, const char *label, pl_obj *obj,
                           pl_error *error);

/* Frees the arrays and empties *obj. */
void pl_obj_free(pl_obj *obj);

/* Makes the solid within the faces of a Wavefront .obj file below `folder` (file_beneath.h); the
 * caller frees *polyhedron by pl_polyhedron_free. *length is that of the file in bytes.
 * PL_BAD_INPUT says PATH:LINE: what was expected, what was found. */
pl_status pl_polyhedron_of_file(const char *folder, const char *path, pl_polyhedron **polyhedron,
                                size_t *length, pl_error *error);

#endif
