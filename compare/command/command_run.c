/* plumb run SCENARIO --engine SPEC: one run, one result. */
#include "commands.h"

#include "results/result.h"
#include "results/store.h"
#include "runner/execute.h"
#include "selection.h"
#include "studies/solve/problem_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct options {
    pl_selection selection;
    pl_limits limits;
    pl_texts names;
    const char *engine, *json, *trajectory;
    long capture_step; /* from 1; 0: nothing is captured */
    const char *capture;
} options;

enum { KEY_ENGINE = 0x200, KEY_JSON, KEY_TRAJECTORY, KEY_CAPTURE };

static const struct argp_option argp_options[] = {
    {"engine", KEY_ENGINE, "SPEC", 0,
     "The engine: NAME[:PROFILE][,OPTION=VALUE...], or the path of a shared object in place of "
     "NAME",
     0},
    {"json", KEY_JSON, "FILE", 0, "Write the result as a JSON object (- is standard output)", 0},
    {"trajectory", KEY_TRAJECTORY, "FILE", 0, "Write every frame as CSV (- is standard output)", 0},
    {"capture", KEY_CAPTURE, "STEP:FILE", 0,
     "Write the contact problem of that step (from 1), as plumb solve reads it: the largest "
     "island's; with {} in FILE every island's, numbered",
     0},
    {0}};

static void check(const options *o, struct argp_state *state)
{
    bool json_out = o->json != NULL && strcmp(o->json, "-") == 0;
    bool trajectory_out = o->trajectory != NULL && strcmp(o->trajectory, "-") == 0;
    if (o->names.count == 0) {
        argp_error(state, "which scenario? See plumb list scenarios");
    }
    if (o->engine == NULL) {
        argp_error(state, "which engine? --engine SPEC; see plumb list engines");
    }
    if (json_out && trajectory_out) {
        argp_error(state, "--json - and --trajectory - would mix on standard output");
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->selection;
        state->child_inputs[1] = &o->limits;
        return 0;
    case KEY_ENGINE:
        if (o->engine != NULL) {
            argp_error(state, "one engine at a time: plumb compare runs several");
        }
        o->engine = text;
        return 0;
    case KEY_JSON:
        o->json = text;
        return 0;
    case KEY_TRAJECTORY:
        o->trajectory = text;
        return 0;
    case KEY_CAPTURE:
        if (!pl_capture_parse(text, &o->capture_step, &o->capture)) {
            argp_error(state, "--capture takes STEP:FILE, with STEP from 1; found \"%s\"", text);
        }
        return 0;
    case ARGP_KEY_ARG:
        if (o->names.count > 0) {
            argp_error(state, "one scenario at a time: plumb compare runs several");
        }
        pl_texts_add(&o->names, text);
        return 0;
    case ARGP_KEY_END:
        check(o, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "SCENARIO|SCENE.json --engine SPEC",
    .doc = "Runs one scenario on one engine and prints its metrics. Exits with 3 when the outcome "
           "is not "
           "ok.\v"
           "Examples:\n"
           "  plumb run tower --set n=25 --engine ode:quick,iterations=50\n"
           "  plumb run tower --engine plumb,tolerance=1e-10 --json -\n"
           "  plumb run ./mine.json --engine bullet --trajectory frames.csv\n"
           "  plumb run wall --engine plumb --capture 60:wall.json",
    .children = pl_run_children};

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    (void)error;
    json_t **kept = user;
    *kept = json_incref(result);
    return PL_OK;
}

static void print_metric(const char *name, const json_t *metric)
{
    const json_t *value = json_object_get(metric, "value");
    if (json_is_string(value)) {
        printf("  %-22s %s\n", name, json_string_value(value));
    } else if (json_is_number(value)) {
        printf("  %-22s %-12.6g %s\n", name, json_number_value(value),
               pl_json_get_text(metric, "unit"));
    } else {
        printf("  %-22s none: %s\n", name, pl_json_get_text(metric, "reason"));
    }
}

static void print_result(const json_t *result)
{
    const json_t *steps = json_object_get(result, "steps");
    printf("%s on %s: %s, %lld of %lld steps\n", pl_json_get_text(result, "scenario"),
           pl_json_get_text(result, "label"), pl_json_get_text(result, "outcome"),
           (long long)json_integer_value(json_object_get(steps, "done")),
           (long long)json_integer_value(json_object_get(steps, "asked")));
    if (pl_json_get_text(result, "reason")[0] != '\0') {
        printf("  %s\n", pl_json_get_text(result, "reason"));
    }
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const char *name = pl_metric_table[i].name;
        const json_t *metric = json_object_get(json_object_get(result, "metrics"), name);
        if (metric != NULL) {
            print_metric(name, metric);
        }
    }
}

static FILE *open_trajectory(const char *path, pl_error *error)
{
    FILE *file = strcmp(path, "-") == 0 ? fdopen(dup(STDOUT_FILENO), "w") : fopen(path, "we");
    if (file == NULL) {
        pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
    }
    return file;
}

/* Writes the result where it was asked for. */
static pl_status deliver(const options *o, const json_t *result, pl_error *error)
{
    bool data_on_stdout = (o->json != NULL && strcmp(o->json, "-") == 0) ||
                          (o->trajectory != NULL && strcmp(o->trajectory, "-") == 0);
    if (!data_on_stdout) {
        print_result(result);
    }
    return o->json == NULL ? PL_OK : pl_results_write_json(o->json, result, error);
}

/* What a captured problem says of where it comes from: the keys of the run's identity that people
 * ask for. */
static json_t *capture_source(const pl_plan *plan)
{
    static const char *const keys[] = {"scenario", "params",  "seed",     "scene_hash",
                                       "engine",   "profile", "settings", "engine_version"};
    const pl_planned_run planned = pl_plan_run(plan, 0);
    json_t *identity = pl_planned_run_identity(plan, &planned);
    json_t *source = json_object();
    int failed = identity == NULL;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        failed |= json_object_set(source, keys[i], json_object_get(identity, keys[i]));
    }
    json_decref(identity);
    if (failed != 0) {
        json_decref(source);
        return NULL;
    }
    return source;
}

/* Makes ready to capture, where that is asked for and can be done. */
static pl_status prepare_capture(const options *o, const pl_plan *plan, pl_capture_target *target,
                                 pl_error *error)
{
    if (o->capture == NULL) {
        return PL_OK;
    }
    const pl_engine *engine = plan->configurations[0].choice.engine;
    long steps = pl_scene_steps(&plan->cases[0].scene);
    if (engine->capture == NULL) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "--capture: engine %s does not give its contact "
                       "problems; plumb does",
                       engine->name);
    }
    if (o->capture_step > steps) {
        return pl_fail(error, PL_BAD_INPUT, "--capture: expected a step of 1 to %ld, found %ld",
                       steps, o->capture_step);
    }
    *target = (pl_capture_target){
        .path = o->capture, .step = o->capture_step, .source = capture_source(plan)};
    return target->source == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory") : PL_OK;
}

static int run(const pl_call *call, const options *o)
{
    pl_capture_target target = {.path = NULL};
    const pl_capture capture = {.step = o->capture_step, .take = pl_capture_write, .user = &target};
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    json_t *provenance = pl_provenance(call->program_argc, call->program_argv);
    json_t *result = NULL;
    FILE *trajectory = NULL;
    int code = PL_EXIT_OK;
    int signal_number = 0;
    pl_status status = provenance == NULL ? pl_fail(&error, PL_NO_MEMORY, "out of memory") : PL_OK;
    if (status == PL_OK) {
        const pl_asked asked = {.name = o->names.items[0]};
        status = pl_selection_add(&o->selection, &asked, 1, &plan, &error);
    }
    if (status == PL_OK) {
        status = pl_plan_add_engine(&plan, o->engine, &error);
    }
    if (status == PL_OK) {
        status = prepare_capture(o, &plan, &target, &error);
    }
    if (status == PL_OK && o->trajectory != NULL) {
        trajectory = open_trajectory(o->trajectory, &error);
        status = error.status;
    }
    if (status == PL_OK) {
        const pl_execution_def execution = {.plan = &plan,
                                            .jobs = 1,
                                            .limits = o->limits,
                                            .trajectory = trajectory,
                                            .capture = o->capture == NULL ? NULL : &capture,
                                            .provenance = provenance,
                                            .progress = isatty(STDERR_FILENO) == 1 ? stderr : NULL,
                                            .user = &result,
                                            .keep = keep};
        status = pl_execute(&execution, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        status = deliver(o, result, &error);
        code = strcmp(pl_json_get_text(result, "outcome"), "ok") == 0 ? PL_EXIT_OK : PL_EXIT_FAILED;
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (signal_number != 0) {
        code = 128 + signal_number;
    }
    if (trajectory != NULL) {
        fclose(trajectory);
    }
    json_decref(target.source);
    json_decref(result);
    json_decref(provenance);
    pl_plan_free(&plan);
    return code;
}

int pl_command_run(const pl_call *call)
{
    options o = {.selection = pl_selection_default(), .limits = pl_limits_default()};
    pl_call_parse(call, &argp, &o);
    int code = run(call, &o);
    pl_selection_free(&o.selection);
    free(o.names.items);
    return code;
}
