/* What commands that take several scenes and engines parse alike: argp parsers that are children of
 * the command's own, each with a pl_comparison as its input. */
#ifndef PLUMB_COMPARISON_OPTIONS_H
#define PLUMB_COMPARISON_OPTIONS_H

#include "selection.h"

/* What --help says of the options that mean something else in each command. */
typedef struct pl_comparison_help {
    const char *suite, *json, *jobs, *out;
    const char
        *reader; /* which reads the scene anew, so that it is no standard input; NULL: none */
} pl_comparison_help;

/* What was asked for. A command fills in its defaults and its help before it parses. The texts are
 * those of the command line, borrowed. */
typedef struct pl_comparison {
    const pl_comparison_help *help;
    pl_selection selection;
    pl_limits limits;
    pl_texts names, suites, engines;
    const char *json; /* NULL: none */
    const char *out;
    int jobs;
    bool resume;
} pl_comparison;

/* The defaults of pl_selection and pl_limits, and one job. */
pl_comparison pl_comparison_default(const pl_comparison_help *help);

/* Frees what parsing allocated. */
void pl_comparison_free(pl_comparison *comparison);

/* Scenarios as arguments, --suite, --engine, --json, and pl_run_children. */
extern const struct argp pl_comparison_argp;

/* --jobs */
extern const struct argp pl_comparison_jobs_argp;

/* --out, --resume */
extern const struct argp pl_comparison_out_argp;

/* All three. */
extern const struct argp_child pl_comparison_children[];

/* At ARGP_KEY_INIT of a command whose children are all of those above: gives them their input. */
void pl_comparison_init(pl_comparison *comparison, const struct argp_state *state);

#endif
