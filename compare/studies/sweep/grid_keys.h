/* Which keys of a sweep go to which case and which engine. */
#ifndef PLUMB_SWEEP_GRID_KEYS_H
#define PLUMB_SWEEP_GRID_KEYS_H

#include "grid.h"

enum { PL_GRID_MOST_KEYS = PL_MAX_PARAMS + PL_ENGINE_MAX_OPTIONS + 1 };

/* The keys that vary something, in the order given. */
typedef struct pl_grid_keys {
    int items[PL_GRID_MOST_KEYS];  /* (count) into pl_grid_def.varied */
    int values[PL_GRID_MOST_KEYS]; /* (count) how many values: of profiles those that there are */
    int count;
} pl_grid_keys;

/* PL_BAD_INPUT: a key that nothing of the base has, that is there twice, or that could mean two
 * things. A key of an engine that this build lacks is passed over. */
pl_status pl_grid_keys_check(const pl_grid_def *def, pl_error *error);

/* After the check: the keys of one case, or of one configuration, of the base. */
pl_grid_keys pl_grid_keys_of_case(const pl_grid_def *def, const pl_case *test_case);
pl_grid_keys pl_grid_keys_of_configuration(const pl_grid_def *def,
                                           const pl_configuration *configuration);

/* How many combinations of their values there are; a double, because it may be huge before it is
 * refused. */
double pl_grid_combinations(const pl_grid_keys *keys);

/* The place of the value of key number `key` in a combination, from 0; the last key is fastest. */
int pl_grid_digit(const pl_grid_keys *keys, long combination, int key);

/* -1 when there is none of that name. */
int pl_grid_param(const pl_scenario *scenario, const char *name);
int pl_grid_profile(const pl_engine *engine, const char *name);

#endif
