/* plumb compare: scenarios on engines side by side. Results are appended to DIR/results.jsonl as
 * runs end; the report is made of all that is there at the end. */
#include "command/commands.h"
#include "command/contest.h"
#include "report/report.h"
#include "results/store.h"
#include "runner/execute.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

typedef struct options {
    pl_selection selection;
    pl_limits limits;
    pl_texts names, suites, engines;
    const char *out, *json;
    int repeats, jobs;
    bool resume;
} options;

enum { KEY_SUITE = 0x200, KEY_ENGINE, KEY_REPEAT, KEY_JOBS, KEY_OUT, KEY_JSON, KEY_RESUME };

static const struct argp_option argp_options[] = {
    {"suite", KEY_SUITE, "NAME", 0,
     "All scenarios of a suite (repeatable; default canonical when no scenario is named)", 0},
    {"engine", KEY_ENGINE, "SPEC", 0,
     "An engine: NAME[:PROFILE][,OPTION=VALUE...], or the path of a shared object in place of NAME "
     "(repeatable; default all found)",
     0},
    {"repeat", KEY_REPEAT, "N", 0, "Runs of each pair, interleaved (default 1)", 0},
    {"jobs", KEY_JOBS, "N", 0,
     "Runs at a time, of which results come in the order of their ends (default 1: runs side by "
     "side disturb each other's times)",
     0},
    {"out", KEY_OUT, "DIR", 0, "Where results and report go (default report)", 0},
    {"json", KEY_JSON, "FILE", 0, "Write all results as a JSON array too (- is standard output)",
     0},
    {"resume", KEY_RESUME, NULL, 0,
     "Keep the results in DIR and make only the runs that are missing, whatever the outcome of "
     "those there",
     0},
    {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->selection;
        state->child_inputs[1] = &o->limits;
        return 0;
    case KEY_SUITE:
        pl_texts_add(&o->suites, text);
        return 0;
    case KEY_ENGINE:
        pl_texts_add(&o->engines, text);
        return 0;
    case KEY_REPEAT:
        o->repeats = (int)pl_option_integer(state, "--repeat takes an integer", text, 1, 1000000);
        return 0;
    case KEY_JOBS:
        o->jobs = (int)pl_option_integer(state, "--jobs takes an integer", text, 1, 1024);
        return 0;
    case KEY_OUT:
        o->out = text;
        return 0;
    case KEY_JSON:
        o->json = text;
        return 0;
    case KEY_RESUME:
        o->resume = true;
        return 0;
    case ARGP_KEY_ARG:
        pl_texts_add(&o->names, text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "[SCENARIO|SCENE.json...]",
    .doc =
        "Runs scenarios on engines side by side, each run in a process of its own, prints a table "
        "and "
        "writes a report. An engine that falls, crashes or hangs is a row of it, not a failure.\v"
        "Examples:\n"
        "  plumb compare\n"
        "  plumb compare tower wall --engine plumb --engine ode:quick --repeat 5\n"
        "  plumb compare tower --set n=50 --dt 1/240 --out report-50\n"
        "  plumb compare ./mine.json --engine ./mine.so:fast --json - | jq .",
    .children = pl_run_children};

static pl_status add_problems(options *o, pl_plan *plan, pl_error *error)
{
    if (o->names.count == 0 && o->suites.count == 0) {
        pl_texts_add(&o->suites, "canonical");
    }
    return pl_contest_add_problems(&o->selection, &o->suites, &o->names, plan, error);
}

static bool skip(void *user, const char *run)
{
    return pl_store_has(user, run);
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    return pl_store_append(user, result, error);
}

static void print_table(const json_t *results)
{
    const char *plain = getenv("NO_COLOR");
    bool terminal = isatty(STDOUT_FILENO) == 1;
    struct winsize size;
    int width = 120;
    if (terminal && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
        width = size.ws_col;
    }
    pl_report_print_table(stdout, results, terminal && (plain == NULL || plain[0] == '\0'), width);
}

/* Report, --json and table, of all results in the store; the table last, because a reader of it
 * that leaves early ends the program. */
static pl_status deliver(const options *o, json_t *results, pl_error *error)
{
    pl_status status = pl_report_write(o->out, results, error);
    if (status == PL_OK && o->json != NULL) {
        status = pl_results_write_json(o->json, results, error);
    }
    if (o->json == NULL || strcmp(o->json, "-") != 0) {
        print_table(results);
    }
    if (status == PL_OK) {
        size_t count = json_array_size(results);
        fprintf(stderr, "%zu %s and the report are in %s/\n", count,
                count == 1 ? "result" : "results", o->out);
    }
    return status;
}

static bool all_unsupported(const json_t *results)
{
    size_t index;
    const json_t *result;
    json_array_foreach(results, index, result)
    {
        const char *outcome = json_string_value(json_object_get(result, "outcome"));
        if (outcome == NULL || strcmp(outcome, "unsupported") != 0) {
            return false;
        }
    }
    return true;
}

/* Runs what is due and delivers. */
static int execute(const pl_call *call, const options *o, const pl_plan *plan)
{
    pl_error error = {.message = ""};
    pl_store *store = NULL;
    int signal_number = 0;
    int code = PL_EXIT_OK;
    json_t *provenance = pl_provenance(call->program_argc, call->program_argv);
    pl_status status = provenance == NULL ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                                          : pl_store_open(o->out, o->resume, &store, &error);
    if (status == PL_OK) {
        const pl_execution_def execution = {.plan = plan,
                                            .jobs = o->jobs,
                                            .limits = o->limits,
                                            .provenance = provenance,
                                            .progress = stderr,
                                            .user = store,
                                            .skip = skip,
                                            .keep = keep};
        status = pl_execute(&execution, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        status = deliver(o, pl_store_results(store), &error);
        code = all_unsupported(pl_store_results(store)) ? PL_EXIT_NOTHING : PL_EXIT_OK;
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (signal_number != 0) {
        fprintf(stderr,
                "plumb compare: interrupted; %zu results are in %s/results.jsonl: the same command "
                "with "
                "--resume goes on from there\n",
                json_array_size(pl_store_results(store)), o->out);
        code = 128 + signal_number;
    }
    pl_store_close(store);
    json_decref(provenance);
    return code;
}

int pl_command_compare(const pl_call *call)
{
    options o = {.selection = pl_selection_default(),
                 .limits = pl_limits_default(),
                 .out = "report",
                 .repeats = 1,
                 .jobs = 1};
    pl_call_parse(call, &argp, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = o.repeats};
    int code = PL_EXIT_OK;
    pl_status status = add_problems(&o, &plan, &error);
    if (status == PL_OK) {
        status = pl_contest_add_engines("plumb compare", &o.engines, &plan, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (pl_plan_size(&plan) == 0) {
        fprintf(stderr, "plumb compare: there is nothing to compare\n");
        code = PL_EXIT_NOTHING;
    } else {
        code = execute(call, &o, &plan);
    }
    pl_plan_free(&plan);
    pl_selection_free(&o.selection);
    free(o.names.items);
    free(o.suites.items);
    free(o.engines.items);
    return code;
}
