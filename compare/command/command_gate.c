/* plumb gate: results against a baseline and against rules; the exit code is the verdict. */
#include "commands.h"
#include "gate/baseline.h"
#include "gate/gather.h"
#include "gate/judge.h"
#include "gate/ratio.h"
#include "results/store.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { EXIT_GATE_FAILED = 1 };

typedef struct options {
    const char **paths, **rule_texts; /* room for an argument each */
    int path_count, rule_count;
    const char *baseline, *reference, *out;
    bool update;
    pl_gate_tolerances tolerances;
    pl_gate_format format;
} options;

enum {
    KEY_BASELINE = 0x200,
    KEY_FAIL_IF,
    KEY_UPDATE,
    KEY_TOLERANCE,
    KEY_TIME_LIMIT,
    KEY_INSTRUCTION_LIMIT,
    KEY_REFERENCE,
    KEY_FORMAT,
    KEY_OUT
};

static const struct argp_option argp_options[] = {
    {"baseline", KEY_BASELINE, "FILE", 0, "What the results are held against", 0},
    {"update-baseline", KEY_UPDATE, NULL, 0, "Write FILE from the results instead", 0},
    {"fail-if", KEY_FAIL_IF, "EXPR", 0,
     "Fail where [SCENARIO[/ENGINE]:] METRIC OP VALUE holds (repeatable); with a sign and %, "
     "against the baseline",
     0},
    {"tolerance", KEY_TOLERANCE, "METRIC=REL[,ABS]", 0,
     "Allowed difference: the larger of REL times the baseline's value and ABS (default 1e-6,1e-9; "
     "settle_time a step more), or METRIC=off. state_hash=0 makes other bits a failure, and "
     "memory_peak is compared only where this is given",
     0},
    {"time-limit", KEY_TIME_LIMIT, "PERCENT", 0,
     "Growth allowed to time_per_step over the reference engine's (default 10)", 0},
    {"instruction-limit", KEY_INSTRUCTION_LIMIT, "PERCENT", 0,
     "The same of instructions_per_step (default 2)", 0},
    {"reference", KEY_REFERENCE, "ENGINE", 0,
     "Label of the reference engine (default: the baseline's; with --update-baseline bullet:si, or "
     "else ode:quick)",
     0},
    {"format", KEY_FORMAT, "FORMAT", 0, "text (default), junit, github or json", 0},
    {"out", KEY_OUT, "FILE", 0, "Write that there, and the text to standard output", 0},
    {0}};

static void set_format(options *o, const char *text, struct argp_state *state)
{
    for (int i = 0; i < PL_GATE_FORMAT_COUNT; ++i) {
        if (strcmp(text, pl_gate_format_names[i]) == 0) {
            o->format = (pl_gate_format)i;
            return;
        }
    }
    argp_error(state, "--format takes text, junit, github or json; found \"%s\"", text);
}

static void check(const options *o, struct argp_state *state)
{
    if (o->path_count == 0) {
        argp_error(state, "which results? plumb gate report/results.jsonl --baseline FILE");
    } else if (o->update && o->baseline == NULL) {
        argp_error(state, "--update-baseline needs --baseline FILE");
    } else if (o->update && o->rule_count > 0) {
        argp_error(state, "--update-baseline judges nothing: leave --fail-if out");
    } else if (o->baseline == NULL && o->rule_count == 0) {
        argp_error(state, "against what? --baseline FILE or --fail-if EXPR");
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    pl_error error;
    switch (key) {
    case ARGP_KEY_ARG:
        o->paths[o->path_count++] = text;
        return 0;
    case KEY_FAIL_IF:
        o->rule_texts[o->rule_count++] = text;
        return 0;
    case KEY_BASELINE:
        o->baseline = text;
        return 0;
    case KEY_UPDATE:
        o->update = true;
        return 0;
    case KEY_TOLERANCE:
        if (pl_gate_tolerances_parse(text, &o->tolerances, &error) != PL_OK) {
            argp_error(state, "%s", error.message);
        }
        return 0;
    case KEY_TIME_LIMIT:
        o->tolerances.time =
            pl_option_number(state, "--time-limit takes per cent", text, 0, 1e6) / 100;
        return 0;
    case KEY_INSTRUCTION_LIMIT:
        o->tolerances.instructions =
            pl_option_number(state, "--instruction-limit takes per cent", text, 0, 1e6) / 100;
        return 0;
    case KEY_REFERENCE:
        o->reference = text;
        return 0;
    case KEY_FORMAT:
        set_format(o, text, state);
        return 0;
    case KEY_OUT:
        o->out = text;
        return 0;
    case ARGP_KEY_END:
        check(o, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "RESULTS...",
    .doc =
        "Holds results of plumb compare or run (results.jsonl, or a directory with one) against a "
        "baseline and against rules. What a deterministic engine repeats may not get worse; times "
        "are compared as a ratio to a reference engine of the same results, and only where noise "
        "allows; a run that is missing, or no longer ok, fails. What got better, and what is new, "
        "is a notice.\v"
        "Exit codes: 0 passed, 1 failed, 2 usage or bad input, 3 a file could not be read or "
        "written, 4 nothing was compared.\n\n"
        "Examples:\n"
        "  plumb gate report --baseline baseline.json --update-baseline\n"
        "  plumb gate report --baseline baseline.json --format github\n"
        "  plumb gate report --fail-if 'tower/mine: rest_position_error>1e-3'\n"
        "  plumb gate report --baseline baseline.json --fail-if 'pile: time_per_step>+25%'\n"
        "  plumb gate report --fail-if '*/mine: outcome!=ok' --format junit --out gate.xml"};

/* What was read and made; all is freed at the end. */
typedef struct material {
    pl_gate_file *files;
    int file_count;
    pl_gate_rows before, now;
    pl_gate_rule *rules;
    pl_gate_verdict verdict;
} material;

static void free_material(material *m)
{
    pl_gate_verdict_free(&m->verdict);
    pl_gate_rows_free(&m->before);
    pl_gate_rows_free(&m->now);
    for (int i = 0; i < m->file_count; ++i) {
        json_decref(m->files[i].results);
    }
    free(m->files);
    free(m->rules);
}

static pl_status read_rules(const options *o, material *m, pl_error *error)
{
    pl_status status = PL_OK;
    m->rules = calloc((size_t)o->rule_count + 1, sizeof *m->rules);
    if (m->rules == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for rules");
    }
    for (int i = 0; i < o->rule_count && status == PL_OK; ++i) {
        pl_gate_rule *rule = &m->rules[i];
        status = pl_gate_rule_parse(o->rule_texts[i], rule, error);
        if (status == PL_OK && rule->is_relative && o->baseline == NULL) {
            status = pl_fail(error, PL_BAD_INPUT,
                             "--fail-if \"%.120s\": column %d: what is relative needs --baseline",
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
    const char **labels = calloc((size_t)rows->count + 1, sizeof *labels);
    if (labels == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    bool found = false;
    for (int i = 0; i < rows->count; ++i) {
        labels[i] = rows->items[i].label;
        found |= strcmp(labels[i], o->reference) == 0;
    }
    const char *nearest = pl_nearest_name(o->reference, labels, rows->count);
    pl_status status =
        found ? PL_OK
              : pl_fail(error, PL_BAD_INPUT,
                        "--reference %.100s: the results have no run of that engine%s%s%s",
                        o->reference, nearest == NULL ? "" : "; did you mean ",
                        nearest == NULL ? "" : nearest, nearest == NULL ? "" : "?");
    free(labels);
    return status;
}

static pl_status read_all(const options *o, material *m, pl_error *error)
{
    pl_status status = read_rules(o, m, error);
    m->files = calloc((size_t)o->path_count + 1, sizeof *m->files);
    if (status == PL_OK && m->files == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for results");
    }
    for (int i = 0; i < o->path_count && status == PL_OK; ++i) {
        status = pl_gate_file_read(o->paths[i], &m->files[m->file_count++], error);
    }
    if (status == PL_OK) {
        status = pl_gate_gather(m->files, m->file_count, &o->tolerances, &m->now, error);
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
    pl_status status = pl_gate_ratios_add(&m->now, o->reference, error);
    if (status == PL_OK) {
        status = pl_gate_baseline_write(o->baseline, &m->now, error);
    }
    if (status == PL_OK) {
        fprintf(stderr, "%d row%s written to %s\n", m->now.count, m->now.count == 1 ? "" : "s",
                o->baseline);
    }
    return status;
}

/* The page of a GitHub job: other steps of it write the same file. */
static pl_status append_page(const pl_gate_verdict *verdict, const char *path, pl_error *error)
{
    pl_text_buffer page = {0};
    pl_gate_write_markdown(verdict, &page);
    FILE *file = page.failed ? NULL : fopen(path, "ae");
    bool written = file != NULL && fputs(page.data, file) >= 0;
    written = file != NULL && fclose(file) == 0 && written;
    pl_text_free(&page);
    return written ? PL_OK : pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
}

static pl_status write_format(pl_gate_format format, const pl_gate_verdict *verdict,
                              const char *path, pl_error *error)
{
    pl_text_buffer buffer = {0};
    pl_gate_write(format, verdict, &buffer);
    pl_status status = buffer.failed ? pl_fail(error, PL_NO_MEMORY, "out of memory for the report")
                                     : pl_write_text(path, buffer.data, buffer.length, error);
    pl_text_free(&buffer);
    return status;
}

static pl_status deliver(const options *o, const pl_gate_verdict *verdict, pl_error *error)
{
    bool to_file = o->out != NULL && strcmp(o->out, "-") != 0;
    const char *page = getenv("GITHUB_STEP_SUMMARY");
    pl_status status = write_format(o->format, verdict, to_file ? o->out : "-", error);
    if (status == PL_OK && to_file) {
        status = write_format(PL_GATE_TEXT, verdict, "-", error);
    }
    if (status == PL_OK && o->format == PL_GATE_GITHUB && page != NULL && page[0] != '\0') {
        status = append_page(verdict, page, error);
    }
    if (!to_file && (o->format == PL_GATE_JUNIT || o->format == PL_GATE_JSON)) {
        char summary[256];
        pl_gate_verdict_summary(verdict, summary, sizeof summary);
        fprintf(stderr, "%s\n", summary);
    }
    return status;
}

static pl_status judge(const options *o, material *m, pl_error *error)
{
    const pl_gate_inputs in = {.before = o->baseline == NULL ? NULL : &m->before,
                               .now = &m->now,
                               .tolerances = &o->tolerances,
                               .rules = m->rules,
                               .rule_count = o->rule_count,
                               .reference = o->reference};
    pl_status status = pl_gate_judge(&in, &m->verdict, error);
    return status == PL_OK ? deliver(o, &m->verdict, error) : status;
}

static int exit_code(const pl_call *call, const options *o, const material *m)
{
    if (m->now.count == 0) {
        fprintf(stderr, "%s: the results are empty\n", call->argv[0]);
        return PL_EXIT_NOTHING;
    }
    if (o->update) {
        return PL_EXIT_OK;
    }
    return m->verdict.failures > 0       ? EXIT_GATE_FAILED
           : m->verdict.comparisons == 0 ? PL_EXIT_NOTHING
                                         : PL_EXIT_OK;
}

int pl_command_gate(const pl_call *call)
{
    material m = {.files = NULL};
    pl_error error = {.message = ""};
    options o = {.paths = calloc((size_t)call->argc, sizeof *o.paths),
                 .rule_texts = calloc((size_t)call->argc, sizeof *o.rule_texts),
                 .tolerances = pl_gate_tolerances_default()};
    pl_status status = PL_OK;
    if (o.paths == NULL || o.rule_texts == NULL) {
        status = pl_fail(&error, PL_NO_MEMORY, "out of memory for the command line");
    } else {
        pl_call_parse(call, &argp, &o);
        status = read_all(&o, &m, &error);
    }
    if (status == PL_OK && m.now.count > 0) {
        status = o.update ? update(&o, &m, &error) : judge(&o, &m, &error);
    }
    int code = status == PL_OK ? exit_code(call, &o, &m) : pl_call_fail(call, &error);
    free_material(&m);
    free(o.paths);
    free(o.rule_texts);
    return code;
}
