/* Scenarios changed a little: some to tune on beside the scenarios as asked for, others kept back
 * to judge what came of it. */
#ifndef PLUMB_TUNE_VARIANT_H
#define PLUMB_TUNE_VARIANT_H

#include "plumb/scenario.h"

typedef enum pl_variant_kind {
    PL_VARIANT_NONE,
    PL_VARIANT_FRICTION_UP, /* friction by its last bit */
    PL_VARIANT_FRICTION_DOWN,
    PL_VARIANT_LARGER,  /* n one larger */
    PL_VARIANT_SMALLER, /* n one smaller */
    PL_VARIANT_OFFSET,  /* offset = 0.01, with another seed */
    PL_VARIANT_DRAWN    /* continuous parameters within 1 %, drawn */
} pl_variant_kind;

typedef struct pl_variant {
    const char *name;
    pl_variant_kind kind;
    int seed; /* added to the scenarios' own where something is drawn */
} pl_variant;

extern const pl_variant pl_variant_none;

/* Static storage. The three have no run in common. */
const pl_variant *pl_variants_tuned_on(int *count);
const pl_variant *pl_variants_chosen_by(int *count); /* among the search's best */
const pl_variant *pl_variants_held_out(int *count);

/* Changes the values of a scenario's parameters; false when the scenario has none that this variant
 * changes. */
bool pl_variant_apply(const pl_variant *variant, const pl_scenario *scenario, uint64_t seed,
                      double *values);

#endif
