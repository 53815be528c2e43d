/* plumb run SCENARIO --engine SPEC: one run, one result. */
#include "base/folding.h"
#include "base/heap.h"
#include "base/json_field.h"
#include "base/table.h"
#include "capture_file.h"
#include "request.h"
#include "results/result.h"
#include "results/store.h"
#include "runner/execute.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct options {
    pl_request request;
    const char *trajectory;
    long capture_step; /* from 1; 0: nothing is captured */
    const char *capture;
} options;

static pl_status parse_capture(void *user, const char *text, pl_error *error)
{
    options *o = user;
    return pl_capture_parse(text, &o->capture_step, &o->capture)
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT,
                         "--capture takes STEP:FILE, with STEP from 1; found \"%s\"", text);
}

static pl_status check(void *user, pl_error *error)
{
    const options *o = user;
    const pl_request *request = &o->request;
    const char *wrong =
        request->names.count == 0     ? "which scenario? See plumb list scenarios"
        : request->names.count > 1    ? "one scenario at a time: plumb compare runs several"
        : request->engines.count == 0 ? "which engine? --engine SPEC; see plumb list engines"
        : request->engines.count > 1  ? "one engine at a time: plumb compare runs several"
        : pl_is_stdout(request->json) && pl_is_stdout(o->trajectory)
            ? "--json - and --trajectory - would mix on standard output"
            : NULL;
    return wrong == NULL ? PL_OK : pl_fail(error, PL_BAD_INPUT, "%s", wrong);
}

/* Where the frames of the run go, and its result. */
typedef struct kept {
    FILE *frames; /* NULL: nowhere */
    json_t *result;
} kept;

static pl_status give_file(void *user, const char *run, FILE **file, pl_error *error)
{
    (void)run;
    (void)error;
    *file = ((kept *)user)->frames;
    return PL_OK;
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    (void)error;
    ((kept *)user)->result = json_incref(result);
    return PL_OK;
}

static void add_metric(pl_table *table, const char *name, const json_t *metric)
{
    const json_t *value = json_object_get(metric, "value");
    const int answer = (int)pl_json_get_number(metric, "answer");
    pl_table_add(table, name);
    if (json_is_string(value)) {
        pl_table_add(table, json_string_value(value));
    } else if (json_is_number(value)) {
        char nearest[64] = "";
        snprintf(nearest, sizeof nearest, ", nearest right answer: %d", answer);
        pl_table_format_cell(table, "%.6g %s%s", json_number_value(value),
                             pl_json_get_text(metric, "unit"), answer == 0 ? "" : nearest);
    } else {
        pl_table_format_cell(table, "none: %s", pl_json_get_text(metric, "reason"));
    }
}

static void print_result(const json_t *result)
{
    pl_folding folding;
    FILE *out = pl_folding_begin(&folding, stdout);
    const json_t *steps = json_object_get(result, "steps");
    fprintf(out, "%s on %s: %s, %.0f of %.0f steps\n", pl_json_get_text(result, "scenario"),
            pl_json_get_text(result, "label"), pl_json_get_text(result, "outcome"),
            pl_json_get_number(steps, "done"), pl_json_get_number(steps, "asked"));
    if (pl_json_get_text(result, "reason")[0] != '\0') {
        fprintf(out, "  %s\n", pl_json_get_text(result, "reason"));
    }
    fprintf(out, "  verdict: %s%s%s\n", pl_verdict_name(pl_verdict_of(result)),
            pl_json_get_text(result, "verdict_reason")[0] != '\0' ? "; " : "",
            pl_json_get_text(result, "verdict_reason"));
    pl_folding_end(&folding);
    pl_table table = {.indent = 2};
    pl_table_columns(&table, "metric|value");
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const char *name = pl_metric_table[i].name;
        const json_t *metric = json_object_get(json_object_get(result, "metrics"), name);
        if (metric != NULL) {
            add_metric(&table, name, metric);
        }
    }
    pl_table_print(&table, stdout);
    pl_table_free(&table);
}

/* The file that gets the frames: under another name until it is complete, unless it is no regular
 * file. */
typedef struct trajectory {
    const char *path; /* as asked for; NULL: none */
    char *unfinished; /* NULL: none */
    FILE *file;       /* NULL: none */
} trajectory;

static pl_status open_trajectory(const char *path, trajectory *t, pl_error *error)
{
    struct stat found;
    const bool is_regular =
        path != NULL && !pl_is_stdout(path) && (stat(path, &found) != 0 || S_ISREG(found.st_mode));
    *t = (trajectory){.path = path};
    if (path == NULL) {
        return PL_OK;
    }
    t->unfinished = is_regular ? pl_heap_format("%s.unfinished", path) : NULL;
    t->file = pl_is_stdout(path) ? fdopen(dup(STDOUT_FILENO), "w")
                                 : fopen(is_regular ? t->unfinished : path, "we");
    return t->file == NULL ? pl_fail(error, PL_IO, "%s: %s", path, strerror(errno)) : PL_OK;
}

/* Gives a complete file its name, and removes any other. */
static pl_status close_trajectory(trajectory *t, pl_status status, bool is_complete,
                                  pl_error *error)
{
    bool failed = false;
    if (t->file != NULL) {
        failed = ferror(t->file) != 0 || fflush(t->file) != 0;
        failed = failed || (t->unfinished != NULL && fsync(fileno(t->file)) != 0);
        failed = fclose(t->file) != 0 || failed;
    }
    if (status == PL_OK && !failed && is_complete && t->unfinished != NULL) {
        failed = rename(t->unfinished, t->path) != 0;
    } else if (t->file != NULL && t->unfinished != NULL) {
        unlink(t->unfinished);
    }
    free(t->unfinished);
    return status == PL_OK && failed
               ? pl_fail(error, PL_IO, "%s could not be written: %s", t->path, strerror(errno))
               : status;
}

/* Where a captured contact problem comes from: these keys of the run's identity. */
static json_t *capture_source(const pl_plan *plan)
{
    static const char *const keys[] = {"scenario", "params",  "seed",     "scene_hash",
                                       "engine",   "profile", "settings", "engine_version"};
    const pl_planned_run planned = pl_plan_run(plan, 0);
    json_t *identity = pl_planned_run_identity(plan, &planned);
    json_t *source = json_object();
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        json_object_set(source, keys[i], json_object_get(identity, keys[i]));
    }
    json_decref(identity);
    return source;
}

/* Checks that the capture which is asked for can be made. */
static pl_status check_capture(const options *o, const pl_plan *plan, pl_error *error)
{
    const pl_engine_info *engine = plan->configurations[0].choice.engine;
    const long steps = pl_scene_steps(&plan->cases[0].scene);
    if (o->capture != NULL && !engine->gives_contact_problems) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "--capture: engine %s does not give its contact "
                       "problems; plumb does",
                       engine->name);
    }
    return o->capture == NULL || o->capture_step <= steps
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT, "--capture: expected a step of 1 to %ld, found %ld",
                         steps, o->capture_step);
}

/* Returns the result. */
static json_t *execute(const pl_call *call, const options *o, const pl_plan *plan)
{
    int signal_number = 0;
    trajectory frames = {.file = NULL};
    pl_call_need(call, check_capture(o, plan, call->error));
    pl_capture_target target = {
        .path = o->capture, .step = o->capture_step, .source = capture_source(plan)};
    const pl_capture capture = {.step = o->capture_step, .take = pl_capture_write, .user = &target};
    json_t *provenance = pl_call_provenance(call);
    pl_status status = open_trajectory(o->trajectory, &frames, call->error);
    kept found = {.frames = frames.file};
    if (status == PL_OK) {
        const pl_execution_def execution = {.plan = plan,
                                            .jobs = 1,
                                            .limits = o->request.limits,
                                            .capture = o->capture == NULL ? NULL : &capture,
                                            .provenance = provenance,
                                            .progress = isatty(STDERR_FILENO) == 1 ? stderr : NULL,
                                            .user = &found,
                                            .frames = give_file,
                                            .take = keep};
        status = pl_execute(&execution, &signal_number, call->error);
    }
    status = close_trajectory(&frames, status, signal_number == 0, call->error);
    json_decref(target.source);
    json_decref(provenance);
    pl_call_check_end(call, status, signal_number);
    return found.result;
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    pl_call_parse(call, &o);
    pl_plan plan = {.repeats = 1};
    /* Of files that are numbered, the first stands for all. */
    char *capture = o.capture == NULL ? NULL : pl_capture_path(o.capture, 1);
    pl_call_need(call, pl_request_outputs(&o.request, o.trajectory, call->error));
    pl_call_need(call, pl_output_check(capture, o.request.force, call->error));
    pl_call_need(call, pl_request_add_cases(&o.request, &plan, call->error));
    pl_engine_describe_within(&o.request.limits);
    pl_call_need(call, pl_plan_add_engine(&plan, o.request.engines.items[0], call->error));
    pl_request_note_threads(call, &plan);
    json_t *result = execute(call, &o, &plan);
    if (!pl_is_stdout(o.request.json) && !pl_is_stdout(o.trajectory)) {
        print_result(result);
    }
    pl_call_need(call, pl_results_write_json(o.request.json, result, call->error));
    const bool is_ok = strcmp(pl_json_get_text(result, "outcome"), "ok") == 0;
    json_decref(result);
    pl_plan_free(&plan);
    pl_request_free(&o.request);
    free(capture);
    return is_ok ? PL_EXIT_OK : PL_EXIT_FAILED;
}

static const pl_option OPTIONS[] = {
    {"engine", "SPEC",
     "The engine: NAME[:PROFILE][,OPTION=VALUE...], or the path of a shared object in place "
     "of NAME",
     PL_OPTION_TEXTS, .field = offsetof(options, request.engines)},
    {"json", "FILE", "Write the result as a JSON object (- is standard output)", PL_OPTION_TEXT,
     .field = offsetof(options, request.json)},
    {"trajectory", "FILE", "Write every frame as CSV (- is standard output)", PL_OPTION_TEXT,
     .field = offsetof(options, trajectory)},
    {"capture", "STEP:FILE",
     "Write the contact problem of that step (from 1) as JSON: that of the largest "
     "island, or, with {} in FILE, those of all islands, numbered",
     PL_OPTION_PARSED, .parse = parse_capture},
    {0}};

const pl_command pl_command_run = {
    .name = "run",
    .summary = "run one scenario on one engine",
    .arguments = "SCENARIO|SCENE.json --engine SPEC",
    .description = "Runs one scenario on one engine and prints its metrics. Exits with 3 when the "
                   "outcome is not ok.",
    .notes = "Examples:\n"
             "  plumb run tower --set n=25 --engine ode:quick,iterations=50\n"
             "  plumb run tower --engine plumb,tolerance=1e-10 --json -\n"
             "  plumb run ./mine.json --engine bullet --trajectory frames.csv\n"
             "  plumb run wall --engine plumb --capture 60:wall.json",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_force_options},
    .check = check,
    .run = run};
