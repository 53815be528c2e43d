/* What a command was asked for: scenes, engines, limits, and where results go. Several commands
 * share these options, of which each includes the tables that it needs. */
#ifndef PLUMB_REQUEST_H
#define PLUMB_REQUEST_H

#include "command.h"
#include "engines/process.h"
#include "runner/plan.h"

/* The first member of the options of every command. The texts are those of the command line. */
typedef struct pl_request {
    pl_texts names;    /* arguments: scenarios and scene files, or what the command takes */
    pl_texts suites;   /* --suite */
    pl_texts engines;  /* --engine */
    pl_texts with;     /* --with NAME[,NAME...]|all */
    pl_texts settings; /* --set NAME=VALUE */
    pl_texts others;   /* settings of the option `others_option`, which come after them; borrowed */
    const char *others_option;
    double dt, duration; /* s; NAN: the scenario's own */
    uint64_t seed;
    pl_limits limits; /* --timeout, --cpu-limit, --memory */
    const char *json; /* --json; NULL: none */
    const char *out;  /* --out */
    const char *home; /* --home; NULL: none */
    int jobs;         /* --jobs */
    bool resume;      /* --resume */
    bool force;       /* --force; not both */
} pl_request;

/* Nothing asked for, the default limits, and one job. */
pl_request pl_request_default(void);

/* Frees what parsing allocated. */
void pl_request_free(pl_request *request);

/* --set, --dt, --duration, --seed */
extern const pl_option pl_scene_options[];
/* --allow-files: of every command that reads scenes */
extern const pl_option pl_file_options[];
/* --timeout, --cpu-limit, --memory, --profiles */
extern const pl_option pl_limit_options[];
/* --suite, --engine, --with, --json */
extern const pl_option pl_comparison_options[];
/* --home: of commands that report */
extern const pl_option pl_home_options[];
/* --jobs */
extern const pl_option pl_jobs_options[];
/* --out, --resume, --force: of a folder of results */
extern const pl_option pl_out_options[];
/* --force alone */
extern const pl_option pl_force_options[];

/* A usage error with the message `which` when neither scenarios nor suites are named (NULL: they
 * need not be), and, unless `reader` is NULL, when a scene is to come from standard input: each
 * `reader` reads its scene, which standard input allows once. */
pl_status pl_request_check(const pl_request *request, const char *which, const char *reader,
                           pl_error *error);

/* Whether --json and the file `other` (each may be NULL or "-") may be written: they do not exist, or
 * --resume or --force was given. PL_BAD_INPUT. */
pl_status pl_request_outputs(const pl_request *request, const char *other, pl_error *error);

/* Opens the results in --out as --resume and --force say; `others` as of pl_store_open. Ends the program where that
 * fails. pl_call_end_store closes them. */
pl_store *pl_request_open_store(const pl_call *call, const pl_request *request,
                                const char *const *others);

/* Adds the cases of all suites, then those of the names. A name with a '/', one that ends in
 * ".json", and "-" are scene files; others are scenarios. Each setting goes to every scenario and
 * scene file that has the parameter, after a suite's own. PL_BAD_INPUT: there is no such suite, scenario or
 * parameter. */
pl_status pl_request_add_cases(const pl_request *request, pl_plan *plan, pl_error *error);

/* Adds the engines asked for, or all profiles that native engines propose for comparison; then those
 * of --with, with the profiles that they propose. An engine that is absent is reported on standard
 * error and left out. */
pl_status pl_request_add_engines(const pl_call *call, const pl_request *request, pl_plan *plan,
                                 pl_error *error);

/* Says on standard error which engines of the plan ask for more threads than this process has CPUs. */
void pl_request_note_threads(const pl_call *call, const pl_plan *plan);

/* Both: the cases, then the engines. */
pl_status pl_request_plan(const pl_call *call, const pl_request *request, pl_plan *plan,
                          pl_error *error);

#endif
