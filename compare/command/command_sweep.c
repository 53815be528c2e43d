/* plumb sweep: engines over many settings and time steps. Results are appended to results.jsonl as
 * runs end; several processes may make a shard each, in folders of their own. */
#include "commands.h"
#include "comparison.h"
#include "report/sweep_report.h"
#include "results/store.h"
#include "runner/execute.h"
#include "studies/sweep/grid.h"
#include "studies/sweep/pruning.h"
#include "studies/sweep/shard_merge.h"
#include "studies/sweep/vary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_comparison comparison;
    pl_vary *varied;
    int varied_count;
    int repeats;         /* 0: not said */
    double repeat_below; /* s of CPU time */
    const char *list;    /* --plan; NULL: none */
    const char *shard;   /* --shard; NULL: from the environment */
} options;

static const pl_comparison_help option_help = {
    .json = "Write all results of this process as a JSON array too (- is standard output)",
    .jobs = "Runs at a time (default 1: runs side by side disturb each other's times)",
    .out = "Where results go (default sweep); of a shard in DIR/shard-I-of-N",
    .reader = "every point"};

enum { KEY_VARY = 0x200, KEY_REPEAT, KEY_REPEAT_BELOW, KEY_PLAN, KEY_SHARD };

static const double REPEAT_BELOW = 2;

static const struct argp_option argp_options[] = {
    {"vary", KEY_VARY, "KEY=VALUES", 0,
     "Varies dt, profile (or solver), an option of the engines or a parameter of the scenarios, "
     "over all that have it; ENGINE.KEY and SCENARIO.KEY over that one alone, where it counts "
     "instead. VALUES: a,b,c; 1..9; 0..1:+0.25; 1..256:x2, also mixed; numbers may be fractions, "
     "1/240..1/60:x2. What --set or --dt say of it does not count (repeatable; without any: "
     "dt=1/60 to 1/960 s, halved each time, of engines shipped with so many iterations these and "
     "five times as many, and a --timeout of 20 s)",
     0},
    {"repeat", KEY_REPEAT, "N", 0,
     "Runs of each point, interleaved (default 1; 3 where nothing is varied by --vary)", 0},
    {"repeat-below", KEY_REPEAT_BELOW, "S", 0,
     "Repeat only what took its engine less than S seconds of CPU time (default 2): the median "
     "over "
     "the steps of a long run hardly moves",
     0},
    {"plan", KEY_PLAN, "FILE", 0,
     "Write the runs as JSON lines in their order, and make none (- is standard output)", 0},
    {"shard", KEY_SHARD, "I/N", 0,
     "Make only part I of N, from 1/N to N/N: whole problems, with all engines and repeats, if "
     "there are N, else stretches of points. Default: that of the Slurm array task and the MPI "
     "rank, if any",
     0},
    {0}};

static void add_vary(options *o, struct argp_state *state, const char *text)
{
    pl_error error = {.message = ""};
    pl_vary *grown = realloc(o->varied, ((size_t)o->varied_count + 1) * sizeof *grown);
    if (grown == NULL) {
        argp_failure(state, PL_EXIT_FAILED, 0, "out of memory");
        abort();
    }
    o->varied = grown;
    if (pl_vary_parse(text, &o->varied[o->varied_count], &error) != PL_OK) {
        argp_error(state, "%s", error.message);
    }
    o->varied_count += 1;
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        pl_comparison_init(&o->comparison, state);
        return 0;
    case KEY_VARY:
        add_vary(o, state, text);
        return 0;
    case KEY_REPEAT:
        o->repeats =
            (int)pl_option_integer(state, "--repeat takes an integer", text, 1, PL_GRID_MOST_RUNS);
        return 0;
    case KEY_REPEAT_BELOW:
        o->repeat_below =
            pl_option_number(state, "--repeat-below takes seconds", text, 0, (double)INFINITY);
        return 0;
    case KEY_PLAN:
        o->list = text;
        return 0;
    case KEY_SHARD:
        o->shard = text;
        return 0;
    case ARGP_KEY_END:
        if (o->comparison.names.count == 0 && o->comparison.suites.count == 0) {
            argp_error(state, "name a scenario, a scene file or a --suite");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "SCENARIO|SCENE.json...",
    .doc =
        "Runs engines over a grid: all combinations of time steps and scenario parameters, each "
        "on all combinations of engines and their options. Engines take turns, and repeats are "
        "outermost, so that a machine that slows down is fair to all. Prints who is faster at the "
        "same error, and writes sweep.html and sweep.json; after several shards plumb report does."
        "\v"
        "Examples:\n"
        "  plumb sweep slope-slide --vary dt=1/480..1/30:x2 --vary iterations=1..256:x2 --repeat "
        "5\n"
        "  plumb sweep tower --vary n=5..25:+5 --engine ode --vary ode.solver=quick,dantzig\n"
        "  parallel plumb sweep --suite canonical --vary dt=1/60,1/240 --shard {}/4 ::: 1 2 3 4\n"
        "  mpirun -n 4 plumb sweep --suite canonical --vary dt=1/60,1/240\n"
        "  plumb report sweep --out report",
    .children = pl_comparison_children};

/* What the callbacks of runs need. */
typedef struct keeper {
    const pl_plan *plan;
    json_t *provenance;
    pl_store *store;
    pl_merge before; /* what was there, of this shard and others */
    pl_repeats repeats;
} keeper;

static bool is_there(const keeper *k, const char *run)
{
    return json_object_get(k->before.runs, run) != NULL || pl_store_has(k->store, run);
}

static bool skip(void *user, const char *run)
{
    const keeper *k = user;
    return is_there(k, run) || pl_repeats_spare(&k->repeats, run);
}

static pl_status keep_one(void *user, json_t *result, pl_error *error)
{
    keeper *k = user;
    pl_repeats_see(&k->repeats, result);
    return is_there(k, pl_json_get_text(result, "run")) ? PL_OK
                                                        : pl_store_append(k->store, result, error);
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    keeper *k = user;
    pl_status status = keep_one(k, result, error);
    return status == PL_OK ? pl_prune_timeouts(k->plan, result, k->provenance, k, keep_one, error)
                           : status;
}

static bool all_unsupported(const json_t *results)
{
    size_t index;
    const json_t *result;
    json_array_foreach(results, index, result)
    {
        if (strcmp(pl_json_get_text(result, "outcome"), "unsupported") != 0) {
            return false;
        }
    }
    return json_array_size(results) > 0;
}

/* What earlier runs left is read before the store is open: a lock of fcntl(2) ends when any
 * descriptor of the file is closed. */
static pl_status open_store(const options *o, const char *folder, keeper *k, pl_error *error)
{
    pl_status status = pl_merge_begin(&k->before, error);
    if (status == PL_OK && o->comparison.resume) {
        status = pl_merge_add_any(&k->before, o->comparison.out, error);
    }
    for (size_t i = 0; status == PL_OK && i < json_array_size(k->before.results); ++i) {
        pl_repeats_see(&k->repeats, json_array_get(k->before.results, i));
    }
    return status == PL_OK ? pl_store_open(folder, o->comparison.resume, &k->store, error) : status;
}

/* The analysis of all that is there: files, then tables on standard output, unless the JSON is
 * there. */
static pl_status analyse(const options *o, const json_t *results, pl_error *error)
{
    pl_sweep_analysis analysis;
    pl_status status = pl_sweep_analyse(results, &analysis, error);
    if (status == PL_OK) {
        status = pl_sweep_report_write(o->comparison.out, &analysis, error);
    }
    if (status == PL_OK && (o->comparison.json == NULL || strcmp(o->comparison.json, "-") != 0)) {
        pl_sweep_report_print(stdout, &analysis);
    }
    pl_sweep_analysis_free(&analysis);
    return status;
}

/* What a process leaves that came to its end. A shard is a part, and says nothing by itself. */
static pl_status deliver(const options *o, keeper *k, bool is_shard, const char *folder,
                         pl_error *error)
{
    json_t *made = pl_store_results(k->store);
    pl_status status = PL_OK;
    if (o->comparison.json != NULL) {
        status = pl_results_write_json(o->comparison.json, made, error);
    }
    if (status == PL_OK && !is_shard) {
        status = pl_merge_add_results(&k->before, made, NULL, error);
    }
    if (status == PL_OK && !is_shard) {
        status = analyse(o, k->before.results, error);
    }
    if (status == PL_OK) {
        const size_t count = json_array_size(made);
        fflush(stdout);
        if (!is_shard) {
            fprintf(stderr, "speed against error is in %s/sweep.html\n", o->comparison.out);
        }
        fprintf(stderr, "%zu %s in %s/results.jsonl; plumb report %s --out DIR makes a report\n",
                count, count == 1 ? "result is" : "results are", folder, o->comparison.out);
    }
    return status;
}

/* Runs what is due and delivers. */
static int execute(const pl_call *call, const options *o, const pl_plan *plan, bool is_shard,
                   const char *folder)
{
    pl_error error = {.message = ""};
    keeper k = {.plan = plan, .provenance = pl_provenance(call->program_argc, call->program_argv)};
    int signal_number = 0;
    int code = PL_EXIT_OK;
    pl_status status = k.provenance == NULL
                           ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                           : pl_repeats_begin(&k.repeats, plan, o->repeat_below, &error);
    if (status == PL_OK) {
        status = open_store(o, folder, &k, &error);
    }
    if (status == PL_OK) {
        const pl_execution_def execution = {.plan = plan,
                                            .jobs = o->comparison.jobs,
                                            .limits = o->comparison.limits,
                                            .provenance = k.provenance,
                                            .progress = stderr,
                                            .user = &k,
                                            .skip = skip,
                                            .keep = keep};
        status = pl_execute(&execution, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        status = deliver(o, &k, is_shard, folder, &error);
        code = all_unsupported(pl_store_results(k.store)) ? PL_EXIT_NOTHING : PL_EXIT_OK;
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (signal_number != 0) {
        fprintf(stderr,
                "plumb sweep: interrupted; %zu results are in %s/results.jsonl: the same command "
                "with --resume goes on from there\n",
                json_array_size(pl_store_results(k.store)), folder);
        code = 128 + signal_number;
    }
    pl_store_close(k.store);
    pl_merge_free(&k.before);
    pl_repeats_free(&k.repeats);
    json_decref(k.provenance);
    return code;
}

/* Which shard, and where its results go; *folder is malloc'd. */
static pl_status choose_shard(const options *o, pl_shard *shard, bool *is_shard, char **folder,
                              pl_error *error)
{
    *is_shard = true;
    pl_status status = o->shard != NULL ? pl_shard_parse(o->shard, shard, error)
                                        : pl_shard_from_environment(shard, is_shard, error);
    if (status != PL_OK) {
        return status;
    }
    *folder = *is_shard ? pl_shard_folder(o->comparison.out, *shard) : strdup(o->comparison.out);
    return *folder == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory") : PL_OK;
}

static pl_status make_plan(options *o, pl_shard shard, pl_plan *plan, pl_error *error)
{
    const bool is_usual = o->varied_count == 0;
    const int repeats = is_usual ? PL_SWEEP_DEFAULT_REPEATS : 1;
    pl_plan base = {.repeats = o->repeats > 0 ? o->repeats : repeats};
    if (o->comparison.limits.timeout <= 0) {
        o->comparison.limits.timeout =
            is_usual ? PL_SWEEP_DEFAULT_TIMEOUT : pl_limits_default().timeout;
    }
    pl_status status = pl_comparison_add_problems(&o->comparison, &base, error);
    if (status == PL_OK) {
        status = pl_comparison_add_engines("plumb sweep", &o->comparison, &base, error);
    }
    if (status == PL_OK) {
        status = is_usual ? pl_default_vary(&base, &o->varied, &o->varied_count, error) : PL_OK;
    }
    if (status == PL_OK) {
        const pl_grid_def def = {.base = &base,
                                 .varied = o->varied,
                                 .varied_count = o->varied_count,
                                 .dt = o->comparison.selection.dt,
                                 .duration = o->comparison.selection.duration,
                                 .shard = shard};
        status = pl_grid_plan(&def, plan, error);
    }
    pl_plan_free(&base);
    return status;
}

static void free_options(options *o)
{
    for (int i = 0; i < o->varied_count; ++i) {
        pl_vary_free(&o->varied[i]);
    }
    free(o->varied);
    pl_comparison_free(&o->comparison);
}

int pl_command_sweep(const pl_call *call)
{
    options o = {.comparison = pl_comparison_default(&option_help), .repeat_below = REPEAT_BELOW};
    o.comparison.out = "sweep";
    o.comparison.limits.timeout = 0; /* not said */
    pl_call_parse(call, &argp, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    pl_shard shard;
    bool is_shard = false;
    char *folder = NULL;
    int code = PL_EXIT_OK;
    pl_status status = choose_shard(&o, &shard, &is_shard, &folder, &error);
    if (status == PL_OK) {
        status = make_plan(&o, shard, &plan, &error);
    }
    if (status == PL_OK && o.list != NULL) {
        status = pl_grid_list(&plan, o.list, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (plan.configuration_count == 0) {
        fprintf(stderr, "plumb sweep: there is nothing to compare\n");
        code = PL_EXIT_NOTHING;
    } else if (o.list == NULL) {
        code = execute(call, &o, &plan, is_shard, folder);
    }
    pl_plan_free(&plan);
    free(folder);
    free_options(&o);
    return code;
}
