/* A start that lies a fraction of a step later on the same motion. The later run makes its steps at other
 * times, and must follow the same path. */
#ifndef PLUMB_LATE_START_H
#define PLUMB_LATE_START_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* Whether the motion of every dynamic body is known over the first `fraction` (0 to 1) of a step. It is for
 * bodies
 *
 *   in free flight: they reach no other body in that time, and do not spin or keep their spin (it is
 *     along a principal axis, or the principal moments are equal);
 *   at rest: they do not move, and the scene expects that they stay;
 *   in uniform motion on static bodies whose flat, level tops are at one height: they slide without
 *     friction and without spin, or are spheres that roll.
 *
 * A scene with forces has none. False with the reason, in static storage. */
bool pl_late_start_is_known(const pl_scene *scene, double fraction, const char **reason);

/* The scene that starts `fraction` of a step later and ends at a whole step before its end. Without the
 * original's expectations. The motion must be known. The caller frees *to, which is left empty on failure. */
pl_status pl_late_start_scene(const pl_scene *from, double fraction, pl_scene *to, pl_error *error);

/* The state of a body `fraction` of a step of dt (s) after `now`, with the mean accelerations of the step to
 * `next`: exact under constant forces. */
void pl_state_between(const pl_body *body, const pl_body_state *now, const pl_body_state *next,
                      double dt, double fraction, pl_body_state *at);

#endif
