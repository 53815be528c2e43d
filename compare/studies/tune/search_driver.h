/* The search for the cheapest point that meets a target: points of a mixed space of whole and
 * continuous parameters. What a cost and an excess are is the caller's. */
#ifndef PLUMB_TUNE_SEEK_H
#define PLUMB_TUNE_SEEK_H

#include "tune_parameter.h"

/* The largest excess there is. */
#define PL_SEARCH_WORST 30.0

typedef struct pl_evaluation {
    double values[PL_TUNE_MAX_PARAMETERS]; /* (parameter_count) */
    double cost;                           /* > 0; INFINITY: it has none */
    double excess;                         /* <= 0: the target is met; at most PL_SEARCH_WORST */
    bool holds;                            /* met where it was tried, if with too little to spare */
} pl_evaluation;

typedef struct pl_search_def {
    const pl_tune_parameter *parameters; /* (parameter_count) */
    int parameter_count;                 /* 0 .. PL_TUNE_MAX_PARAMETERS */
    int budget;                          /* >= 1: points tried, at most */
    uint64_t seed;
    void *user;
    /* Fills the trial's cost and excess; no point is given twice. *stop ends the search with what
     * there is, without this one; anything but PL_OK ends it with that. */
    pl_status (*measure)(void *user, pl_evaluation *evaluation, bool *stop, pl_error *error);
} pl_search_def;

typedef struct pl_search_result {
    pl_evaluation
        *evaluations; /* (count) in the order tried, the first at the parameters' starts; owned */
    int count;
    int best; /* the cheapest that meets the target, or else that of the least excess; -1: none */
    bool met;
    bool stopped;
    int sampled, optimised, refined; /* points of each stage */
} pl_search_result;

/* Whether the library that does the middle stage, NLopt, is in this build. Without it, that stage
 * is left out. */
bool pl_search_has_nlopt(void);

/* Low-discrepancy points over the space, in half of which a parameter that spends no time stays at
 * its start, then NLopt from the best of them, then steps along each parameter and in seeded
 * directions around the best. The same seed and answers give the same points. The caller frees
 * found->evaluations in any case. PL_NO_MEMORY, and what `measure` returned. */
pl_status pl_search(const pl_search_def *def, pl_search_result *found, pl_error *error);

/* Whether a is better than b: it meets the target and b does not, or both do and it is cheaper, or
 * neither does and it holds alone, or exceeds the target by less. */
bool pl_evaluation_is_better(const pl_evaluation *a, const pl_evaluation *b);

#endif
