/* What a run shows of all that its scene expects: errors, and the verdict's data.
 *
 * Errors are of rests, travels and values. Each is measured against the reference of the continuous
 * problem, and travels and values also against the discrete reference, which is the exact result of
 * the engine's own integrator at the scene's step. An error against the discrete reference is free
 * of the time-stepping error, and shows that of contacts and friction.
 *
 * The tolerance of an expectation is its own, in its own unit. Without one it follows from the scene's
 * acceptance: that many metres of a rest, and radians of its orientation; that fraction of a travel's
 * distance; that many scales of a value or a statistic. Without either the expectation is not judged. */
#ifndef PLUMB_EXPECTATIONS_H
#define PLUMB_EXPECTATIONS_H

#include "mechanics.h"
#include "referee/geometry/candidate_pairs.h"

/* ---- Errors (reference_error.c) ---- */

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

/* ---- Chaotic motion ---- */

/* Sets statistics_error in item (PL_METRIC_COUNT), which has the run's other metrics, if the scene
 * expects statistics, and chaotic_error if that is the scene's primary error. A metric without any
 * part that has a value is PL_METRIC_FAILED. */
void pl_chaotic_metrics(const pl_scene *scene, pl_metric *item);

/* ---- The verdict ---- */

/* Judges the last state, (body_count), and what the frames have shown. `metrics` has the others, no
 * deviations, and gets expectation_error. A period that the run was too short to show is left out. */
void pl_expectations_judge(const pl_scene *scene, const pl_values *values,
                           const pl_body_state *last, pl_metrics *metrics);

/* How a second run differs from the first. */
typedef struct pl_difference {
    long steps; /* how many of its steps end in another state */
    long first; /* of those, from 1; 0: none */
} pl_difference;

/* Judges the bits of the states of a second run, as one more expectation; after pl_expectations_judge. */
void pl_expectations_judge_bits(const pl_difference *difference, pl_metrics *metrics);

/* ---- Whether what should rest still stands (standing.c) ---- */

/* Judges the last frame of a run, `last`, (scene->body_count). `pairs` are those of the scene.
 *
 * PL_ENDING_COLLAPSED, with the reason in `error`: a body ended farther than
 * scene->collapse_distance from its rest, and it is still falling, or two bodies that should touch
 * have moved that far against each other. PL_ENDING_OK otherwise. *note then says how the body
 * that is farthest from its rest has moved, where a user would see it: beyond the scene's acceptance
 * or its collapse_distance; else it is empty. */
pl_ending pl_standing_judge(const pl_scene *scene, pl_candidate_pairs *pairs,
                            const pl_body_state *last, pl_note *note, pl_error *error);

#endif
