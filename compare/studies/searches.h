/* Searches for numbers by trials, each an isolated run. All searches run side by side, one trial of each in a round. */
#ifndef PLUMB_SEARCHES_H
#define PLUMB_SEARCHES_H

#include "runner/execute.h"

/* The search of one case on one configuration, for a value of a parameter of the scenario or of an option of the engine. */
typedef struct pl_search {
    int test_case, configuration; /* indices in the plan */
    int param;                    /* index in the scenario's; -1: it is for an option */
    int option;                   /* index in the engine's; -1: it is for a parameter */
    json_t *study;                /* that the trials belong to; borrowed */
    int most, trials;             /* trials that it can take, and those that it took */
    bool is_over;
    char run[17]; /* hash of the trial in progress; empty: none */
} pl_search;

/* Searches that run side by side. */
typedef struct pl_searches {
    const pl_execution_def *how; /* with the plan of the cases and the configurations */
    pl_progress *bar;            /* has all `most` in its total; NULL: no progress is shown */
    pl_search *items;            /* (count) */
    int count;
    void *user;
    /* The value of the next trial of a search, by its index. */
    double (*next)(void *user, int search);
    /* Takes the result of that trial; whether the search is over. */
    bool (*take)(void *user, int search, const json_t *result);
} pl_searches;

/* Runs all searches to their ends. A signal ends them as in pl_execute. PL_FAILED: two values of a parameter give one
 * scene. */
pl_status pl_searches_run(pl_searches *searches, int *signal_number, pl_error *error);

#endif
