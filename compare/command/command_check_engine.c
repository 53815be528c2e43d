/* plumb check-engine: conformance of engines and their adapters to the engine ABI. */
#include "conformance/conformance.h"
#include "request.h"
#include "results/store.h"

#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_request request; /* names: SPECs */
    pl_texts checks;    /* --check: those alone; empty: all */
    bool list;
} options;

static pl_status check_names(const options *o, pl_error *error)
{
    for (int i = 0; i < o->checks.count; ++i) {
        const char *names[256];
        int count = 0;
        bool is_known = false;
        for (; count < pl_conformance_count() && count < 256; ++count) {
            names[count] = pl_conformance_name(count);
            is_known = is_known || strcmp(names[count], o->checks.items[i]) == 0;
        }
        if (!is_known) {
            char hint[PL_SUGGESTION_SIZE];
            return pl_fail(error, PL_BAD_INPUT, "there is no check \"%s\"%s", o->checks.items[i],
                           pl_did_you_mean(o->checks.items[i], names, count, hint));
        }
    }
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

static bool is_asked(const options *o, int index)
{
    bool asked = o->checks.count == 0;
    for (int i = 0; i < o->checks.count; ++i) {
        asked = asked || strcmp(o->checks.items[i], pl_conformance_name(index)) == 0;
    }
    return asked;
}

static void print_list(void)
{
    for (int i = 0; i < pl_conformance_count(); ++i) {
        printf("%-24s %s\n", pl_conformance_name(i), pl_conformance_title(i));
    }
}

static const char *const outcome_names[] = {
    [PL_CHECK_PASSED] = "passed", [PL_CHECK_FAILED] = "failed", [PL_CHECK_SKIPPED] = "skipped"};

static void print_result(const pl_check_result *result)
{
    static const char *const marks[] = {
        [PL_CHECK_PASSED] = "ok", [PL_CHECK_FAILED] = "FAIL", [PL_CHECK_SKIPPED] = "skip"};
    printf("  %-4s  %-24s %s\n", marks[result->outcome], result->name,
           result->outcome == PL_CHECK_SKIPPED ? result->found : result->title);
    if (result->outcome == PL_CHECK_FAILED) {
        printf("        expected  %s\n        found     %s\n", result->expected, result->found);
        if (result->cause[0] != '\0') {
            printf("        likely    %s\n", result->cause);
        }
    }
    fflush(stdout);
}

static json_t *result_json(const pl_check_result *result)
{
    json_t *object = json_pack("{s:s, s:s, s:s}", "check", result->name, "title", result->title,
                               "outcome", outcome_names[result->outcome]);
    const struct {
        const char *key, *text;
    } texts[] = {
        {"expected", result->expected}, {"found", result->found}, {"likely", result->cause}};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i) {
        if (texts[i].text[0] != '\0') {
            json_object_set_new(object, texts[i].key,
                                pl_json_text(texts[i].text, strlen(texts[i].text)));
        }
    }
    return object;
}

/* Checks one configuration. *failed is set when a check failed; the result is added to `report`. */
static pl_status check_engine(const options *o, const char *spec, bool *failed, json_t *report,
                              pl_error *error)
{
    pl_engine_choice choice;
    char label[PL_LABEL_SIZE];
    int counts[3] = {0};
    pl_status status = pl_engine_choose(spec, &choice, error);
    if (status != PL_OK) {
        return status;
    }
    const bool shows = o->request.json == NULL || strcmp(o->request.json, "-") != 0;
    json_t *list = json_array();
    pl_engine_choice_label(&choice, label);
    if (shows) {
        printf("%s %s\n", label, choice.engine->version);
    }
    if (choice.engine->fault.is_fault) {
        counts[PL_CHECK_FAILED] += 1;
        pl_check_result result = {.name = "load",
                                  .title = "the engine can be loaded and asked",
                                  .outcome = PL_CHECK_FAILED,
                                  .expected = "the engine describes itself"};
        snprintf(result.found, sizeof result.found, "%.*s", (int)sizeof result.found - 1,
                 choice.engine->fault.reason);
        json_array_append_new(list, result_json(&result));
        if (shows) {
            print_result(&result);
        }
    }
    for (int i = 0; i < pl_conformance_count() && !choice.engine->fault.is_fault; ++i) {
        pl_check_result result;
        if (!is_asked(o, i)) {
            continue;
        }
        status = pl_conformance_run(i, &choice, &o->request.limits, &result, error);
        if (status != PL_OK) {
            json_decref(list);
            return status;
        }
        counts[result.outcome] += 1;
        json_array_append_new(list, result_json(&result));
        if (shows) {
            print_result(&result);
        }
    }
    const char *verdict = counts[PL_CHECK_FAILED] > 0 ? "failed" : "passed";
    if (shows) {
        printf("%s: conformance %s: %d of %d checks passed, %d failed, %d skipped\n", label,
               verdict, counts[PL_CHECK_PASSED], counts[0] + counts[1] + counts[2],
               counts[PL_CHECK_FAILED], counts[PL_CHECK_SKIPPED]);
    }
    *failed = *failed || counts[PL_CHECK_FAILED] > 0;
    json_array_append_new(
        report,
        json_pack("{s:o, s:o, s:s, s:s, s:o}", "label", pl_json_text(label, strlen(label)),
                  "engine_version",
                  pl_json_text(choice.engine->version, strlen(choice.engine->version)),
                  "engine_binary", choice.engine->binary, "outcome", verdict, "checks", list));
    return PL_OK;
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    pl_error error = {.message = ""};
    bool failed = false;
    pl_call_parse(call, &o);
    if (o.list) {
        print_list();
    }
    json_t *report = json_array();
    pl_status status = PL_OK;
    pl_engine_describe_within(&o.request.limits);
    for (int i = 0; i < o.request.names.count && status == PL_OK; ++i) {
        status = check_engine(&o, o.request.names.items[i], &failed, report, &error);
    }
    if (status == PL_OK && o.request.json != NULL) {
        json_t *document =
            json_pack("{s:s, s:O}", "schema", "plumb.conformance/1", "engines", report);
        status = pl_results_write_json(o.request.json, document, &error);
        json_decref(document);
    }
    json_decref(report);
    free(o.checks.items);
    pl_request_free(&o.request);
    return pl_call_end(call, status, &error, 0, failed ? PL_EXIT_GATE : PL_EXIT_OK);
}

static const pl_option OPTIONS[] = {
    {"check", "NAME", "Run this check alone (repeatable)", PL_OPTION_TEXTS,
     .field = offsetof(options, checks), .letter = 'c'},
    {"list", NULL, "List the checks", PL_OPTION_FLAG, .field = offsetof(options, list),
     .letter = 'l'},
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
    .notes = "Exit codes: 0 every check passed or was skipped; 1 a check failed.\n"
             "\n"
             "Examples:\n"
             "  plumb check-engine ode:quick\n"
             "  plumb check-engine plumb bullet --json conformance.json\n"
             "  plumb check-engine --list",
    .options = OPTIONS,
    .shared = {pl_limit_options},
    .check = check,
    .run = run};
