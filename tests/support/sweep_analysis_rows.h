/* Results of a sweep made by hand, whose answers are known. */
#ifndef PLUMB_TEST_SWEEP_ANALYSIS_ROWS_H
#define PLUMB_TEST_SWEEP_ANALYSIS_ROWS_H

#include "studies/sweep/analysis.h"

/* A run. What is left out is 0; a dt of 0 is 1/64 s, an outcome of NULL "ok". */
typedef struct sweep_run {
    const char *scenario, *engine; /* "ode:quick" */
    double cost, error;            /* s/s; of the primary error, travel_error. NAN: null */
    double dt;                     /* s; powers of two keep the cost exact */
    int n, iterations, repeat;     /* n: a parameter; iterations: an option */
    const char *outcome;
    const char *change; /* of the scene; NULL: none */
    bool shipped;       /* as shipped; the label then has no option */
} sweep_run;

/* Appends the run; the row is borrowed from `results`. */
json_t *add_sweep_run(json_t *results, sweep_run run);

/* Appends `count` repeats of the run, with these costs. */
void add_repeats(json_t *results, sweep_run run, const double *costs, int count);

/* Ours: 2 s/s at 1e-4. ode: 1 at 1e-2, 8 at 1e-4. */
json_t *crossing_sweep(void);

/* The test fails unless it succeeds. */
pl_sweep_analysis analysis_of(const json_t *results);

/* Its document as text, to free. */
char *document_of(const pl_sweep_analysis *analysis);

/* The losses of its conclusion, to free. */
json_t *losses_of(const pl_sweep_analysis *analysis);

/* Frees both. */
void finish_sweep(pl_sweep_analysis *analysis, json_t *results);

/* Indices; the test fails where there is none. */
int engine_named(const pl_sweep_analysis *analysis, const char *name);
int pair_named(const pl_sweep_analysis *analysis, const char *ours, const char *other);

/* The comparison of plumb against another engine, with all profiles, on the first scene. */
const pl_pairwise_comparison *comparison_with(const pl_sweep_analysis *analysis, const char *other);

#endif
