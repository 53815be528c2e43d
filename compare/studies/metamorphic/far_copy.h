/* Where a second copy of a scene has nothing to do with the first. */
#ifndef PLUMB_FAR_COPY_H
#define PLUMB_FAR_COPY_H

#include "plumb/scene.h"

/* The diagonal of the axis-aligned box around the bounding spheres of the dynamic bodies at the
 * start, m; 1 m where there are none. */
double pl_scene_size(const pl_scene *scene);

/* An offset of `sizes` times that, along which every plane of the scene maps to itself, level where
 * there is a choice. False when there is none: the planes stand in all directions. */
bool pl_far_offset(const pl_scene *scene, double sizes, double offset[3]);

#endif
