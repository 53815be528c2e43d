/* Whether bodies that should rest still stand on what they stood on, and how they have moved. */
#ifndef PLUMB_STANDING_H
#define PLUMB_STANDING_H

#include "metrics.h"
#include "referee/geometry/candidate_pairs.h"

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
