/* A scene that goes on where another's run stood. */
#ifndef PLUMB_RESTART_H
#define PLUMB_RESTART_H

#include "plumb/engine_abi.h"

/* The rest of the scene's run after `step` steps, 0 < step < pl_scene_steps, when its bodies were
 * in these states: times count from there, and forces that have ended are gone, as is what was
 * expected of the scene. The caller frees *to, which is left empty on failure. */
pl_status pl_restart_scene(const pl_scene *from, const pl_body_state *states, long step,
                           pl_scene *to, pl_error *error);

#endif
