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

/* ---- What is measured ---- */

/* Settings of the engine. */
typedef struct pl_subject {
    int trial; /* of the search, from 0, that they are of or near to; -1: none */
    const json_t
        *values; /* of the tuned parameters, dt in s; NULL: the default settings. Borrowed */
} pl_subject;

/* Runs of subjects on all cases. */
typedef struct pl_tuner_runs {
    const char *phase;          /* "search", "final" or "sensitivity": each makes its own runs */
    const pl_subject *subjects; /* (count): in turns within each repeat */
    int count;
    const pl_variant *variant; /* of the scenarios; NULL: as asked for */
    int repeats;               /* 0: one */
} pl_tuner_runs;

/* The measurements of one subject on one case. */
typedef struct pl_reading {
    bool is_there;  /* false: the scenario cannot be built so, or the variant changes nothing */
    bool is_absent; /* the engine does not support the scenario */
    pl_target_reading target;
    char outcome[32];
    double duration; /* s, simulated */
    /* Per simulated second, one number per repeat; NAN: missing. Borrowed from the readings. */
    double *seconds, *instructions;
} pl_reading;

/* The readings of several subjects, each on all cases, subject by subject. */
typedef struct pl_readings {
    int subject_count, case_count, repeats;
    pl_reading *items; /* (subject_count x case_count) */
    double *numbers;   /* the block that holds the items' arrays */
} pl_readings;

/* The readings of a subject, one per case. */
const pl_reading *pl_readings_of(const pl_readings *readings, int subject);

/* Frees the readings and their numbers. */
void pl_readings_free(pl_readings *readings);

/* ---- The state ---- */

/* The excesses of one scenario, as asked for and changed. */
typedef struct pl_spread {
    int count;
    double sum, squares;
} pl_spread;

/* What is known of the runs so far, and what follows from it. */
typedef struct pl_tuner {
    const pl_tune_def *def;      /* NULL: a conclusion, which makes no runs */
    const pl_execution_def *how; /* of a tuning in progress: everything but the plan */
    pl_progress bar;
    int signal_number;   /* that ended the runs; 0: none */
    double best_seconds; /* CPU time of the steps in the first runs of the best evaluation */

    json_t *study;  /* what all runs have in their `study` */
    json_t *rows;   /* the results, by what they are runs of */
    json_t *points; /* (trials): the values of each; null: no row has them */
    json_t *moved;  /* the values of the phase "sensitivity" */
    pl_targets targets;
    int case_count;

    pl_search_result found;       /* the evaluations of the trials */
    bool by_instructions;         /* the search measures cost in instructions; else in CPU time */
    bool default_has_cost;        /* else costs are not ratios but s per simulated second */
    double *default_instructions; /* (case_count): per simulated second; NAN: not counted */
    pl_spread *spreads;           /* (case_count): of the evaluation in progress */

    pl_evaluation best; /* the answer; its excess also of the runs that it was chosen by */
    double cost;        /* ratio of CPU time to the default settings', geometric mean */
    bool met,
        has_margin;    /* whether it meets the targets, and with two standard deviations to spare */
    pl_readings final; /* the default settings, then the finalists */
    int place;         /* of the answer among them */
    json_t *checks;    /* of the answer on scenarios that were held out */
    int missed;        /* of them */
    int passed_over;   /* finalists before the answer that missed a target in validation */
} pl_tuner;

/* A tuner of `study` without rows. */
pl_tuner pl_tuner_begin(json_t *study, pl_error *error);

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

/* Reads the runs. A tuning in progress first makes those that are missing. Runs that take much longer than
 * those of the best evaluation are cut short. The caller frees *readings in any case. */
pl_status pl_tuner_measure(pl_tuner *tuner, pl_tuner_runs runs, pl_readings *readings,
                           pl_error *error);

/* A result of the subject on a case as asked for, the first repeat; NULL: there is none. Borrowed. */
const json_t *pl_tuner_row(const pl_tuner *tuner, const char *phase, pl_subject subject,
                           int test_case);

/* ---- Costs and excesses from readings ---- */

/* The median over the repeats from `first` to below `repeats` of the CPU time over that of `other`
 * in the same repeat; with `other` NULL, of the CPU time, in s per simulated second. NAN: none. */
double pl_score_ratio(const pl_reading *reading, const pl_reading *other, int first, int repeats);

/* Adds one excess, ln(value / bound). An excess below ln(1 / 20) counts as ln(1 / 20). */
void pl_spread_add(pl_spread *spread, double excess);

/* A bound that one more run is unlikely to exceed: the mean and two standard deviations. Runs that
 * meet the target by more than a factor of 20 count as 20, so that chance among them has no
 * effect. */
double pl_spread_likely(const pl_spread *spread);

/* The geometric mean over the scenarios of the CPU time over that of the default settings, repeat
 * by repeat from `first` to below `repeats`; INFINITY where there is none. */
double pl_tuner_cost(const pl_tuner *tuner, const pl_reading *mine, const pl_reading *defaults,
                     int first, int repeats);

/* The largest excess over the scenarios. */
double pl_tuner_excess(const pl_tuner *tuner, const pl_reading *readings);

/* ---- Evaluations ---- */

/* The subject of a trial. */
pl_subject pl_tuner_trial(const pl_tuner *tuner, int trial);

/* Measures the default settings once. PL_UNSUPPORTED: the engine does not support a scenario. */
pl_status pl_evaluate_defaults(pl_tuner *tuner, pl_error *error);

/* Sets `excess` and `holds` from the readings `asked` of the scenarios as asked for, and from runs
 * of the scenarios as the variants change them, up to the first that misses a target. */
pl_status pl_evaluation_judge(pl_tuner *tuner, const pl_reading *asked, pl_variants variants,
                              pl_evaluation *evaluation, pl_error *error);

/* Sets cost, excess and holds of the trial evaluation->trial, whose values the tuner has. */
pl_status pl_evaluation_make(pl_tuner *tuner, pl_evaluation *evaluation, pl_error *error);

/* ---- The choice ---- */

/* Chooses the answer among the evaluations: measures the best again, and validates them. */
pl_status pl_tuner_choose(pl_tuner *tuner, pl_error *error);

/* ---- What is said of it ---- */

/* pl_study.conclude: plumb.tuning/1. */
pl_status pl_tune_conclude(const json_t *results, const char *folder, json_t **conclusion,
                           pl_error *error);

/* pl_study.document */
void pl_tune_fill_document(const json_t *conclusion, pl_document *document);

#endif
