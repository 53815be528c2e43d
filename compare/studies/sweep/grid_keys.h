/* Assigns the keys of a sweep to its cases and engines. */
#ifndef PLUMB_SWEEP_GRID_KEYS_H
#define PLUMB_SWEEP_GRID_KEYS_H

#include "grid.h"

enum { PL_GRID_MOST_KEYS = PL_MAX_PARAMS + PL_ENGINE_MAX_OPTIONS + 1 };

/* The keys that apply to a case or a configuration, in the order given. */
typedef struct pl_grid_keys {
    int items[PL_GRID_MOST_KEYS];  /* (count) into pl_grid_def.varied */
    int values[PL_GRID_MOST_KEYS]; /* (count) numbers of values; of profiles, those that exist */
    int count;
} pl_grid_keys;

/* PL_BAD_INPUT: a key that nothing of the base has, that is given twice, or that is ambiguous. A
 * key of an engine that this build lacks is ignored. */
pl_status pl_grid_keys_check(const pl_grid_def *def, pl_error *error);

/* The keys of one case of the base, after the check. */
pl_grid_keys pl_grid_keys_of_case(const pl_grid_def *def, const pl_case *test_case);

/* The keys of one engine configuration of the base, after the check. */
pl_grid_keys pl_grid_keys_of_configuration(const pl_grid_def *def,
                                           const pl_configuration *configuration);

/* The number of combinations of the keys' values. It is a double, because it may be huge before it
 * is refused. */
double pl_grid_combinations(const pl_grid_keys *keys);

/* The index of the value of key number `key` in a combination; the last key varies fastest. */
int pl_grid_digit(const pl_grid_keys *keys, long combination, int key);

#endif
