/* The rules that every scene keeps, in one place: pl_scene_validate states them for scenes made by
 * code, the reader for scene files. */
#ifndef PLUMB_SCENE_CHECK_H
#define PLUMB_SCENE_CHECK_H

#include "base/diagnostic.h"
#include "plumb/scene.h"

/* False with a diagnostic about the first rule that is broken; its path follows the scene file,
 * where forces stand inside their body. `diagnostic` must be zeroed; its path borrows from the
 * scene. */
bool pl_scene_check(const pl_scene *scene, pl_diagnostic *diagnostic);

/* Checks the numbers of one shape. Reports errors at the current path. */
bool pl_check_shape(const pl_shape *shape, pl_diagnostic *diagnostic);

#endif
