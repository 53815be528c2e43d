/* The faces of an .obj file: polygons to triangles. */
#ifndef PLUMB_OBJ_FACES_H
#define PLUMB_OBJ_FACES_H

#include "obj.h"

/* The largest number of corners of a face. */
enum { PL_MAX_POLYGON_CORNERS = 4096 };

/* Face i has the corners corner[first[i] .. first[i + 1]), numbers of vertices from 0, perhaps
 * beyond the last; it begins at line[i]. */
typedef struct pl_obj_faces {
    int *corner; /* (corner_count) */
    int *first;  /* (face_count + 1) */
    int *line;   /* (face_count) */
    int corner_count;
    int face_count;
} pl_obj_faces;

/* Makes obj->triangles and obj->lines, which pl_obj_free frees. PL_BAD_INPUT says LABEL:LINE: what
 * was expected, what was found. */
pl_status pl_obj_cut_faces(const pl_obj_faces *faces, pl_obj *obj, const char *label,
                           pl_error *error);

#endif
