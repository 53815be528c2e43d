/* Other forms of the same static boxes: two flush halves, and a closed mesh. The solid that bodies meet stays
 * the same, so that their motion must too. */
#ifndef PLUMB_DIVIDE_H
#define PLUMB_DIVIDE_H

#include "plumb/scene.h"

/* The number of static boxes of a scene. */
int pl_static_box_count(const pl_scene *scene);

/* The scene with each static box split in two flush boxes of half the size along its own axis 0, 1 or 2
 * (x, y, z). The second halves follow all other bodies. Without the original's expectations. The caller
 * frees *to, which is left empty on failure. PL_BAD_INPUT when there are too many bodies, or
 * their names are taken. */
pl_status pl_split_boxes(const pl_scene *from, int axis, pl_scene *to, pl_error *error);

/* The scene with a closed mesh in the place of each static box, whose faces are divided into n x n
 * rectangles of two triangles. Otherwise as pl_split_boxes; PL_BAD_INPUT when there are too many
 * triangles. */
pl_status pl_tessellate_boxes(const pl_scene *from, int n, pl_scene *to, pl_error *error);

#endif
