/* The points of a search that were tried, each once, and the budget; for the stages of pl_seek. */
#ifndef PLUMB_TUNE_LEDGER_H
#define PLUMB_TUNE_LEDGER_H

#include "search_driver.h"

typedef struct pl_ledger {
    const pl_seek_def *def;
    pl_seek_found *found;
    int limit;        /* points up to which the stage may go */
    pl_status status; /* of the first call that failed */
    pl_error *error;
} pl_ledger;

typedef struct pl_seek_units {
    double u[PL_TUNE_MOST_AXES]; /* 0 .. 1 */
} pl_seek_units;

/* No further point may be tried: the limit is reached, or the search stopped or failed. */
bool pl_ledger_is_over(const pl_ledger *ledger);

/* Where a trial's values are. */
pl_seek_units pl_ledger_units(const pl_ledger *ledger, const pl_seek_trial *trial);

/* Tries a point unless it was tried; its place in found->trials, or -1 where it could not be. */
int pl_ledger_try(pl_ledger *ledger, const pl_seek_units *point);

/* The stages. */
void pl_seek_sweep(pl_ledger *ledger);
void pl_seek_model(pl_ledger *ledger);
void pl_seek_polish(pl_ledger *ledger);

#endif
