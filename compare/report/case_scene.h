/* The scene of a case, built again for the replay, and as JSON. */
#ifndef PLUMB_CASE_SCENE_H
#define PLUMB_CASE_SCENE_H

#include "plumb/scene.h"
#include "queries.h"

/* Builds the scene of a case: from the catalogue, or from the scene file by its path (with the step
 * and the duration of the run). PL_FAILED when its hash is not that of the results, PL_IO when the
 * file is not there. The caller frees *scene, also on failure. */
pl_status pl_case_scene_build(const pl_result_case *test_case, pl_scene *scene, pl_error *error);

/* The scene as the page draws it: bodies, shapes and expected rests, a new reference. page/README.md
 * has its keys. */
json_t *pl_case_scene_json(const pl_scene *scene);

/* A number to six digits, which place a body to a millionth of the scene; null for one that is not
 * finite. A new reference. */
json_t *pl_rounded_json(double value);

#endif
