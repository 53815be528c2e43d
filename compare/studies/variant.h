/* Small changes of scenarios. The search of plumb tune is judged on some of them next to the
 * scenarios as asked for; others are held out to validate its result. plumb sweep runs each of its
 * points on some. */
#ifndef PLUMB_VARIANT_H
#define PLUMB_VARIANT_H

#include "plumb/scenario.h"

/* What a variant changes. */
typedef enum pl_variant_kind {
    PL_VARIANT_NONE,
    PL_VARIANT_FRICTION_UP, /* friction moved by its last bit */
    PL_VARIANT_FRICTION_DOWN,
    PL_VARIANT_LARGER,  /* n one larger */
    PL_VARIANT_SMALLER, /* n one smaller */
    PL_VARIANT_OFFSET,  /* offset = 0.01, with another seed */
    /* Continuous parameters drawn within 1 %, where the scenario has no critical value. */
    PL_VARIANT_DRAWN
} pl_variant_kind;

/* A small change of all scenes that a study uses. */
typedef struct pl_variant {
    const char *name;
    pl_variant_kind kind;
    int seed; /* added to the scenarios' own where something is drawn */
} pl_variant;

extern const pl_variant pl_variant_none;

/* A list of variants. */
typedef struct pl_variants {
    const pl_variant *items; /* (count) */
    int count;
} pl_variants;

/* Three lists that have no run in common: those that the search uses, those that choose among its
 * best points, and those that validate the choice. */
extern const pl_variants pl_variants_tuned_on, pl_variants_chosen_by, pl_variants_held_out;

/* The changes of a sweep, of which a scene takes the first that it has a parameter for: all keep its
 * seed. */
extern const pl_variants pl_variants_swept;

/* Changes the values of a scenario's parameters. False when the scenario has no parameter that this
 * variant changes. */
bool pl_variant_apply(const pl_variant *variant, const pl_scenario *scenario, uint64_t seed,
                      double *values);

#endif
