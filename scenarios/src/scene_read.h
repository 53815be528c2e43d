/* JSON to scene: the structure of the format. */
#ifndef PLUMB_SCENE_READ_H
#define PLUMB_SCENE_READ_H

#include "complaint.h"
#include "plumb/scene.h"

#include <jansson.h>

/* Fills `scene`, an empty default one, and checks it by pl_scene_check. False with a complaint,
 * whose path borrows from `json` and `scene`, when anything is wrong; the scene is then partly
 * filled. */
bool pl_scene_from_json(const json_t *json, pl_scene *scene, pl_complaint *complaint);

#endif
