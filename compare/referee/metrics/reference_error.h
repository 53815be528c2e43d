/* Errors against what the scene expects: rests, travels and values. Each is measured against the
 * reference of the continuous problem, and travels and values also against the discrete reference,
 * which is the exact result of the engine's own integrator at the scene's step. An error against
 * the discrete reference is free of the time-stepping error, and shows that of contacts and
 * friction. */
#ifndef PLUMB_REFERENCE_ERROR_H
#define PLUMB_REFERENCE_ERROR_H

#include "mechanics.h"

/* The values that the scene expects, as the frames show them. */
typedef struct pl_values pl_values;

/* `scene` and `votes`, which have what the engine declares, must outlive it. Memory of the arena. */
pl_values *pl_values_create(const pl_scene *scene, const pl_integrator_votes *votes,
                            pl_arena *arena);

/* Takes the state after step number `step`, from 0 (before the first step) on. */
void pl_values_see(pl_values *values, long step, const pl_body_state *bodies);

/* Sets rest_position_error, rest_rotation_error, travel_error, value_error, discrete_error,
 * integrator and state_hash in item (PL_METRIC_COUNT) from the last state, (body_count). A metric
 * is PL_METRIC_ABSENT if the scene expects nothing of its kind. value_error is PL_METRIC_FAILED if
 * no whole period was seen in less time than two, discrete_error where the answer of the engine's
 * integrator is not known. */
void pl_reference_metrics(const pl_values *values, const pl_body_state *last, pl_metric *item);

/* The value number `index` that the frames show, in its unit. A value that pl_values_lack is 0. NAN: the run
 * is too short to show a period. */
double pl_values_found(const pl_values *values, int index);

/* Whether the frames show no n-th apex, or no whole period in twice its time, where a right engine has one. */
bool pl_values_lack(const pl_values *values, int index);

/* How far the body is from where a displacement of `distance` along its travel, from the scene's
 * position, takes it, m. */
double pl_off_travel(const pl_scene *scene, const pl_body_state *bodies,
                     const pl_expect_travel *travel, double distance);

/* Index into scene->rests of the body that is farthest from its rest, and its distance, m; -1 if no
 * body is expected to rest. */
int pl_farthest_from_rest(const pl_scene *scene, const pl_body_state *bodies, double *distance);

#endif
