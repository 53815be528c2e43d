/* Tolerances, and rules: their text, which rows they select, and when they hold.
 *
 * A deterministic engine gives the same numbers at every run, so the default tolerances are those
 * of rounding: a millionth, or 1e-9 in the metric's own unit. A smaller number is rounding of the
 * engine or of the referee over some thousands of steps. The time to rest is known to one step. */
#include "gate.h"

#include "base/heap.h"

#include <fnmatch.h>
#include <math.h>
#include <regex.h>
#include <stdio.h>
#include <string.h>

/* ---- Tolerances ---- */

/* A rule also accepts "outcome", "verdict" and the names of ratios. */
enum { KNOWN_COUNT = 2 * PL_METRIC_COUNT + 2 };

pl_gate_tolerances pl_gate_tolerances_default(void)
{
    pl_gate_tolerances tolerances = {.time = 0.1, .instructions = 0.02};
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        tolerances.of[i] = (pl_gate_tolerance){.relative = 1e-6, .absolute = 1e-9};
    }
    return tolerances;
}

/* Whether a rule takes the name; else `hint` is the end of a message, which suggests the nearest
 * one. */
static bool is_known(const char *name, char hint[PL_SUGGESTION_SIZE])
{
    const char *names[KNOWN_COUNT] = {"outcome", "verdict"};
    bool known = false;
    int count = 2;
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        names[count++] = pl_metric_table[i].name;
        if (pl_metric_table[i].ratio != NULL) {
            names[count++] = pl_metric_table[i].ratio;
        }
    }
    for (int i = 0; i < count; ++i) {
        known |= strcmp(names[i], name) == 0;
    }
    if (pl_did_you_mean(name, names, count, hint)[0] == '\0') {
        snprintf(hint, PL_SUGGESTION_SIZE, "; see plumb list metrics");
    }
    return known;
}

static pl_status fail(const char *text, const char *what, pl_error *error)
{
    return pl_fail(error, PL_BAD_INPUT, "--tolerance \"%.80s\": %s", text, what);
}

/* Reads a number that is not negative. */
static bool read_bound(const char *text, double *value)
{
    return pl_parse_number(text, value) && *value >= 0;
}

/* Reads "RELATIVE[,ABSOLUTE]" or "off", whose commas become zeros. */
static bool read_bounds(char *text, pl_gate_tolerance *tolerance)
{
    tolerance->given = true;
    tolerance->off = strcmp(text, "off") == 0;
    char *absolute = text;
    const char *relative = strsep(&absolute, ",");
    return tolerance->off || (read_bound(relative, &tolerance->relative) &&
                              (absolute == NULL || read_bound(absolute, &tolerance->absolute)));
}

pl_status pl_gate_tolerances_parse(const char *text, pl_gate_tolerances *tolerances,
                                   pl_error *error)
{
    char name[PL_NAME_SIZE], value[128], hint[PL_SUGGESTION_SIZE];
    const size_t length = strcspn(text, "=");
    if (text[length] != '=' || length == 0 || length >= sizeof name) {
        return fail(text, "expected METRIC=RELATIVE[,ABSOLUTE] or METRIC=off", error);
    }
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    snprintf(value, sizeof value, "%s", text + length + 1);
    const int metric = pl_metric_by_name(name);
    if (pl_gate_cost_of(name) >= 0 || strcmp(name, "outcome") == 0 ||
        strcmp(name, "verdict") == 0) {
        return fail(text,
                    "times and instructions have --time-limit, --instruction-limit and "
                    "--fail-if 'METRIC>+10%', and a verdict or an outcome has no tolerance",
                    error);
    }
    if (metric < 0) {
        is_known(name, hint);
        return pl_fail(error, PL_BAD_INPUT, "--tolerance: there is no metric %s%s", name, hint);
    }
    pl_gate_tolerance tolerance = tolerances->of[metric];
    if (!read_bounds(value, &tolerance)) {
        return fail(text, "expected numbers that are not negative, RELATIVE[,ABSOLUTE], or off",
                    error);
    }
    tolerances->of[metric] = tolerance;
    return PL_OK;
}

double pl_gate_tolerance_at(const pl_gate_tolerance *tolerance, int metric, double value, double dt)
{
    double absolute = tolerance->absolute;
    if (pl_metric_is(metric, PL_TRAIT_TO_ONE_STEP) && !tolerance->given) {
        absolute += dt;
    }
    return fmax(absolute, tolerance->relative * fabs(value));
}

/* ---- Rules ---- */

static const struct {
    const char *text;
    pl_gate_operator op;
} operators[] = {{">=", PL_GATE_AT_LEAST}, {"<=", PL_GATE_AT_MOST}, {"==", PL_GATE_EQUAL},
                 {"!=", PL_GATE_OTHER},    {">", PL_GATE_ABOVE},    {"<", PL_GATE_BELOW}};
/* The parts of a rule: it has an engine, or none. */
static const char GRAMMAR[] =
    "^((.*/)?(.*):)?([ \t]*)([a-z0-9_]*)([ \t]*)(>=|<=|==|!=|>|<)?([ \t]*)(.*)$";
enum {
    FIRST_PATTERN = 2,
    LAST_PATTERN = 3,
    METRIC = 5,
    BLANKS = 6,
    OPERATOR = 7,
    VALUE = 9,
    PARTS
};

static pl_status fail_at(const char *text, regoff_t at, const char *expected, pl_error *error)
{
    int length = (int)strcspn(text + at, " \t");
    return pl_fail(error, PL_BAD_INPUT,
                   "--fail-if \"%.120s\": column %d: expected %s, found %s%.*s%s", text,
                   (int)at + 1, expected, length == 0 ? "nothing" : "\"", length > 60 ? 60 : length,
                   text + at, length == 0 ? "" : "\"");
}

/* Copies a part of a text without blanks at either end. False: it is too long. */
static bool copy(const char *text, regmatch_t part, char *to, size_t size)
{
    while (part.rm_so < part.rm_eo && strchr(" \t", text[part.rm_so]) != NULL) {
        ++part.rm_so;
    }
    while (part.rm_eo > part.rm_so && strchr(" \t", text[part.rm_eo - 1]) != NULL) {
        --part.rm_eo;
    }
    const int length = part.rm_so < 0 ? 0 : (int)(part.rm_eo - part.rm_so);
    return snprintf(to, size, "%.*s", length, text + (length == 0 ? 0 : part.rm_so)) < (int)size;
}

/* Reads "SCENARIO/ENGINE". False: too long. */
static bool read_patterns(const char *text, const regmatch_t *parts, pl_gate_rule *rule)
{
    regmatch_t first = parts[FIRST_PATTERN], last = parts[LAST_PATTERN];
    const bool has_engine = first.rm_so >= 0;
    first.rm_eo -= has_engine; /* the slash */
    return copy(text, has_engine ? first : last, rule->scenario, sizeof rule->scenario) &&
           (!has_engine || copy(text, last, rule->engine, sizeof rule->engine));
}

static pl_status read_metric(const char *text, regmatch_t part, pl_gate_rule *rule, pl_error *error)
{
    char hint[PL_SUGGESTION_SIZE];
    if (!copy(text, part, rule->metric, sizeof rule->metric) || rule->metric[0] == '\0') {
        return fail_at(text, part.rm_so, "a metric", error);
    }
    rule->is_text = strcmp(rule->metric, "outcome") == 0 || strcmp(rule->metric, "verdict") == 0 ||
                    pl_metric_is(pl_metric_by_name(rule->metric), PL_TRAIT_TEXT);
    return is_known(rule->metric, hint)
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT,
                         "--fail-if \"%.120s\": column %d: there is no metric %s%s", text,
                         (int)part.rm_so + 1, rule->metric, hint);
}

static pl_status read_operator(const char *text, const regmatch_t *parts, pl_gate_rule *rule,
                               pl_error *error)
{
    char word[8];
    copy(text, parts[OPERATOR], word, sizeof word);
    for (size_t i = 0; i < sizeof operators / sizeof operators[0]; ++i) {
        rule->op = strcmp(word, operators[i].text) == 0 ? operators[i].op : rule->op;
    }
    rule->is_bound = rule->op != PL_GATE_EQUAL && rule->op != PL_GATE_OTHER;
    return rule->op == 0 ? fail_at(text, parts[BLANKS].rm_eo, "one of > >= < <= == !=", error)
           : rule->is_text && rule->is_bound
               ? fail_at(text, parts[OPERATOR].rm_so, "== or != before a text", error)
               : PL_OK;
}

static pl_status read_number(const char *text, regmatch_t part, pl_gate_rule *rule, pl_error *error)
{
    char number[64] = "";
    const bool fits = copy(text, part, number, sizeof number);
    const size_t length = strlen(number);
    const bool plus = number[0] == '+', minus = number[0] == '-';
    const bool percent = length > 0 && number[length - 1] == '%';
    number[length - percent] = '\0';
    if (!fits || number[plus] == '+' || !pl_parse_number(number + plus, &rule->value)) {
        return fail_at(text, part.rm_so, "a number, or one with a sign and %", error);
    }
    if ((plus && !percent) || (percent && !plus && !minus)) {
        return fail_at(text, part.rm_so, "a sign and % together, as in +10%", error);
    }
    rule->is_relative = percent;
    rule->value *= percent ? 0.01 : 1;
    if (percent && !rule->is_bound) {
        return fail_at(text, part.rm_so, "a number without % after == and !=", error);
    }
    bool is_growth = plus && (rule->op == PL_GATE_ABOVE || rule->op == PL_GATE_AT_LEAST);
    if (pl_gate_rule_is_cost(rule) && !is_growth) {
        return fail_at(text, part.rm_so, "growth of a time or of instructions, as in >+10%", error);
    }
    return PL_OK;
}

static pl_status read_word(const char *text, regmatch_t part, pl_gate_rule *rule, pl_error *error)
{
    if (!copy(text, part, rule->word, sizeof rule->word) || rule->word[0] == '\0') {
        return fail_at(text, part.rm_so, "a text", error);
    }
    bool is_verdict = false;
    for (int i = 0; i < PL_VERDICT_COUNT; ++i) {
        is_verdict |= strcmp(pl_verdict_name((pl_verdict)i), rule->word) == 0;
    }
    if (strcmp(rule->metric, "outcome") == 0 &&
        (int)pl_outcome_named(rule->word) == PL_OUTCOME_COUNT) {
        return fail_at(text, part.rm_so,
                       "ok, collapsed, diverged, nonfinite, crashed, timeout or unsupported",
                       error);
    }
    return strcmp(rule->metric, "verdict") == 0 && !is_verdict
               ? fail_at(text, part.rm_so, "accurate, inaccurate, failed or not judged", error)
               : PL_OK;
}

pl_status pl_gate_rule_parse(const char *text, pl_gate_rule *rule, pl_error *error)
{
    regex_t grammar;
    regmatch_t parts[PARTS];
    *rule = (pl_gate_rule){.text = text};
    if (regcomp(&grammar, GRAMMAR, REG_EXTENDED) != 0 ||
        regexec(&grammar, text, PARTS, parts, 0) != 0) {
        pl_out_of_memory();
    }
    regfree(&grammar);
    if (!read_patterns(text, parts, rule)) {
        return fail_at(text, 0, "names of at most 255 bytes", error);
    }
    pl_status status = read_metric(text, parts[METRIC], rule, error);
    if (status == PL_OK) {
        status = read_operator(text, parts, rule, error);
    }
    if (status != PL_OK) {
        return status;
    }
    rule->value_column = (int)parts[VALUE].rm_so + 1;
    return (rule->is_text ? read_word : read_number)(text, parts[VALUE], rule, error);
}

static bool matches(const char *pattern, const char *name, const char *other)
{
    return pattern[0] == '\0' || fnmatch(pattern, name, 0) == 0 || fnmatch(pattern, other, 0) == 0;
}

bool pl_gate_rule_selects(const pl_gate_rule *rule, const pl_gate_row *row)
{
    char engine[256];
    snprintf(engine, sizeof engine, "%.*s", (int)strcspn(row->label, ":"), row->label);
    return matches(rule->scenario, row->scenario, row->name) &&
           matches(rule->engine, row->label, engine);
}

bool pl_gate_rule_holds(const pl_gate_rule *rule, double value)
{
    const pl_gate_operator found = value < rule->value    ? PL_GATE_BELOW
                                   : value == rule->value ? PL_GATE_EQUAL
                                                          : PL_GATE_ABOVE;
    return (rule->op & found) != 0;
}

bool pl_gate_rule_holds_relative(const pl_gate_rule *rule, double before, double now, double least)
{
    pl_gate_rule absolute = *rule;
    absolute.value = before + rule->value * fabs(before);
    return fabs(now - before) > least && pl_gate_rule_holds(&absolute, now);
}

bool pl_gate_rule_is_cost(const pl_gate_rule *rule)
{
    return rule->is_relative && pl_gate_cost_of(rule->metric) >= 0;
}
