/* The search for the cheapest point that meets a target: points of a mixed space of whole and
 * continuous axes. What a cost and an excess are is the caller's. */
#ifndef PLUMB_TUNE_SEEK_H
#define PLUMB_TUNE_SEEK_H

#include "tune_parameter.h"

/* The largest excess there is. */
#define PL_SEEK_WORST 30.0

typedef struct pl_seek_trial {
    double values[PL_TUNE_MOST_AXES]; /* (axis_count) */
    double cost;                      /* > 0; INFINITY: it has none */
    double excess;                    /* <= 0: the target is met; at most PL_SEEK_WORST */
    bool holds;                       /* met where it was tried, if with too little to spare */
} pl_seek_trial;

typedef struct pl_seek_def {
    const pl_tune_axis *axes; /* (axis_count) */
    int axis_count;           /* 0 .. PL_TUNE_MOST_AXES */
    int budget;               /* >= 1: points tried, at most */
    uint64_t seed;
    void *user;
    /* Fills the trial's cost and excess; no point is given twice. *stop ends the search with what
     * there is, without this one; anything but PL_OK ends it with that. */
    pl_status (*measure)(void *user, pl_seek_trial *trial, bool *stop, pl_error *error);
} pl_seek_def;

typedef struct pl_seek_found {
    pl_seek_trial *trials; /* (count) in the order tried, the first at the axes' starts; owned */
    int count;
    int best; /* the cheapest that meets the target, or else that of the least excess; -1: none */
    bool met;
    bool stopped;
    int swept, modelled, polished; /* points of each stage */
} pl_seek_found;

/* Whether the library that does the middle stage, NLopt, is in this build. Without it, that stage
 * is left out. */
bool pl_seek_has_nlopt(void);

/* Low-discrepancy points over the space, in half of which an axis that spends no time stays at its
 * start, then NLopt from the best of them, then steps along each
 * axis and in seeded directions around the best. The same seed and answers give the same points.
 * The caller frees found->trials in any case. PL_NO_MEMORY, and what `measure` returned. */
pl_status pl_seek(const pl_seek_def *def, pl_seek_found *found, pl_error *error);

/* Whether a is better than b: it meets the target and b does not, or both do and it is cheaper, or
 * neither does and it holds alone, or exceeds the target by less. */
bool pl_seek_better(const pl_seek_trial *a, const pl_seek_trial *b);

#endif
