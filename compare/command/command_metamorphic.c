/* plumb metamorphic: checks of engines that need no reference. Each trial is printed as it ends. */
#include "commands.h"
#include "comparison.h"
#include "results/store.h"
#include "studies/metamorphic/metamorphic.h"

#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_comparison comparison;
    pl_texts checks;
} options;

static const pl_comparison_help option_help = {
    .json = "Write what was found as a JSON array too (- is standard output, in place of the "
            "tables)"};

enum { KEY_CHECK = 0x200 };

static const struct argp_option argp_options[] = {
    {"check", KEY_CHECK, "NAME", 0,
     "One check, such as rotate-z45, or all of a kind: again, rotate, mirror, order, far, scale, "
     "shift, restart (repeatable; default all)",
     0},
    {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        pl_comparison_init(&o->comparison, state);
        return 0;
    case KEY_CHECK:
        pl_texts_add(&o->checks, text);
        return 0;
    case ARGP_KEY_END:
        if (o->comparison.names.count == 0 && o->comparison.suites.count == 0) {
            argp_error(state, "which scenario? See plumb list scenarios");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&pl_comparison_argp, 0, NULL, 0}, {0}};

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "SCENARIO|SCENE.json...",
    .doc =
        "Runs a scene on an engine, and then scenes that must move alike: turned, mirrored, moved, "
        "scaled (length s, mass s^3, time sqrt(s)), with its bodies in another order, with a copy "
        "of everything 1e4 times its size away, once more, and with a new instance from half time "
        "on. Prints how far each, mapped back, is from the first at a tenth of the run and at its "
        "end: bitwise; exact, to 1e-9 of the scene's size and 1e-9 rad; close, to 1e-3; differs; "
        "or failed, where a run did not come to its end. A difference is a finding: it exits "
        "with 0.\v"
        "Examples:\n"
        "  plumb metamorphic tower --set n=10\n"
        "  plumb metamorphic wall-collapse --engine plumb --check order --check far\n"
        "  plumb metamorphic ./mine.json --engine ./mine.so:fast --json - | jq .",
    .children = children};

typedef struct delivery {
    const options *options;
    json_t *trials;
    bool compared; /* a plain run was not unsupported */
} delivery;

static bool json_on_stdout(const options *o)
{
    return o->comparison.json != NULL && strcmp(o->comparison.json, "-") == 0;
}

static pl_status keep(void *user, const pl_checks_of_run *trial, pl_error *error)
{
    delivery *d = user;
    d->compared = d->compared || strcmp(trial->outcome, "unsupported") != 0;
    if (!json_on_stdout(d->options)) {
        pl_checks_print(stdout, trial);
        fflush(stdout);
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

static int run(const pl_call *call, const options *o, const pl_plan *plan, const bool *chosen)
{
    pl_error error = {.message = ""};
    int signal_number = 0;
    int code = PL_EXIT_OK;
    delivery d = {.options = o, .trials = json_array()};
    json_t *provenance = pl_provenance(call->program_argc, call->program_argv);
    pl_status status = provenance == NULL || d.trials == NULL
                           ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                           : PL_OK;
    if (status == PL_OK) {
        const pl_metamorphic_def def = {.plan = plan,
                                        .chosen = chosen,
                                        .limits = o->comparison.limits,
                                        .provenance = provenance,
                                        .progress = stderr,
                                        .user = &d,
                                        .keep = keep};
        status = pl_run_checks(&def, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        code = d.compared ? PL_EXIT_OK : PL_EXIT_NOTHING;
        status = o->comparison.json == NULL
                     ? PL_OK
                     : pl_results_write_json(o->comparison.json, d.trials, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (signal_number != 0) {
        code = 128 + signal_number;
    }
    json_decref(d.trials);
    json_decref(provenance);
    return code;
}

int pl_command_metamorphic(const pl_call *call)
{
    options o = {.comparison = pl_comparison_default(&option_help)};
    pl_call_parse(call, &argp, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    bool *chosen = NULL;
    int code = PL_EXIT_OK;
    pl_status status = choose_checks(&o, &chosen, &error);
    if (status == PL_OK) {
        status = pl_comparison_add_problems(&o.comparison, &plan, &error);
    }
    if (status == PL_OK) {
        status = pl_comparison_add_engines(call->argv[0], &o.comparison, &plan, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (pl_plan_size(&plan) == 0) {
        fprintf(stderr, "plumb metamorphic: there is nothing to compare\n");
        code = PL_EXIT_NOTHING;
    } else {
        code = run(call, &o, &plan, chosen);
    }
    free(chosen);
    pl_plan_free(&plan);
    pl_comparison_free(&o.comparison);
    free(o.checks.items);
    return code;
}
