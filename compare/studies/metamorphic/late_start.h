/* A start that lies a fraction of a step later on the same motion. The later run makes its steps at other
 * times, and must follow the same path. */
#ifndef PLUMB_LATE_START_H
#define PLUMB_LATE_START_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* The scene that starts `fraction` (0 to 1) of a step later and ends at a whole step before its end, without the
 * original's expectations, if the motion of every dynamic body is known over that time. It is for bodies
 *
 *   in free flight: they reach no other body in that time, and do not spin or keep their spin (it is
 *     along a principal axis, or the principal moments are equal);
 *   at rest: they do not move, and the scene expects that they stay;
 *   in uniform motion on static bodies whose flat, level tops are at one height: they slide without
 *     friction and without spin, or are spheres that roll.
 *
 * A scene with forces has none. Where it is not known, *reason says why, in static storage, and else is NULL. The caller
 * frees *to, which is left empty without such a scene. */
pl_status pl_late_start(const pl_scene *from, double fraction, pl_scene *to, const char **reason,
                        pl_error *error);

/* The state of a body `fraction` of a step of dt (s) after `now`, with the mean accelerations of the step to
 * `next`: exact under constant forces. */
void pl_state_between(const pl_body *body, const pl_body_state *now, const pl_body_state *next,
                      double dt, double fraction, pl_body_state *at);

#endif
