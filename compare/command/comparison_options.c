#include "comparison_options.h"

#include <stdlib.h>
#include <string.h>

enum { KEY_SUITE = 0x300, KEY_ENGINE, KEY_JSON, KEY_JOBS, KEY_OUT, KEY_RESUME };

pl_comparison pl_comparison_default(const pl_comparison_help *help)
{
    return (pl_comparison){.help = help,
                           .selection = pl_selection_default(),
                           .limits = pl_limits_default(),
                           .jobs = 1};
}

void pl_comparison_free(pl_comparison *comparison)
{
    pl_selection_free(&comparison->selection);
    free(comparison->names.items);
    free(comparison->suites.items);
    free(comparison->engines.items);
    *comparison = pl_comparison_default(comparison->help);
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    pl_comparison *comparison = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &comparison->selection;
        state->child_inputs[1] = &comparison->limits;
        return 0;
    case KEY_SUITE:
        pl_texts_add(&comparison->suites, text);
        return 0;
    case KEY_ENGINE:
        pl_texts_add(&comparison->engines, text);
        return 0;
    case KEY_JSON:
        comparison->json = text;
        return 0;
    case ARGP_KEY_ARG:
        if (comparison->help->reader != NULL && strcmp(text, "-") == 0) {
            argp_error(state,
                       "standard input can be read once, and %s reads its scene: give a file",
                       comparison->help->reader);
        }
        pl_texts_add(&comparison->names, text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse_jobs(int key, char *text, struct argp_state *state)
{
    pl_comparison *comparison = state->input;
    if (key != KEY_JOBS) {
        return ARGP_ERR_UNKNOWN;
    }
    comparison->jobs = (int)pl_option_integer(state, "--jobs takes an integer", text, 1, 1024);
    return 0;
}

static error_t parse_out(int key, char *text, struct argp_state *state)
{
    pl_comparison *comparison = state->input;
    switch (key) {
    case KEY_OUT:
        comparison->out = text;
        return 0;
    case KEY_RESUME:
        comparison->resume = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* The command's own words where it has some; argp frees what is not the text itself. */
static char *filter_help(int key, const char *text, void *input)
{
    const pl_comparison *comparison = input;
    const char *own = NULL;
    switch (key) {
    case KEY_SUITE:
        own = comparison->help->suite;
        break;
    case KEY_JSON:
        own = comparison->help->json;
        break;
    case KEY_JOBS:
        own = comparison->help->jobs;
        break;
    case KEY_OUT:
        own = comparison->help->out;
        break;
    default:
        break;
    }
    char *made = own == NULL ? NULL : strdup(own);
    return made == NULL ? (char *)text : made;
}

static const struct argp_option contest_options[] = {
    {"suite", KEY_SUITE, "NAME", 0, "All scenarios of a suite (repeatable)", 0},
    {"engine", KEY_ENGINE, "SPEC", 0,
     "An engine: NAME[:PROFILE][,OPTION=VALUE...], or the path of a shared object in place of NAME "
     "(repeatable; default all found)",
     0},
    {"json", KEY_JSON, "FILE", 0, "Write JSON too (- is standard output)", 0},
    {0}};

static const struct argp_option jobs_options[] = {
    {"jobs", KEY_JOBS, "N", 0, "Runs at a time (default 1)", 0}, {0}};

static const struct argp_option out_options[] = {
    {"out", KEY_OUT, "DIR", 0, "Where results go", 0},
    {"resume", KEY_RESUME, NULL, 0,
     "Keep the results in DIR and make only the runs that are missing, whatever the outcome of "
     "those there",
     0},
    {0}};

const struct argp pl_comparison_argp = {.options = contest_options,
                                        .parser = parse,
                                        .children = pl_run_children,
                                        .help_filter = filter_help};

const struct argp pl_comparison_jobs_argp = {
    .options = jobs_options, .parser = parse_jobs, .help_filter = filter_help};

const struct argp pl_comparison_out_argp = {
    .options = out_options, .parser = parse_out, .help_filter = filter_help};

const struct argp_child pl_comparison_children[] = {{&pl_comparison_argp, 0, NULL, 0},
                                                    {&pl_comparison_jobs_argp, 0, NULL, 0},
                                                    {&pl_comparison_out_argp, 0, NULL, 0},
                                                    {0}};

void pl_comparison_init(pl_comparison *comparison, const struct argp_state *state)
{
    const struct argp_child *children = state->root_argp->children;
    for (int i = 0; children[i].argp != NULL; ++i) {
        state->child_inputs[i] = comparison;
    }
}
