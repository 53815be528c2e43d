/* Motion that nothing explains: how much farther a body moved in a step than the speeds of its
 * island, gravity, the scene's forces and the overlaps of its island allow; and by how much the
 * velocity of a body in free flight changed otherwise than by gravity. */
#ifndef PLUMB_UNEXPLAINED_MOTION_H
#define PLUMB_UNEXPLAINED_MOTION_H

#include "base/arena.h"
#include "plumb/engine_abi.h"
#include "plumb/scene.h"
#include "touching.h"

/* What is fixed for a scene, and memory of a step. */
typedef struct pl_unexplained_motion pl_unexplained_motion;

/* `scene` must outlive it. Memory of the arena; NULL when out of memory. */
pl_unexplained_motion *pl_unexplained_motion_create(const pl_scene *scene, pl_arena *arena);

/* Of a step from `before` to `after`, each (scene->body_count), whose frame `touching` has seen: the
 * largest unexplained motion of a dynamic body over its bounding radius; at least 0. */
double pl_unexplained_motion_of(pl_unexplained_motion *motion, pl_touching *touching,
                                const pl_body_state *before, const pl_body_state *after);

/* Of the same step: the largest |v' - v - h g| / (h |g|) of a dynamic body that flew through it and
 * on which the scene has no force. NAN where there is none, or no gravity. */
double pl_free_flight_error_of(const pl_unexplained_motion *motion, const pl_touching *touching,
                               const pl_body_state *before, const pl_body_state *after);

#endif
