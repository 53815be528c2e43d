/* Whether a step repeats the last one: nothing moves, and the same contacts bear the same impulses.
 * The referee need not measure such a step: its numbers are those of the last one. */
#ifndef PLUMB_REPEATS_H
#define PLUMB_REPEATS_H

#include "mechanics.h"

/* A copy of the last step. */
typedef struct pl_repeated_steps pl_repeated_steps;

/* `scene` and `arena` must outlive it. Memory of the arena. */
pl_repeated_steps *pl_repeated_steps_create(const pl_scene *scene, pl_arena *arena);

/* Takes a step, whose contacts may be unreported. Returns whether its states, contacts and times are
 * those of the step taken before it. */
bool pl_repeated_steps_see(pl_repeated_steps *repeats, const pl_step *step);

#endif
