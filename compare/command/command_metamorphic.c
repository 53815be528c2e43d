/* plumb metamorphic: checks of engines that need no reference. Each trial is printed as it ends. */
#include "request.h"
#include "results/store.h"
#include "studies/metamorphic/metamorphic.h"

#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_request request;
    pl_texts checks;
} options;

typedef struct delivery {
    const options *options;
    json_t *trials;
    bool compared; /* a plain run was not unsupported */
} delivery;

static pl_status keep(void *user, const pl_checks_of_run *trial, pl_error *error)
{
    delivery *d = user;
    d->compared = d->compared || strcmp(trial->outcome, "unsupported") != 0;
    if (!pl_is_stdout(d->options->request.json)) {
        pl_checks_print(stdout, trial);
    }
    if (json_array_append_new(d->trials, pl_checks_to_json(trial)) != 0) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for what was found");
    }
    return PL_OK;
}

/* The caller frees *chosen. */
static pl_status choose_checks(const options *o, bool **chosen, pl_error *error)
{
    int count;
    (void)pl_checks(&count);
    *chosen = calloc((size_t)count, sizeof **chosen);
    if (*chosen == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    for (int i = 0; i < count; ++i) {
        (*chosen)[i] = o->checks.count == 0;
    }
    pl_status status = PL_OK;
    for (int i = 0; i < o->checks.count && status == PL_OK; ++i) {
        status = pl_check_choose(o->checks.items[i], *chosen, error);
    }
    return status;
}

static int execute(const pl_call *call, const options *o, const pl_plan *plan, const bool *chosen)
{
    pl_error error = {.message = ""};
    int signal_number = 0;
    int code = PL_EXIT_OK;
    pl_journal *journal = NULL;
    delivery d = {.options = o, .trials = json_array()};
    json_t *provenance = pl_call_provenance(call, &error);
    pl_status status = provenance == NULL || d.trials == NULL
                           ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                           : pl_request_journal(call, &o->request, &journal, &error);
    if (status == PL_OK) {
        const pl_metamorphic_def def = {.plan = plan,
                                        .chosen = chosen,
                                        .limits = o->request.limits,
                                        .provenance = provenance,
                                        .journal = journal,
                                        .progress = stderr,
                                        .user = &d,
                                        .keep = keep};
        status = pl_run_checks(&def, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        code = d.compared ? PL_EXIT_OK : PL_EXIT_NOTHING;
        status = pl_results_write_json(o->request.json, d.trials, &error);
    }
    json_decref(d.trials);
    json_decref(provenance);
    return pl_call_end_study(call, journal, status, &error, signal_number, code);
}

static pl_status check(void *user, pl_error *error)
{
    return pl_request_check(user, "which scenario? See plumb list scenarios", NULL, error);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    pl_call_parse(call, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    bool *chosen = NULL;
    int code = PL_EXIT_OK;
    pl_status status = choose_checks(&o, &chosen, &error);
    if (status == PL_OK) {
        status = pl_request_plan(call, &o.request, &plan, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (pl_plan_size(&plan) == 0) {
        code = pl_call_nothing(call, "there is nothing to compare");
    } else {
        code = execute(call, &o, &plan, chosen);
    }
    free(chosen);
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
               pl_study_options},
    .check = check,
    .run = run};
