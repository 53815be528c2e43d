/* The rules that every scene keeps, in one place: pl_scene_validate states them for scenes made by
 * code, the reader for scene files. */
#ifndef PLUMB_SCENE_CHECK_H
#define PLUMB_SCENE_CHECK_H

#include "base/diagnostic.h"
#include "plumb/scene.h"

/* The metrics that a scene may name as its primary error. */
extern const char *const pl_primary_errors[];
extern const int pl_primary_error_count;

/* False with a diagnostic about the first rule that is broken; its path follows the scene file,
 * where forces stand inside their body. `diagnostic` must be zeroed; its path borrows from the
 * scene. */
bool pl_scene_check(const pl_scene *scene, pl_diagnostic *diagnostic);

#endif
