/* A tuning in progress, or one that is concluded from its results: both read what the runs of the study say, and only
 * the first makes those that are missing. */
#ifndef PLUMB_TUNER_H
#define PLUMB_TUNER_H

#include "studies/variant.h"
#include "tune.h"

enum {
    PL_TUNER_REPEATS = 4, /* of a trial that meets the targets: the first does not count */
    PL_TUNE_REPEATS = 5   /* of the finalists */
};

/* Settings of the engine, in one phase of the study: they run on all cases. */
typedef struct pl_subject {
    const char *phase; /* "search", "final" or "sensitivity": each makes its own runs */
    int trial;         /* of the search, from 0, that they are of or near to; -1: none */
    const json_t
        *values; /* of the tuned parameters, dt in s; NULL: the default settings. Borrowed */
    const pl_variant *variant; /* of the scenarios; NULL: as asked for */
} pl_subject;

/* The default settings in the search, which are no trial. */
extern const pl_subject pl_tuner_defaults;

/* What is known of the runs so far, and what follows from it. */
typedef struct pl_tuner {
    const pl_tune_def *def;      /* NULL: a conclusion, which makes no runs */
    const pl_execution_def *how; /* of a tuning in progress: all but the plan, with progress */
    pl_progress bar;
    pl_status status;    /* of the first call that failed; its error is in *error */
    pl_error *error;     /* borrowed; NULL: nobody asks */
    int signal_number;   /* that ended the runs; 0: none */
    double best_seconds; /* CPU time of the steps in the first runs of the best evaluation */

    json_t *study;  /* what all runs have in their `study` */
    json_t *rows;   /* the results, by what they are runs of */
    json_t *points; /* (trials): the values of each; null: no row has them */
    pl_targets targets;
    int case_count;

    pl_search_result found; /* the evaluations of the trials */
    bool by_instructions;   /* the search measures cost in instructions; else in CPU time */
    bool default_has_cost;  /* else costs are not ratios but s per simulated second */

    pl_evaluation best; /* the answer; its excess also of the runs that it was chosen by */
    double cost;        /* ratio of CPU time to the default settings', geometric mean */
    bool met,
        has_margin;  /* whether it meets the targets, and with two standard deviations to spare */
    json_t *checks;  /* of the answer on scenarios that were held out */
    int missed;      /* of them */
    int passed_over; /* finalists before the answer that missed a target in validation */
} pl_tuner;

/* A tuner of `study` without rows. */
pl_tuner pl_tuner_begin(json_t *study, pl_error *error);

/* Whether no call failed, and no signal ended the runs. */
bool pl_tuner_goes_on(const pl_tuner *tuner);

/* The name of a scenario as asked for. */
const char *pl_tuner_scenario(const pl_tuner *tuner, int test_case);

/* Frees what it owns. */
void pl_tuner_free(pl_tuner *tuner);

/* What all runs of a tuning have in their `study`: "name", "engine", "dt", "scenarios", "scenes", "seed", "targets",
 * "parameters" and "budget". A new reference. */
json_t *pl_tuner_study(const pl_tune_def *def);

/* Whether the `study` of a run is of that tuning, whatever its scenes were when it was made. */
bool pl_tuner_is_of(const json_t *study, const json_t *run);

/* ---- Runs ---- */

/* Takes a result of the study: what it says is known from then on. */
void pl_tuner_take(pl_tuner *tuner, json_t *result);

/* Makes those runs that are missing of `count` subjects of one phase and variant on all cases, in turns within each
 * repeat; a conclusion makes none, and a tuning that does not go on neither. Runs that take much longer than those of the
 * best evaluation are cut short. Returns whether the tuning goes on. */
bool pl_tuner_measure(pl_tuner *tuner, const pl_subject *subjects, int count, int repeats);

/* The result of a subject on a case. NULL: there is none, because the run was not made yet, the scenario cannot be built
 * so, or the variant changes nothing. Borrowed. */
const json_t *pl_tuner_row(const pl_tuner *tuner, const pl_subject *subject, int test_case,
                           int repeat);

/* The subject of a trial, on the scenarios as asked for. */
pl_subject pl_tuner_trial(const pl_tuner *tuner, const char *phase, int trial);

/* ---- Costs and excesses ---- */

/* The median over the repeats from `first` to below `end`, of which there are at most PL_TUNE_REPEATS, of a metric per
 * simulated second over that of `other` in the same repeat; with `other` NULL, of the metric alone. NAN: none. */
double pl_tuner_ratio(const pl_tuner *tuner, pl_metric_id metric, const pl_subject *mine,
                      const pl_subject *other, int test_case, int first, int end);

/* The geometric mean of that over the scenarios; INFINITY where there is none. */
double pl_tuner_cost(const pl_tuner *tuner, pl_metric_id metric, const pl_subject *mine,
                     const pl_subject *other, int first, int end);

/* The repeats of the runs near the answer. */
int pl_tuner_sensitivity_repeats(const pl_tuner *tuner);

/* The largest excess over the scenarios, in the first repeat; PL_SEARCH_WORST where a result is missing. */
double pl_tuner_excess(const pl_tuner *tuner, const pl_subject *subject);

/* A bound that one more run is unlikely to exceed: the mean and two standard deviations of the excesses,
 * ln(value / bound). Runs that meet the target by more than a factor of 20 count as 20, so that chance among them has no
 * effect. */
double pl_likely_excess(const double *excesses, int count);

/* ---- Evaluations ---- */

/* Measures the default settings once. PL_UNSUPPORTED: the engine does not support a scenario. */
void pl_evaluate_defaults(pl_tuner *tuner);

/* Sets cost, excess and holds of the trial evaluation->trial, whose values the tuner has. */
void pl_evaluation_make(pl_tuner *tuner, pl_evaluation *evaluation);

/* Chooses the answer among the evaluations: measures the best again, and validates them. */
void pl_tuner_choose(pl_tuner *tuner);

/* ---- What is said of it ---- */

/* pl_study.conclude: plumb.tuning/1. */
pl_status pl_tune_conclude(const json_t *results, const char *folder, json_t **conclusion,
                           pl_error *error);

/* pl_study.document */
void pl_tune_fill_document(const json_t *conclusion, pl_document *document);

#endif
