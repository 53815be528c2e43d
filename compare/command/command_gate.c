/* plumb gate: results against a baseline and against rules; the exit code is the verdict. */
#include "base/folding.h"
#include "base/heap.h"
#include "gate/baseline.h"
#include "gate/gather.h"
#include "gate/judge.h"
#include "gate/ratio.h"
#include "request.h"
#include "results/store.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_request request; /* names: the results; out */
    pl_texts rules;
    const char *baseline, *reference;
    bool update;
    pl_gate_tolerances tolerances;
    pl_gate_format format;
} options;

static pl_status parse_tolerance(void *user, const char *text, pl_error *error)
{
    options *o = user;
    return pl_gate_tolerances_parse(text, &o->tolerances, error);
}

static pl_status parse_format(void *user, const char *text, pl_error *error)
{
    options *o = user;
    for (int i = 0; i < PL_GATE_FORMAT_COUNT; ++i) {
        if (strcmp(text, pl_gate_format_names[i]) == 0) {
            o->format = (pl_gate_format)i;
            return PL_OK;
        }
    }
    return pl_fail(error, PL_BAD_INPUT, "--format takes text, junit, github or json; found \"%s\"",
                   text);
}

static pl_status check(void *user, pl_error *error)
{
    const options *o = user;
    const char *wrong =
        o->request.names.count == 0
            ? "which results? plumb gate report/results.jsonl --baseline FILE"
        : o->update && o->baseline == NULL ? "--update-baseline needs --baseline FILE"
        : o->update && o->rules.count > 0  ? "--update-baseline judges nothing: leave --fail-if out"
        : o->baseline == NULL && o->rules.count == 0
            ? "against what? --baseline FILE or --fail-if EXPR"
            : NULL;
    return wrong == NULL ? PL_OK : pl_fail(error, PL_BAD_INPUT, "%s", wrong);
}

/* What was read and made; all is freed at the end. */
typedef struct material {
    pl_result_file *files;
    int file_count;
    pl_result_table results;
    pl_gate_rows before, now;
    pl_gate_rule *rules;
    pl_gate_verdict verdict;
} material;

static void free_material(material *m)
{
    pl_gate_verdict_free(&m->verdict);
    pl_gate_rows_free(&m->before);
    pl_gate_rows_free(&m->now);
    pl_result_table_free(&m->results);
    for (int i = 0; i < m->file_count; ++i) {
        json_decref((json_t *)m->files[i].results);
    }
    free(m->files);
    free(m->rules);
}

static pl_status read_rules(const options *o, material *m, pl_error *error)
{
    pl_status status = PL_OK;
    m->rules = pl_heap_new((size_t)o->rules.count, sizeof *m->rules);
    for (int i = 0; i < o->rules.count && status == PL_OK; ++i) {
        pl_gate_rule *rule = &m->rules[i];
        status = pl_gate_rule_parse(o->rules.items[i], rule, error);
        if (status == PL_OK && rule->is_relative && o->baseline == NULL) {
            status = pl_fail(error, PL_BAD_INPUT,
                             "--fail-if \"%.120s\": column %d: a relative rule needs --baseline",
                             rule->text, rule->value_column);
        }
    }
    return status;
}

static pl_status check_reference(const options *o, const pl_gate_rows *rows, pl_error *error)
{
    if (o->reference == NULL) {
        return PL_OK;
    }
    const char **labels = pl_heap_new((size_t)rows->count, sizeof *labels);
    bool found = false;
    for (int i = 0; i < rows->count; ++i) {
        labels[i] = rows->items[i].label;
        found |= strcmp(labels[i], o->reference) == 0;
    }
    char hint[PL_SUGGESTION_SIZE];
    pl_status status =
        found ? PL_OK
              : pl_fail(error, PL_BAD_INPUT,
                        "--reference %.100s: the results have no run of that engine%s",
                        o->reference, pl_did_you_mean(o->reference, labels, rows->count, hint));
    free(labels);
    return status;
}

static pl_status read_all(const options *o, material *m, pl_error *error)
{
    pl_status status = read_rules(o, m, error);
    m->files = pl_heap_new((size_t)o->request.names.count, sizeof *m->files);
    for (int i = 0; i < o->request.names.count && status == PL_OK; ++i) {
        json_t *results = NULL;
        status = pl_gate_read(o->request.names.items[i], &results, error);
        m->files[m->file_count++] =
            (pl_result_file){.path = o->request.names.items[i], .results = results};
    }
    if (status == PL_OK) {
        const pl_result_table_def def = {.files = m->files, .file_count = m->file_count};
        status = pl_result_table_build(&def, &m->results, error);
    }
    if (status == PL_OK) {
        pl_result_table_print_left_out(&m->results, stderr);
        pl_gate_gather(&m->results, &o->tolerances, &m->now);
    }
    if (status == PL_OK && m->now.count > 0) {
        status = check_reference(o, &m->now, error);
    }
    if (status == PL_OK && !o->update && o->baseline != NULL) {
        status = pl_gate_baseline_read(o->baseline, &m->before, error);
    }
    if (status == PL_OK) {
        pl_gate_rows_disambiguate(&m->now, &m->before);
    }
    return status;
}

static pl_status update(const options *o, material *m, pl_error *error)
{
    pl_gate_ratios_add(&m->now, o->reference);
    pl_status status = pl_gate_baseline_write(o->baseline, &m->now, error);
    if (status == PL_OK) {
        pl_print_line(stderr, "%d row%s written to %s", m->now.count, m->now.count == 1 ? "" : "s",
                      o->baseline);
    }
    return status;
}

/* The page of a GitHub job: other steps of it write the same file. */
static pl_status append_page(const pl_gate_verdict *verdict, const char *path, pl_error *error)
{
    pl_text_buffer page = {0};
    pl_gate_write_markdown(verdict, &page);
    char *text = pl_text_take(&page);
    FILE *file = fopen(path, "ae");
    bool written = file != NULL && fputs(text, file) >= 0;
    written = file != NULL && fclose(file) == 0 && written;
    free(text);
    return written ? PL_OK : pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
}

static pl_status write_format(pl_gate_format format, const pl_gate_verdict *verdict,
                              const char *path, pl_error *error)
{
    pl_text_buffer buffer = {0};
    pl_gate_write(format, verdict, &buffer);
    if (format != PL_GATE_TEXT || !pl_is_stdout(path) || !pl_window_is_known(stdout)) {
        return pl_write_buffer(path, &buffer, error);
    }
    /* Elsewhere, such as in the log of a job, an entry is a line. */
    pl_folding folding;
    pl_text_print(&buffer, pl_folding_begin(&folding, stdout));
    pl_folding_end(&folding);
    return PL_OK;
}

static pl_status deliver(const options *o, const pl_gate_verdict *verdict, pl_error *error)
{
    const char *out = o->request.out;
    bool to_file = out != NULL && !pl_is_stdout(out);
    const char *page = getenv("GITHUB_STEP_SUMMARY");
    pl_status status = write_format(o->format, verdict, to_file ? out : "-", error);
    if (status == PL_OK && to_file) {
        status = write_format(PL_GATE_TEXT, verdict, "-", error);
    }
    if (status == PL_OK && o->format == PL_GATE_GITHUB && page != NULL && page[0] != '\0') {
        status = append_page(verdict, page, error);
    }
    if (!to_file && (o->format == PL_GATE_JUNIT || o->format == PL_GATE_JSON)) {
        char summary[256];
        pl_gate_verdict_summary(verdict, summary, sizeof summary);
        pl_print_line(stderr, "%s", summary);
    }
    return status;
}

static pl_status judge(const options *o, material *m, pl_error *error)
{
    const pl_gate_inputs in = {.before = o->baseline == NULL ? NULL : &m->before,
                               .now = &m->now,
                               .tolerances = &o->tolerances,
                               .rules = m->rules,
                               .rule_count = o->rules.count,
                               .reference = o->reference};
    pl_gate_judge(&in, &m->verdict);
    return deliver(o, &m->verdict, error);
}

static int exit_code(const pl_call *call, const options *o, const material *m)
{
    if (m->now.count == 0) {
        return pl_call_nothing(call, "the results are empty");
    }
    if (o->update) {
        return PL_EXIT_OK;
    }
    return m->verdict.failures > 0       ? PL_EXIT_GATE
           : m->verdict.comparisons == 0 ? PL_EXIT_NOTHING
                                         : PL_EXIT_OK;
}

static int run(const pl_call *call)
{
    material m = {.files = NULL};
    pl_error error = {.message = ""};
    options o = {.request = pl_request_default(), .tolerances = pl_gate_tolerances_default()};
    pl_call_parse(call, &o);
    pl_status status = pl_request_outputs(&o.request, o.request.out, &error);
    if (status == PL_OK) {
        status = read_all(&o, &m, &error);
    }
    if (status == PL_OK && m.now.count > 0) {
        status = o.update ? update(&o, &m, &error) : judge(&o, &m, &error);
    }
    int code = status == PL_OK ? exit_code(call, &o, &m) : pl_call_fail(call, &error);
    free_material(&m);
    free(o.rules.items);
    pl_request_free(&o.request);
    return code;
}

static const pl_option OPTIONS[] = {
    {"baseline", "FILE", "The baseline that results are compared with", PL_OPTION_TEXT,
     .field = offsetof(options, baseline)},
    {"update-baseline", NULL, "Write the baseline FILE from the results instead", PL_OPTION_FLAG,
     .field = offsetof(options, update)},
    {"fail-if", "EXPR",
     "Fail where [SCENARIO[/ENGINE]:] METRIC OP VALUE holds (repeatable); with a sign and "
     "%, against the baseline",
     PL_OPTION_TEXTS, .field = offsetof(options, rules)},
    {"tolerance", "METRIC=REL[,ABS]",
     "Allowed difference: the larger of REL times the baseline's value and ABS (default "
     "1e-6,1e-9; settle_time a step more), or METRIC=off. With state_hash=0 other bits are "
     "a failure; memory_peak is compared only if this option names it",
     PL_OPTION_PARSED, .parse = parse_tolerance},
    {"time-limit", "PERCENT",
     "Allowed growth of time_per_step relative to the reference engine's (default 10)",
     PL_OPTION_NUMBER, .field = offsetof(options, tolerances.time), .takes = "per cent", .max = 1e6,
     .scale = 0.01},
    {"instruction-limit", "PERCENT", "The same for instructions_per_step (default 2)",
     PL_OPTION_NUMBER, .field = offsetof(options, tolerances.instructions), .takes = "per cent",
     .max = 1e6, .scale = 0.01},
    {"reference", "ENGINE",
     "Label of the reference engine (default: the baseline's; with --update-baseline "
     "bullet:si, or else ode:quick)",
     PL_OPTION_TEXT, .field = offsetof(options, reference)},
    {"format", "FORMAT", "text (default), junit, github or json", PL_OPTION_PARSED,
     .parse = parse_format, .values = "text|junit|github|json"},
    {"out", "FILE", "Write the output in that format to FILE, and text to standard output",
     PL_OPTION_TEXT, .field = offsetof(options, request.out)},
    {0}};

const pl_command pl_command_gate = {
    .name = "gate",
    .summary = "fail where results are worse than a baseline",
    .arguments = "RESULTS...",
    .description =
        "Compares results of plumb compare or run (results.jsonl, or a directory with one) with a "
        "baseline and with rules. Metrics that a deterministic engine repeats may not get worse; "
        "times are compared as a ratio to a reference engine of the same results, and only where "
        "noise allows; a run that is missing, or no longer ok, is a failure. Improvements and new "
        "runs are notices.",
    .notes = "Exit codes: 0 passed, 1 failed, 2 usage or bad input, 3 a file could not be read or "
             "written, 4 nothing was compared.\n\n"
             "Examples:\n"
             "  plumb gate report --baseline baseline.json --update-baseline\n"
             "  plumb gate report --baseline baseline.json --format github\n"
             "  plumb gate report --fail-if 'tower/mine: rest_position_error>1e-3'\n"
             "  plumb gate report --baseline baseline.json --fail-if 'pile: time_per_step>+25%'\n"
             "  plumb gate report --fail-if '*/mine: outcome!=ok' --format junit --out gate.xml",
    .options = OPTIONS,
    .shared = {pl_force_options},
    .check = check,
    .run = run};
