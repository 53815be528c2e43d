#include "evaluation_cache.h"

#include <math.h>
#include <string.h>

bool pl_ledger_is_over(const pl_ledger *ledger)
{
    return ledger->status != PL_OK || ledger->found->stopped ||
           ledger->found->count >= ledger->limit;
}

pl_seek_units pl_ledger_units(const pl_ledger *ledger, const pl_seek_trial *trial)
{
    pl_seek_units at = {.u = {0}};
    for (int i = 0; i < ledger->def->axis_count; ++i) {
        at.u[i] = pl_tune_unit(&ledger->def->axes[i], trial->values[i]);
    }
    return at;
}

/* The place of a point among the trials; -1: it is new. */
static int place_of(const pl_seek_found *found, const pl_seek_trial *trial, int axes)
{
    for (int i = 0; i < found->count; ++i) {
        bool same = true;
        for (int k = 0; k < axes && same; ++k) {
            same = found->trials[i].values[k] == trial->values[k];
        }
        if (same) {
            return i;
        }
    }
    return -1;
}

bool pl_seek_better(const pl_seek_trial *a, const pl_seek_trial *b)
{
    const bool a_meets = a->excess <= 0, b_meets = b->excess <= 0;
    if (a_meets != b_meets) {
        return a_meets;
    }
    if (!a_meets && a->holds != b->holds) {
        return a->holds;
    }
    if (!a_meets && a->excess != b->excess) {
        return a->excess < b->excess;
    }
    return a->cost < b->cost;
}

int pl_ledger_try(pl_ledger *ledger, const pl_seek_units *point)
{
    const pl_seek_def *def = ledger->def;
    pl_seek_found *found = ledger->found;
    pl_seek_trial trial = {.cost = (double)INFINITY, .excess = PL_SEEK_WORST};
    for (int k = 0; k < def->axis_count; ++k) {
        trial.values[k] = pl_tune_value(&def->axes[k], point->u[k]);
    }
    const int place = place_of(found, &trial, def->axis_count);
    if (place >= 0 || pl_ledger_is_over(ledger)) {
        return place;
    }
    ledger->status = def->measure(def->user, &trial, &found->stopped, ledger->error);
    if (ledger->status != PL_OK || found->stopped) {
        return -1;
    }
    found->trials[found->count] = trial;
    if (found->best < 0 || pl_seek_better(&trial, &found->trials[found->best])) {
        found->best = found->count;
        found->met = trial.excess <= 0;
    }
    return found->count++;
}
