/* plumb compare: scenarios on engines side by side. Results are appended to DIR/results.jsonl as
 * runs end; the report is made of all that is there at the end. */
#include "commands.h"
#include "comparison.h"
#include "report/report.h"
#include "results/store.h"
#include "runner/execute.h"
#include "studies/iterations/iterations_to_tolerance.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

typedef struct options {
    pl_comparison comparison;
    int repeats;
    bool tolerance; /* --iterations-to-tolerance */
} options;

static const pl_comparison_help option_help = {
    .suite = "All scenarios of a suite (repeatable; default canonical when no scenario is named)",
    .json = "Write all results as a JSON array too (- is standard output)",
    .jobs = "Runs at a time, of which results come in the order of their ends (default 1: runs "
            "side by side disturb each other's times)",
    .out = "Where results and report go (default report)"};

enum { KEY_REPEAT = 0x200, KEY_TOLERANCE };

static const struct argp_option argp_options[] = {
    {"repeat", KEY_REPEAT, "N", 0, "Runs of each pair, interleaved (default 1)", 0},
    {"iterations-to-tolerance", KEY_TOLERANCE, NULL, 0,
     "Also find that metric (plumb list metrics), by up to 20 more runs of each pair of which runs "
     "are made, where the engine has an option iterations",
     0},
    {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        pl_comparison_init(&o->comparison, state);
        return 0;
    case KEY_REPEAT:
        o->repeats = (int)pl_option_integer(state, "--repeat takes an integer", text, 1, 1000000);
        return 0;
    case KEY_TOLERANCE:
        o->tolerance = true;
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
    .children = pl_comparison_children};

/* What the callbacks of runs need. */
typedef struct keeper {
    pl_store *store;
    const pl_plan *plan;
    const pl_metric *tolerances; /* of pl_tolerance_search; NULL: not asked for */
} keeper;

static bool skip(void *user, const char *run)
{
    const keeper *k = user;
    return pl_store_has(k->store, run);
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    const keeper *k = user;
    pl_status status =
        k->tolerances == NULL ? PL_OK : pl_tolerance_put(k->plan, k->tolerances, result, error);
    return status == PL_OK ? pl_store_append(k->store, result, error) : status;
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
    pl_status status = pl_report_write(o->comparison.out, results, error);
    if (status == PL_OK && o->comparison.json != NULL) {
        status = pl_results_write_json(o->comparison.json, results, error);
    }
    if (o->comparison.json == NULL || strcmp(o->comparison.json, "-") != 0) {
        print_table(results);
    }
    if (status == PL_OK) {
        size_t count = json_array_size(results);
        fprintf(stderr, "%zu %s and the report are in %s/\n", count,
                count == 1 ? "result" : "results", o->comparison.out);
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

/* The searches first, because a row is written whole; then the runs of the plan. */
static pl_status run_all(const options *o, const pl_plan *plan, pl_store *store, json_t *provenance,
                         int *signal_number, pl_error *error)
{
    keeper k = {.store = store, .plan = plan};
    pl_execution_def execution = {.plan = plan,
                                  .jobs = o->comparison.jobs,
                                  .limits = o->comparison.limits,
                                  .provenance = provenance,
                                  .progress = stderr,
                                  .user = &k,
                                  .skip = skip,
                                  .keep = keep};
    if (!o->tolerance) {
        return pl_execute(&execution, signal_number, error);
    }
    pl_progress bar;
    const pl_tolerance_def def = {.plan = plan,
                                  .limits = o->comparison.limits,
                                  .provenance = provenance,
                                  .bar = &bar,
                                  .user = &k,
                                  .skip = skip};
    long searches = 0, due = 0;
    pl_metric *tolerances = NULL;
    pl_status status = pl_tolerance_most_runs(&def, &searches, error);
    if (status == PL_OK) {
        status = pl_execution_due(&execution, &due, error);
    }
    if (status != PL_OK) {
        return status;
    }
    bar = pl_progress_begin(stderr, searches + due, pl_monotonic_seconds());
    execution.bar = &bar;
    status = pl_tolerance_search(&def, &tolerances, signal_number, error);
    k.tolerances = tolerances;
    if (status == PL_OK && *signal_number == 0) {
        status = pl_execute(&execution, signal_number, error);
    }
    pl_progress_end(&bar);
    free(tolerances);
    return status;
}

/* Runs what is due and delivers. */
static int execute(const pl_call *call, const options *o, const pl_plan *plan)
{
    pl_error error = {.message = ""};
    pl_store *store = NULL;
    int signal_number = 0;
    int code = PL_EXIT_OK;
    json_t *provenance = pl_provenance(call->program_argc, call->program_argv);
    pl_status status = provenance == NULL
                           ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                           : pl_store_open(o->comparison.out, o->comparison.resume, &store, &error);
    if (status == PL_OK) {
        status = run_all(o, plan, store, provenance, &signal_number, &error);
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
                json_array_size(pl_store_results(store)), o->comparison.out);
        code = 128 + signal_number;
    }
    pl_store_close(store);
    json_decref(provenance);
    return code;
}

int pl_command_compare(const pl_call *call)
{
    options o = {.comparison = pl_comparison_default(&option_help), .repeats = 1};
    o.comparison.out = "report";
    pl_call_parse(call, &argp, &o);
    if (o.comparison.names.count == 0 && o.comparison.suites.count == 0) {
        pl_texts_add(&o.comparison.suites, "canonical");
    }
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = o.repeats};
    int code = PL_EXIT_OK;
    pl_status status = pl_comparison_add_problems(&o.comparison, &plan, &error);
    if (status == PL_OK) {
        status = pl_comparison_add_engines("plumb compare", &o.comparison, &plan, &error);
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
    pl_comparison_free(&o.comparison);
    return code;
}
