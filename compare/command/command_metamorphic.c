/* plumb metamorphic: checks of engines that need no reference. */
#include "base/heap.h"
#include "studies/metamorphic/metamorphic.h"
#include "study_command.h"

#include <stdlib.h>

typedef struct options {
    pl_request request;
    pl_texts checks;
} options;

/* The runs to make. */
typedef struct chosen_work {
    const pl_plan *plan;
    bool *chosen; /* of pl_checks */
} chosen_work;

/* The caller frees *chosen. */
static pl_status choose_checks(const options *o, bool **chosen, pl_error *error)
{
    int count;
    (void)pl_checks(&count);
    *chosen = pl_heap_new((size_t)count, sizeof **chosen);
    for (int i = 0; i < count; ++i) {
        (*chosen)[i] = o->checks.count == 0;
    }
    pl_status status = PL_OK;
    for (int i = 0; i < o->checks.count && status == PL_OK; ++i) {
        status = pl_check_choose(o->checks.items[i], *chosen, error);
    }
    return status;
}

static pl_status make_runs(void *user, pl_execution_def *how, int *signal_number, pl_error *error)
{
    const chosen_work *work = user;
    return pl_metamorphic_run(work->plan, work->chosen, how, signal_number, error);
}

static pl_status check(void *user, pl_error *error)
{
    return pl_request_check(user, "which scenario? See plumb list scenarios", NULL, error);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    o.request.out = "metamorphic";
    pl_call_parse(call, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    chosen_work chosen = {.plan = &plan};
    int code = PL_EXIT_OK;
    pl_status status = choose_checks(&o, &chosen.chosen, &error);
    if (status == PL_OK) {
        status = pl_request_plan(call, &o.request, &plan, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (pl_plan_size(&plan) == 0) {
        code = pl_call_nothing(call, "there is nothing to compare");
    } else {
        const pl_study_work work = {
            .study = &pl_metamorphic_study, .user = &chosen, .run = make_runs};
        code = pl_study_command(call, &o.request, &work);
    }
    free(chosen.chosen);
    pl_plan_free(&plan);
    pl_request_free(&o.request);
    free(o.checks.items);
    return code;
}

static const pl_option OPTIONS[] = {
    {"check", "NAME",
     "One check, such as rotate-z45, or all checks of a kind: again, rotate, mirror, order, "
     "far, scale, shift, restart, split, tessellate, late (repeatable; default all)",
     PL_OPTION_TEXTS, .field = offsetof(options, checks),
     .values = "again|rotate|mirror|order|far|scale|shift|restart|split|tessellate|late"},
    {"json", NULL,
     "Write an array of an object for each scenario and engine (- is standard output)",
     .kind = PL_OPTION_HELP},
    {"out", NULL, "Where results and page go (default metamorphic)", .kind = PL_OPTION_HELP},
    {"jobs", NULL, "Runs at a time, of the checks of one plain run (default 1)",
     .kind = PL_OPTION_HELP},
    {0}};

const pl_command pl_command_metamorphic = {
    .name = "metamorphic",
    .summary = "check engines without a reference",
    .arguments = "SCENARIO|SCENE.json...",
    .description =
        "Runs a scene on an engine, and then scenes that must move in the same way: turned, "
        "mirrored, moved, scaled (length s, mass s^3, time sqrt(s)), with its bodies in another "
        "order, with a copy of everything 1e4 times its size away, a second time, with a new "
        "instance from half time on, with each static box split in two flush boxes or made a "
        "closed "
        "mesh, and with a start that lies a fraction of a step later on the same motion. A check "
        "that "
        "does not apply to a scene, or whose scene the engine does not support, says why. Prints "
        "how far each, mapped back, is from the first at a "
        "tenth "
        "of the run and at its end: bitwise; exact, to 1e-9 of the scene's size and 1e-9 rad; "
        "close, to 1e-3; differs; or failed, where a run did not reach its end. A difference is a "
        "finding; the command still exits with 0.",
    .notes = "Examples:\n"
             "  plumb metamorphic tower --set n=10\n"
             "  plumb metamorphic wall-collapse --engine plumb --check order --check far\n"
             "  plumb metamorphic ./mine.json --engine ./mine.so:fast --json - | jq .",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_comparison_options,
               pl_jobs_options, pl_out_options},
    .check = check,
    .run = run};
