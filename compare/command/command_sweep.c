/* plumb sweep: engines over many settings and time steps. Results are appended to results.jsonl as
 * runs end; several processes may make a shard each, in folders of their own. */
#include "base/array.h"
#include "base/folding.h"
#include "base/heap.h"
#include "request.h"
#include "results/store.h"
#include "runner/execute.h"
#include "studies/sweep/analysis.h"
#include "studies/sweep/grid.h"
#include "studies/sweep/pruning.h"
#include "study_command.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The options, and what becomes of them. */
typedef struct sweep {
    pl_request request;
    pl_vary *varied;
    int varied_count;
    int repeats;         /* 0: not given */
    int settings;        /* --settings; -1: not given */
    int changes;         /* --changes; -1: not given */
    double repeat_below; /* s of CPU time; -1: not given */
    const char *list;    /* --plan; NULL: none */
    const char *asked;   /* --shard; NULL: from the environment */

    pl_shard shard;
    bool is_shard;
    char *folder; /* of results.jsonl */
    pl_plan plan;
    json_t *provenance;
    pl_store *store;
    pl_merge before; /* what was there, of this shard and others */
    pl_pruning pruning;
} sweep;

static pl_status add_vary(void *user, const char *text, pl_error *error)
{
    sweep *s = user;
    pl_vary vary;
    const pl_status status = pl_vary_parse(text, PL_VARY_VALUES, &vary, error);
    if (status == PL_OK) {
        pl_push(&s->varied, &s->varied_count, &vary, sizeof vary);
    }
    return status;
}

static pl_status check(void *user, pl_error *error)
{
    const sweep *s = user;
    if (s->varied_count > 0 && s->settings > 0) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--settings belongs to the sweep without --vary, which says what is varied");
    }
    return pl_request_check(user, "name a scenario, a scene file or a --suite", NULL, error);
}

/* ---- The plan ---- */

/* Which shard, and where its results go. */
static void choose_shard(const pl_call *call, sweep *s)
{
    s->is_shard = true;
    pl_call_need(call, s->asked != NULL
                           ? pl_shard_parse(s->asked, &s->shard, call->error)
                           : pl_shard_from_environment(&s->shard, &s->is_shard, call->error));
    s->folder =
        s->is_shard ? pl_shard_folder(s->request.out, s->shard) : pl_heap_copy(s->request.out);
}

/* Adds ENGINE:tuned of each engine for which a file of profiles has it. */
static void add_tuned(const pl_call *call, pl_plan *base)
{
    const int count = base->configuration_count;
    for (int i = 0; i < count; ++i) {
        const pl_engine_info *engine = base->configurations[i].choice.engine;
        pl_tuned_profile profile;
        bool found = false;
        if (pl_engine_profile_index(engine, "tuned") < 0 && !engine->fault.is_fault) {
            pl_call_need(call,
                         pl_tuned_profile_find(engine, "tuned", &profile, &found, call->error));
        }
        if (found) { /* once, however many profiles the engine has */
            char *spec = pl_heap_format("%s:tuned", engine->spec);
            pl_call_need(call, pl_plan_add_engine(base, spec, call->error));
            free(spec);
        }
    }
}

static void set_defaults(sweep *s, bool is_usual)
{
    s->repeats = s->repeats != 0 ? s->repeats : is_usual ? PL_SWEEP_DEFAULT_REPEATS : 1;
    s->repeat_below = s->repeat_below >= 0 ? s->repeat_below : is_usual ? 0.5 : 2;
    s->settings = s->settings >= 0 ? s->settings : is_usual ? PL_SWEEP_DEFAULT_SETTINGS : 0;
    s->changes = s->changes >= 0 ? s->changes : is_usual ? PL_SWEEP_DEFAULT_CHANGES : 0;
    if (s->request.limits.cpu_time <= 0 && is_usual) {
        s->request.limits.cpu_time = PL_SWEEP_DEFAULT_CPU_LIMIT;
    }
}

/* The usual sweep varies the time step, and has drawn settings. */
static void make_plan(const pl_call *call, sweep *s)
{
    const bool is_usual = s->varied_count == 0;
    pl_setting *drawn = NULL;
    int drawn_count = 0;
    set_defaults(s, is_usual);
    pl_plan base = {.repeats = s->repeats};
    pl_call_need(call, pl_request_plan(call, &s->request, &base, call->error));
    if (is_usual) {
        pl_call_need(call, add_vary(s, PL_SWEEP_STEPS, call->error));
        const pl_draw_def def = {.plan = &base,
                                 .steps = s->varied[0].numbers,
                                 .step_count = s->varied[0].count,
                                 .settings = s->settings,
                                 .all_profiles = s->request.engines.count == 0};
        drawn = pl_draw_settings(&def, &drawn_count);
        add_tuned(call, &base);
    }
    const pl_grid_def def = {.base = &base,
                             .varied = s->varied,
                             .varied_count = s->varied_count,
                             .drawn = drawn,
                             .drawn_count = drawn_count,
                             .changes = s->changes,
                             .shard = s->shard};
    pl_call_need(call, pl_grid_plan(&def, &s->plan, call->error));
    pl_plan_take_files(&s->plan, &base);
    free(drawn);
    pl_plan_free(&base);
}

/* ---- Runs ---- */

/* What another shard has, or has been too slow, is not made. */
static bool skip(void *user, const char *run)
{
    const sweep *s = user;
    return pl_store_find(s->store, run) == NULL &&
           (json_object_get(s->before.runs, run) != NULL || pl_pruning_spares(&s->pruning, run));
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    sweep *s = user;
    const char *run = pl_json_get_text(result, "run");
    pl_pruning_see(&s->pruning, result);
    return pl_store_find(s->store, run) != NULL || json_object_get(s->before.runs, run) != NULL
               ? PL_OK
               : pl_store_append(s->store, result, error);
}

static pl_status take(void *user, json_t *result, pl_error *error)
{
    sweep *s = user;
    pl_pruning_see(&s->pruning, result);
    return pl_prune_timeouts(&s->pruning, result, s->provenance, s, keep, error);
}

/* What earlier runs left is read before the store is open: a lock of fcntl(2) ends when any
 * descriptor of the file is closed. */
static void open_store(const pl_call *call, sweep *s)
{
    static const char *const report_files[] = {"sweep.html", NULL};
    pl_request r = s->request;
    pl_status status = PL_OK;
    if (r.resume || (!s->is_shard && !r.force)) {
        status = pl_merge_add_any(&s->before, r.out, call->error);
    }
    if (!r.resume && (status == PL_BAD_INPUT || json_array_size(s->before.results) > 0)) {
        status =
            pl_fail(call->error, PL_BAD_INPUT,
                    "%s/results.jsonl, or a shard next to it, has results: --resume keeps them "
                    "and makes the runs that are missing, --force leaves them out, and --out "
                    "takes another folder",
                    r.out);
    }
    pl_call_need(call, status);
    for (size_t i = 0; i < json_array_size(s->before.results); ++i) {
        pl_pruning_see(&s->pruning, json_array_get(s->before.results, i));
    }
    r.out = s->folder;
    s->store = pl_request_open_store(call, &r, report_files);
}

/* The conclusion from all that is there. */
static void conclude(const pl_call *call, sweep *s)
{
    char *path = pl_heap_format("%s/results.jsonl", s->folder);
    pl_merge_add_results(&s->before, path, pl_store_results(s->store), NULL);
    const pl_result_table_def def = {.files = s->before.sources,
                                     .file_count = s->before.source_count,
                                     .has_changes = true,
                                     .home = s->request.home};
    pl_result_table results;
    pl_call_need(call, pl_result_table_build(&def, &results, call->error));
    pl_result_table_print_left_out(&results, stderr);
    json_t *conclusion = pl_sweep_conclude(&results);
    pl_call_need(call, pl_study_write(&s->request, &pl_sweep_study, conclusion, call->error));
    pl_print_line(stderr, "speed against error is in %s/sweep.html", s->request.out);
    json_decref(conclusion);
    pl_result_table_free(&results);
    free(path);
}

/* Runs what is due and delivers. A shard is a part, and says nothing by itself. */
static int execute(const pl_call *call, sweep *s)
{
    int signal_number = 0;
    s->provenance = pl_call_provenance(call);
    s->before = pl_merge_begin();
    pl_pruning_begin(&s->pruning, &s->plan, s->repeat_below);
    open_store(call, s);
    const pl_execution_def execution = {.plan = &s->plan,
                                        .jobs = s->request.jobs,
                                        .limits = s->request.limits,
                                        .provenance = s->provenance,
                                        .store = s->store,
                                        .progress = stderr,
                                        .user = s,
                                        .skip = skip,
                                        .take = take};
    pl_request_note_threads(call, &s->plan);
    const pl_status status = pl_execute(&execution, &signal_number, call->error);
    pl_call_check_end(call, status, signal_number);
    const json_t *made = pl_store_results(s->store);
    const size_t count = json_array_size(made);
    pl_call_need(call, pl_results_write_json(s->request.json, made, call->error));
    if (!s->is_shard) {
        conclude(call, s);
    }
    pl_print_line(stderr, "%zu %s in %s/results.jsonl; plumb report %s --out DIR makes a report",
                  count, count == 1 ? "result is" : "results are", s->folder, s->request.out);
    pl_store_finish(s->store);
    const int code = pl_results_all_unsupported(made) ? PL_EXIT_NOTHING : PL_EXIT_OK;
    pl_merge_free(&s->before);
    pl_pruning_free(&s->pruning);
    json_decref(s->provenance);
    return pl_call_end_store(call, s->store, s->folder, PL_OK, 0, code);
}

static int run(const pl_call *call)
{
    sweep s = {.request = pl_request_default(),
               .repeat_below = -1,
               .settings = -1,
               .changes = -1,
               .plan = {.repeats = 1}};
    s.request.out = "sweep";
    pl_call_parse(call, &s);
    int code = PL_EXIT_OK;
    pl_call_need(call, pl_request_outputs(&s.request, s.list, call->error));
    choose_shard(call, &s);
    make_plan(call, &s);
    if (s.list != NULL) {
        pl_call_need(call, pl_grid_list(&s.plan, s.list, call->error));
    }
    if (s.plan.configuration_count == 0) {
        code = pl_call_nothing(call, "there is nothing to compare");
    } else if (s.list == NULL) {
        code = execute(call, &s);
    }
    for (int i = 0; i < s.varied_count; ++i) {
        pl_vary_free(&s.varied[i]);
    }
    free(s.varied);
    free(s.folder);
    pl_plan_free(&s.plan);
    pl_request_free(&s.request);
    return code;
}

static const pl_option OPTIONS[] = {
    {"vary", "KEY=VALUES",
     "Vary dt, profile (or solver), an option of the engines or a parameter of the "
     "scenarios, for all that have it; ENGINE.KEY and SCENARIO.KEY vary it for that one "
     "alone and take precedence. VALUES: a,b,c; 1..9; 0..1:+0.25; 1..256:x2, also mixed; "
     "numbers may be fractions, 1/240..1/60:x2. Overrides --set and --dt (repeatable; "
     "default: the usual sweep, described above)",
     PL_OPTION_PARSED, .parse = add_vary, .values = "dt=|profile=|NAME=VALUE"},
    {"repeat", "N", "Runs of each point, interleaved (default 1; 3 without --vary)",
     PL_OPTION_INTEGER, .field = offsetof(sweep, repeats), .min = 1, .max = PL_GRID_MOST_RUNS},
    {"repeat-below", "S",
     "Repeat only runs that took the engine less than S seconds of CPU time (default 0.5; 2 with "
     "--vary): the median over the steps of a long run hardly changes",
     PL_OPTION_NUMBER, .field = offsetof(sweep, repeat_below), .takes = "seconds",
     .max = (double)INFINITY},
    {"settings", "N",
     "Without --vary: settings tried of each engine besides its profiles (default 20; 0: none)",
     PL_OPTION_INTEGER, .field = offsetof(sweep, settings), .max = 10000},
    {"changes", "N",
     "Make each point once more on each of N changed scenes: n one larger, friction up by its last "
     "bit, parameters moved within 1 % and others, of which a scene has those that it has a "
     "parameter for; of a scene file its parameters are moved. A point's error is then the "
     "largest, and its cost is "
     "that of the scene itself (default 2; 0 with --vary)",
     PL_OPTION_INTEGER, .field = offsetof(sweep, changes), .max = 7},
    {"cpu-limit", NULL,
     "Longest CPU time in seconds of the engine's create and steps in a run. A call that reads "
     "counts only if it alone takes longer. The referee's time does not count. A configuration "
     "that hits this limit is not tried at shorter time steps (default 3; none with --vary)",
     .kind = PL_OPTION_HELP},
    {"plan", "FILE",
     "Write the runs as JSON lines in their order, and make none (- is standard output)",
     PL_OPTION_TEXT, .field = offsetof(sweep, list)},
    {"shard", "I/N",
     "Make only part I of N, from 1/N to N/N: whole cases, with all engines and repeats, if "
     "there are N, otherwise ranges of points. Default: the number of the Slurm array task "
     "and the MPI rank, if any",
     PL_OPTION_TEXT, .field = offsetof(sweep, asked)},
    {"out", NULL, "Where results go (default sweep); those of a shard go to DIR/shard-I-of-N",
     .kind = PL_OPTION_HELP},
    {0}};

const pl_command pl_command_sweep = {
    .name = "sweep",
    .summary = "vary steps, options and parameters over many runs",
    .arguments = "SCENARIO|SCENE.json...",
    .description =
        "Runs engines over many settings and prints which is faster at the same error. Without "
        "--vary, the usual sweep: every profile as shipped, and ENGINE:tuned where --profiles has "
        "it, at time steps from 1/60 to 1/960 s by halves; and --settings N of each engine, spread "
        "over its profiles (those of --engine, or all), its tunable options and these time steps, "
        "the same on every machine. With --vary, a grid: all combinations of "
        "time steps and scenario parameters, each on all combinations of engines and their "
        "options.\n\n"
        "Engines take turns, and repeats are outermost, so that a machine that slows down is fair "
        "to all. Writes sweep.html and sweep.json; after several shards plumb report does.",
    .notes =
        "Examples:\n"
        "  plumb sweep slope-slide --vary dt=1/480..1/30:x2 --vary iterations=1..256:x2 --repeat "
        "5\n"
        "  plumb sweep tower --vary n=5..25:+5 --engine ode --vary ode.solver=quick,dantzig\n"
        "  parallel plumb sweep --suite canonical --vary dt=1/60,1/240 --shard {}/4 ::: 1 2 3 4\n"
        "  mpirun -n 4 plumb sweep --suite canonical --vary dt=1/60,1/240\n"
        "  plumb report sweep --out report",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_comparison_options,
               pl_home_options, pl_jobs_options, pl_out_options},
    .check = check,
    .run = run};
