/* plumb metamorphic: checks of engines that need no reference. */
#include "studies/metamorphic/metamorphic.h"
#include "study_command.h"

#include <stdlib.h>

typedef struct options {
    pl_request request;
    pl_texts checks;
    bool *chosen; /* of pl_checks */
} options;

static pl_status make_plan(void *user, const pl_call *call, pl_plan *plan, pl_error *error)
{
    options *o = user;
    const pl_status status = pl_checks_choose(o->checks.items, o->checks.count, &o->chosen, error);
    return status == PL_OK ? pl_request_plan(call, &o->request, plan, error) : status;
}

static pl_status make_runs(void *user, pl_execution_def *how, int *signal_number, pl_error *error)
{
    const options *o = user;
    return pl_metamorphic_run(o->chosen, how, signal_number, error);
}

static pl_status check(void *user, pl_error *error)
{
    return pl_request_check(user, "which scenario? See plumb list scenarios", NULL, error);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    const int code = pl_study_main(call, &(pl_study_work){.study = &pl_metamorphic_study,
                                                          .options = &o,
                                                          .plan = make_plan,
                                                          .run = make_runs});
    free(o.chosen);
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
        "closed mesh, and with a start that lies a fraction of a step later on the same motion. A "
        "check that does not apply to a scene, or whose scene the engine does not support, says "
        "why. Prints how far each, mapped back, is from the first at a tenth of the run and at its "
        "end: bitwise; exact, to 1e-9 of the scene's size and 1e-9 rad; close, to 1e-3; differs; "
        "or failed, where a run did not reach its end. A difference is a finding; the command "
        "still exits with 0.",
    .notes = "Examples:\n"
             "  plumb metamorphic tower --set n=10\n"
             "  plumb metamorphic wall-collapse --engine plumb --check order --check far\n"
             "  plumb metamorphic ./mine.json --engine ./mine.so:fast --json - | jq .",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_comparison_options,
               pl_jobs_options, pl_out_options},
    .check = check,
    .run = run};
