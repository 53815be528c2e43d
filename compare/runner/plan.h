/* The plan of a command: repeats x cases x engine configurations, as a list of independent runs.
 *
 * The order of the engines rotates from repeat to repeat, so that a machine that warms up or slows
 * down does not favour one of them. */
#ifndef PLUMB_PLAN_H
#define PLUMB_PLAN_H

#include "engines/registry.h"
#include "results/result.h"

/* How a case differs from the one that was asked for; all zero: it does not. */
typedef struct pl_variation {
    bool is_member; /* of an ensemble */
    int member;     /* from 0: pl_scene_jitter with the plan's seed */
    int refinement; /* > 1: its time step is the asked one divided by this */
    /* A small change of the scene, such as "n one larger": its scene is built with the parameters
     * `changed`, and the case keeps those of the unchanged one. Static storage; NULL: none. */
    const char *change;
    double changed[PL_MAX_PARAMS];
} pl_variation;

/* A scene with its time step, and where it comes from. */
typedef struct pl_case {
    char *name; /* catalogue name, or the path of a scene file as given */
    const pl_scenario *descriptor;
    double params[PL_MAX_PARAMS]; /* (descriptor->param_count) */
    pl_scene scene;               /* of a deferred one only dt, duration and primary_error */
    char scene_hash[17];
    pl_variation variation;
    json_t *study; /* that its runs belong to, as in results; NULL: none. Owned */
    bool deferred; /* pl_plan_build_scene makes its scene */
} pl_case;

/* An engine with its profile and options. */
typedef struct pl_configuration {
    pl_engine_choice choice;
    char label[PL_LABEL_SIZE];
    json_t *conformance; /* pl_conformance_find when the configuration was added; the plan's own */
} pl_configuration;

/* One run of a plan that is not all cases on all engines. */
typedef struct pl_pairing {
    int test_case, configuration;
} pl_pairing;

/* Starts as {.repeats = N}. */
typedef struct pl_plan {
    pl_scenario **files; /* (file_count): the scene files, which the plan closes */
    int file_count;
    pl_case *cases;
    int case_count;
    pl_configuration *configurations;
    int configuration_count;
    /* (pairing_count): the runs, in this order, where from repeat to repeat the engines of
     * neighbours with the same case take turns; NULL: all on all */
    pl_pairing *pairings;
    int pairing_count;
    int repeated_count; /* of them, the first so many are repeated; 0: all */
    int repeats;
    uint64_t seed;
    json_t *study; /* that the cases added next belong to, as in results; NULL: none. Borrowed */
    pl_variation variation; /* of the cases that are added next */
    bool defers;            /* catalogue scenes added next are built again for each run, not kept */
    json_t *known;          /* a set: what tells the cases apart; the plan's own */
} pl_plan;

/* Opens a scene file ("-" is standard input) as a scenario, which lives as long as the plan. Errors as
 * pl_scenario_open_file. */
pl_status pl_plan_open_file(pl_plan *plan, const char *path, const pl_scenario **scenario,
                            pl_error *error);

/* Moves the scene files of another plan into one that has none. */
void pl_plan_take_files(pl_plan *plan, pl_plan *from);

/* Adds a scenario with `count` settings "NAME=VALUE". A case that the plan already has is not added
 * again. */
pl_status pl_plan_add_scenario(pl_plan *plan, const pl_scenario *scenario,
                               const char *const *settings, int count, pl_error *error);

/* Adds a scenario with a value for each of its parameters. *index is the place of the
 * case with these values in the plan, -1 when another case has the same scene; NULL allowed. */
pl_status pl_plan_add_values(pl_plan *plan, const pl_scenario *scenario, const double *values,
                             int *index, pl_error *error);

/* Adds an engine by its SPEC. A configuration that the plan already has is not added again; another
 * one of the same label is PL_BAD_INPUT, because their rows could not be distinguished. */
pl_status pl_plan_add_engine(pl_plan *plan, const char *spec, pl_error *error);

/* Adds an engine by its choice, under a label of its own. Returns its place. */
int pl_plan_add_choice(pl_plan *plan, const pl_engine_choice *choice, const char *label);

/* Adds one run. A plan with such pairings has no other runs. */
void pl_plan_add_pairing(pl_plan *plan, int test_case, int configuration);

/* Builds the scene of a deferred case, which the caller frees. */
pl_status pl_plan_build_scene(const pl_plan *plan, const pl_case *test_case, pl_scene *scene,
                              pl_error *error);

/* The number of runs. */
long pl_plan_size(const pl_plan *plan);

/* One run of a plan, which owns what the pointers point to. */
typedef struct pl_planned_run {
    const pl_case *test_case;
    const pl_configuration *configuration;
    int repeat; /* from 0 */
} pl_planned_run;

/* The run with that index, 0 to pl_plan_size() - 1. */
pl_planned_run pl_plan_run(const pl_plan *plan, long index);

/* The parameters of a case by name, a new object. The time step and the duration of a scene file are none, unless they
 * were given. */
json_t *pl_plan_case_params(const pl_case *test_case);

/* The keys of a result from `scenario` to `repeat`, `engine_spec`, `threads`, `as_shipped` and `conformance`, and
 * `run`: the hash of those that identify the run. A new reference. */
json_t *pl_planned_run_identity(const pl_plan *plan, const pl_planned_run *run);

/* The hash by which results know the run: `run` of its identity. */
void pl_planned_run_hash(const pl_plan *plan, const pl_planned_run *run, char hash[17]);

/* Frees what the plan owns, and makes it empty. */
void pl_plan_free(pl_plan *plan);

#endif
