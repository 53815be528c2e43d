/* plumb check-engine: conformance of engines and their adapters to the engine ABI. */
#include "base/folding.h"
#include "base/hash.h"
#include "base/table.h"
#include "conformance/conformance.h"
#include "request.h"
#include "results/result.h"
#include "results/store.h"

#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_request request; /* names: SPECs */
    pl_texts checks;    /* --check: those alone; empty: all */
    bool all_profiles, list, quiet;
} options;

/* The command at work. */
typedef struct checking {
    const pl_call *call;
    const options *options;
    bool shows;   /* text on standard output */
    bool failed;  /* some check of some engine */
    bool headed;  /* the line that names the engine in work is printed */
    json_t *list; /* an item for each engine that was checked */
} checking;

static bool is_among(const pl_texts *names, const char *name)
{
    for (int i = 0; i < names->count; ++i) {
        if (strcmp(names->items[i], name) == 0) {
            return true;
        }
    }
    return false;
}

static pl_status check_names(const options *o, pl_error *error)
{
    pl_texts known = {.items = NULL};
    const pl_check *check;
    for (int i = 0; (check = pl_conformance_check(i)) != NULL; ++i) {
        pl_texts_add(&known, check->name);
    }
    for (int i = 0; i < o->checks.count; ++i) {
        const char *name = o->checks.items[i];
        if (!is_among(&known, name)) {
            char hint[PL_SUGGESTION_SIZE];
            return pl_fail(error, PL_BAD_INPUT, "there is no check \"%s\"%s", name,
                           pl_did_you_mean(name, known.items, known.count, hint));
        }
    }
    free(known.items);
    return PL_OK;
}

static pl_status check(void *user, pl_error *error)
{
    const options *o = user;
    if (o->request.names.count == 0 && !o->list) {
        return pl_fail(error, PL_BAD_INPUT,
                       "which engine? Its name, such as ode:quick, or a shared object, such as "
                       "./mine.so");
    }
    return check_names(o, error);
}

static void print_list(void)
{
    pl_table table = {0};
    const pl_check *check;
    pl_table_columns(&table, "check|what must hold");
    for (int i = 0; (check = pl_conformance_check(i)) != NULL; ++i) {
        pl_table_add(&table, check->name);
        pl_table_add(&table, check->title);
    }
    pl_table_print(&table, stdout);
    pl_table_free(&table);
}

/* The words for each outcome, in a file and in a list. */
static const struct {
    const char *name, *mark;
} outcomes[] = {[PL_CHECK_PASSED] = {"passed", "ok"},
                [PL_CHECK_FAILED] = {"failed", "FAIL"},
                [PL_CHECK_SKIPPED] = {"skipped", "skip"}};

/* The texts of a result by their names. */
static const struct {
    const char *name;
    size_t offset;
} texts[] = {{"expected", offsetof(pl_check_result, expected)},
             {"found", offsetof(pl_check_result, found)},
             {"likely", offsetof(pl_check_result, cause)}};
enum { TEXT_COUNT = sizeof texts / sizeof *texts };

static const char *text_of(const pl_check_result *result, int index)
{
    return (const char *)result + texts[index].offset;
}

static void print_result(const pl_check_result *result)
{
    pl_folding folding;
    FILE *out = pl_folding_begin(&folding, stdout);
    fprintf(out, "  %-4s  %-22s  %s\n", outcomes[result->outcome].mark, result->check->name,
            result->outcome == PL_CHECK_SKIPPED ? result->found : result->check->title);
    for (int i = 0; result->outcome == PL_CHECK_FAILED && i < TEXT_COUNT; ++i) {
        if (text_of(result, i)[0] != '\0') {
            fprintf(out, "        %-8s  %s\n", texts[i].name, text_of(result, i));
        }
    }
    pl_folding_end(&folding);
}

static json_t *result_json(const pl_check_result *result)
{
    json_t *object = json_pack("{s:s, s:s, s:s}", "check", result->check->name, "title",
                               result->check->title, "outcome", outcomes[result->outcome].name);
    for (int i = 0; i < TEXT_COUNT; ++i) {
        if (text_of(result, i)[0] != '\0') {
            json_object_set_new(object, texts[i].name, pl_json_text(text_of(result, i)));
        }
    }
    return object;
}

static void take_result(checking *c, const pl_engine_choice *choice, const pl_check_result *result,
                        json_t *results)
{
    json_array_append_new(results, result_json(result));
    if (!c->shows || (c->options->quiet && result->outcome != PL_CHECK_FAILED)) {
        return;
    }
    if (!c->headed) {
        char label[PL_LABEL_SIZE];
        pl_engine_choice_label(choice, label);
        printf("%s %s\n", label, choice->engine->version);
        c->headed = true;
    }
    print_result(result);
}

/* Makes the checks that were asked for; counts[outcome] is how many had each outcome. */
static void run_checks(checking *c, const pl_engine_choice *choice, json_t *results, int counts[3])
{
    static const pl_check load = {.name = "load", .title = "the engine can be loaded and asked"};
    pl_error *error = c->call->error;
    const pl_check *check;
    if (choice->engine->fault.is_fault) {
        pl_check_result result = {
            .check = &load, .outcome = PL_CHECK_FAILED, .expected = "the engine describes itself"};
        snprintf(result.found, sizeof result.found, "%.*s", (int)sizeof result.found - 1,
                 choice->engine->fault.reason);
        counts[PL_CHECK_FAILED] = 1;
        take_result(c, choice, &result, results);
        return;
    }
    for (int i = 0; (check = pl_conformance_check(i)) != NULL; ++i) {
        pl_check_result result;
        if (c->options->checks.count == 0 || is_among(&c->options->checks, check->name)) {
            const pl_limits *limits = &c->options->request.limits;
            pl_call_need(c->call, pl_conformance_run(check, choice, limits, &result, error));
            counts[result.outcome] += 1;
            take_result(c, choice, &result, results);
        }
    }
}

/* Keeps what was found for the reports, when all checks were made with the profile's own values. A
 * record that cannot be written fails nothing. */
static void keep_record(const checking *c, const pl_engine_choice *choice, const int counts[3])
{
    const pl_engine_info *engine = choice->engine;
    pl_error error = {.message = ""};
    if (c->options->checks.count == 0 && !engine->fault.is_fault &&
        memcmp(choice->values, pl_engine_profile_values(engine, choice->profile),
               (size_t)engine->option_count * sizeof *choice->values) == 0 &&
        pl_conformance_record_write(engine, engine->profiles[choice->profile].name,
                                    counts[PL_CHECK_PASSED] + counts[PL_CHECK_FAILED],
                                    counts[PL_CHECK_FAILED], counts[PL_CHECK_SKIPPED],
                                    &error) != PL_OK) {
        pl_print_line(stderr, "%s: warning: reports will not know of this: %s", c->call->argv[0],
                      error.message);
    }
}

/* Checks one configuration and adds the result to the list. */
static void check_choice(checking *c, const pl_engine_choice *choice)
{
    char label[PL_LABEL_SIZE];
    int counts[3] = {0};
    json_t *results = json_array();
    pl_engine_choice_label(choice, label);
    c->headed = false;
    run_checks(c, choice, results, counts);
    const char *verdict = counts[PL_CHECK_FAILED] > 0 ? "failed" : "passed";
    if (c->shows) {
        pl_folding folding;
        fprintf(pl_folding_begin(&folding, stdout),
                "%s: conformance %s: %d passed, %d failed, %d skipped\n", label, verdict,
                counts[PL_CHECK_PASSED], counts[PL_CHECK_FAILED], counts[PL_CHECK_SKIPPED]);
        pl_folding_end(&folding);
    }
    keep_record(c, choice, counts);
    c->failed = c->failed || counts[PL_CHECK_FAILED] > 0;
    json_array_append_new(
        c->list, json_pack("{s:o, s:o, s:s, s:s, s:o}", "label", pl_json_text(label),
                           "engine_version", pl_json_text(choice->engine->version), "engine_binary",
                           choice->engine->binary, "outcome", verdict, "checks", results));
}

/* The engine that a SPEC chooses. Ends the program if there is none, or --all-profiles does not take it. */
static pl_engine_choice choose(const checking *c, const char *spec)
{
    pl_engine_choice choice;
    pl_error *error = c->call->error;
    const char *slash = strrchr(spec, '/');
    pl_call_need(c->call, pl_engine_choose(spec, &choice, error));
    if (c->options->all_profiles && strpbrk(slash == NULL ? spec : slash, ":,") != NULL) {
        pl_fail(error, PL_BAD_INPUT,
                "--all-profiles takes an engine without a profile or options; found \"%s\"", spec);
        pl_call_need(c->call, PL_BAD_INPUT);
    }
    return choice;
}

static void check_engine(checking *c, pl_engine_choice choice)
{
    if (!c->options->all_profiles || choice.engine->fault.is_fault) {
        check_choice(c, &choice);
        return;
    }
    for (int i = 0; i < choice.engine->profile_count; ++i) {
        choice.profile = i;
        memcpy(choice.values, pl_engine_profile_values(choice.engine, i),
               (size_t)choice.engine->option_count * sizeof *choice.values);
        check_choice(c, &choice);
    }
}

/* All engines, after every SPEC was found to be one. */
static void check_engines(checking *c)
{
    const pl_request *request = &c->options->request;
    pl_error *error = c->call->error;
    pl_call_need(c->call, pl_request_outputs(request, NULL, error));
    for (int i = 0; i < request->names.count; ++i) {
        choose(c, request->names.items[i]);
    }
    for (int i = 0; i < request->names.count; ++i) {
        check_engine(c, choose(c, request->names.items[i]));
    }
    if (request->json != NULL) {
        json_t *document =
            json_pack("{s:s, s:O}", "schema", "plumb.conformance/1", "engines", c->list);
        pl_call_need(c->call, pl_results_write_json(request->json, document, error));
        json_decref(document);
    }
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    o.request.limits.timeout = 20;
    pl_call_parse(call, &o);
    checking c = {.call = call,
                  .options = &o,
                  .shows = o.request.json == NULL || strcmp(o.request.json, "-") != 0,
                  .list = json_array()};
    if (o.list) {
        print_list();
    } else {
        check_engines(&c);
    }
    json_decref(c.list);
    free(o.checks.items);
    pl_request_free(&o.request);
    return c.failed ? PL_EXIT_GATE : PL_EXIT_OK;
}

static const pl_option OPTIONS[] = {
    {"check", "NAME", "Run this check alone (repeatable)", PL_OPTION_TEXTS,
     .field = offsetof(options, checks), .letter = 'c', .values = "CHECK"},
    {"all-profiles", NULL, "Check every profile of each engine, rather than the first",
     PL_OPTION_FLAG, .field = offsetof(options, all_profiles), .letter = 'a'},
    {"quiet", NULL, "Print failures and verdicts only", PL_OPTION_FLAG,
     .field = offsetof(options, quiet), .letter = 'q'},
    {"timeout", NULL, "Longest wall time of a check in seconds (default 20)",
     .kind = PL_OPTION_HELP},
    {"memory", NULL, "Largest memory of a check in GiB (default 8; 0: no limit)",
     .kind = PL_OPTION_HELP},
    {"list", NULL, "List the checks, and make none", PL_OPTION_FLAG,
     .field = offsetof(options, list), .letter = 'l'},
    {"json", "FILE", "Write the results as JSON (- is standard output)", PL_OPTION_TEXT,
     .field = offsetof(options, request) + offsetof(pl_request, json), .letter = 'j'},
    {0}};

const pl_command pl_command_check_engine = {
    .name = "check-engine",
    .summary = "check an engine and its adapter against the engine ABI",
    .arguments = "SPEC...",
    .description =
        "Runs small scenes that each catch one kind of mistake of an engine or its adapter: units, "
        "frames, signs, order, masses, friction, restitution, contacts. Each failure says what was "
        "expected, what was found, and what usually causes it.",
    .notes =
        "What was found is kept for each binary and profile, and reports show it, when all checks "
        "were made with the profile's own options.\n"
        "\n"
        "Exit codes: 0 every check passed or was skipped; 1 a check failed; 2 usage or a SPEC "
        "that is none; 3 a check could not be run, or I/O failed.\n"
        "\n"
        "Examples:\n"
        "  plumb check-engine ode:quick\n"
        "  plumb check-engine plumb bullet --all-profiles --json conformance.json\n"
        "  plumb check-engine --list",
    .options = OPTIONS,
    .shared = {pl_limit_options, pl_force_options},
    .check = check,
    .run = run};
