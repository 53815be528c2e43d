/* plumb gate: results against a baseline and against rules; the exit code is the verdict. */
#include "base/folding.h"
#include "base/heap.h"
#include "gate/gate.h"
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
    int format; /* pl_gate_format */
} options;

static pl_status parse_tolerance(void *user, const char *text, pl_error *error)
{
    options *o = user;
    return pl_gate_tolerances_parse(text, &o->tolerances, error);
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
    const pl_call *call;
    const options *o;
    pl_result_file *files;
    pl_result_table results;
    pl_gate_rows before, now;
    pl_gate_rule *rules;
    pl_gate_verdict verdict;
} material;

static void free_material(material *m)
{
    free(m->verdict.items);
    pl_gate_rows_free(&m->before);
    pl_gate_rows_free(&m->now);
    pl_result_table_free(&m->results);
    for (int i = 0; i < m->o->request.names.count; ++i) {
        json_decref((json_t *)m->files[i].results);
    }
    free(m->files);
    free(m->rules);
}

static void read_rules(material *m)
{
    const pl_texts *texts = &m->o->rules;
    m->rules = pl_heap_new((size_t)texts->count, sizeof *m->rules);
    for (int i = 0; i < texts->count; ++i) {
        pl_gate_rule *rule = &m->rules[i];
        pl_call_need(m->call, pl_gate_rule_parse(texts->items[i], rule, m->call->error));
        if (rule->is_relative && m->o->baseline == NULL) {
            pl_call_need(
                m->call,
                pl_fail(m->call->error, PL_BAD_INPUT,
                        "--fail-if \"%.120s\": column %d: a relative rule needs --baseline",
                        rule->text, rule->value_column));
        }
    }
}

static void check_reference(const material *m)
{
    const pl_gate_rows *rows = &m->now;
    const char *reference = m->o->reference;
    if (reference == NULL || rows->count == 0) {
        return;
    }
    const char **labels = pl_heap_new((size_t)rows->count, sizeof *labels);
    bool found = false;
    for (int i = 0; i < rows->count; ++i) {
        labels[i] = rows->items[i].label;
        found |= strcmp(labels[i], reference) == 0;
    }
    if (!found) {
        char hint[PL_SUGGESTION_SIZE];
        pl_did_you_mean(reference, labels, rows->count, hint);
        pl_call_need(m->call,
                     pl_fail(m->call->error, PL_BAD_INPUT,
                             "--reference %.100s: the results have no run of that engine%s",
                             reference, hint));
    }
    free(labels);
}

static void read_all(material *m)
{
    const options *o = m->o;
    const int count = o->request.names.count;
    read_rules(m);
    m->files = pl_heap_new((size_t)count, sizeof *m->files);
    for (int i = 0; i < count; ++i) {
        json_t *results = NULL;
        m->files[i].path = o->request.names.items[i];
        pl_call_need(m->call, pl_gate_read(m->files[i].path, &results, m->call->error));
        m->files[i].results = results;
    }
    const pl_result_table_def def = {.files = m->files, .file_count = count};
    pl_call_need(m->call, pl_result_table_build(&def, &m->results, m->call->error));
    pl_result_table_print_left_out(&m->results, stderr);
    pl_gate_gather(&m->results, &o->tolerances, &m->now);
    check_reference(m);
    if (!o->update && o->baseline != NULL) {
        pl_call_need(m->call, pl_gate_baseline_read(o->baseline, &m->before, m->call->error));
    }
    pl_gate_rows_disambiguate(&m->now, &m->before);
}

static void update(material *m)
{
    pl_gate_ratios_add(&m->now, m->o->reference);
    pl_call_need(m->call, pl_gate_baseline_write(m->o->baseline, &m->now, m->call->error));
    pl_print_line(stderr, "%d row%s written to %s", m->now.count, m->now.count == 1 ? "" : "s",
                  m->o->baseline);
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

static pl_status write_format(int format, const pl_gate_verdict *verdict, const char *path,
                              pl_error *error)
{
    pl_text_buffer buffer = {0};
    pl_gate_write((pl_gate_format)format, verdict, &buffer);
    if (format != PL_GATE_TEXT || !pl_is_stdout(path) || !pl_window_is_known(stdout)) {
        return pl_write_buffer(path, &buffer, error);
    }
    /* Elsewhere, such as in the log of a job, an entry is a line. */
    pl_folding folding;
    pl_text_print(&buffer, pl_folding_begin(&folding, stdout));
    pl_folding_end(&folding);
    return PL_OK;
}

static void deliver(const material *m)
{
    const options *o = m->o;
    const char *out = o->request.out;
    const bool to_file = out != NULL && !pl_is_stdout(out);
    const char *page = getenv("GITHUB_STEP_SUMMARY");
    pl_status status = write_format(o->format, &m->verdict, to_file ? out : "-", m->call->error);
    if (status == PL_OK && to_file) {
        status = write_format(PL_GATE_TEXT, &m->verdict, "-", m->call->error);
    }
    if (status == PL_OK && o->format == PL_GATE_GITHUB && page != NULL && page[0] != '\0') {
        status = append_page(&m->verdict, page, m->call->error);
    }
    if (!to_file && (o->format == PL_GATE_JUNIT || o->format == PL_GATE_JSON)) {
        char summary[256];
        pl_gate_verdict_summary(&m->verdict, summary, sizeof summary);
        pl_print_line(stderr, "%s", summary);
    }
    pl_call_need(m->call, status);
}

/* Returns the exit code. */
static int judge(material *m)
{
    const options *o = m->o;
    m->verdict = (pl_gate_verdict){.before = o->baseline == NULL ? NULL : &m->before,
                                   .now = &m->now,
                                   .tolerances = &o->tolerances,
                                   .rules = m->rules,
                                   .rule_count = o->rules.count,
                                   .reference = o->reference};
    pl_gate_judge(&m->verdict);
    deliver(m);
    return m->verdict.failures > 0       ? PL_EXIT_GATE
           : m->verdict.comparisons == 0 ? PL_EXIT_NOTHING
                                         : PL_EXIT_OK;
}

static int run(const pl_call *call)
{
    int code = PL_EXIT_OK;
    options o = {.request = pl_request_default(), .tolerances = pl_gate_tolerances_default()};
    material m = {.call = call, .o = &o};
    pl_call_parse(call, &o);
    pl_call_need(call, pl_request_outputs(&o.request, o.request.out, call->error));
    read_all(&m);
    if (m.now.count == 0) {
        code = pl_call_nothing(call, "the results are empty");
    } else if (o.update) {
        update(&m);
    } else {
        code = judge(&m);
    }
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
    {"format", "FORMAT", "text (default), junit, github or json", PL_OPTION_CHOICE,
     .field = offsetof(options, format), .values = "text|junit|github|json"},
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
