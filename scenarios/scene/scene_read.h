/* JSON to scene: the structure of the format. */
#ifndef PLUMB_SCENE_READ_H
#define PLUMB_SCENE_READ_H

#include "base/diagnostic.h"
#include "plumb/scene.h"

#include <jansson.h>

/* Fills `scene`, an empty default one, and checks it by pl_scene_check. `folder` is where files
 * that it names are looked for, with a / at its end, or "" for the working directory; NULL: it may
 * name none. False with a diagnostic, whose path borrows from `json` and `scene`, when anything is
 * wrong; the scene is then partly filled. */
bool pl_scene_from_json(const json_t *json, const char *folder, pl_scene *scene,
                        pl_diagnostic *diagnostic);

#endif
