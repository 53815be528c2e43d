/* Tolerances, and rules: their text, which rows they select, and when they hold.
 *
 * A deterministic engine gives the same numbers at every run, so the default tolerances are those
 * of rounding: a millionth, or 1e-9 in the metric's own unit. A smaller number is rounding of the
 * engine or of the referee over some thousands of steps. The time to rest is known to one step. */
#include "gate.h"

#include <fnmatch.h>
#include <math.h>
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

/* Reads `length` bytes of "RELATIVE,ABSOLUTE" as a number that is not negative. */
static bool read_bound(const char *text, size_t length, double *value)
{
    char number[64];
    if (length >= sizeof number) {
        return false;
    }
    memcpy(number, text, length);
    number[length] = '\0';
    return pl_parse_number(number, value) && *value >= 0;
}

pl_status pl_gate_tolerances_parse(const char *text, pl_gate_tolerances *tolerances,
                                   pl_error *error)
{
    char name[PL_NAME_SIZE], hint[PL_SUGGESTION_SIZE];
    size_t length = strcspn(text, "=");
    if (text[length] != '=' || length == 0 || length >= sizeof name) {
        return fail(text, "expected METRIC=RELATIVE[,ABSOLUTE] or METRIC=off", error);
    }
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    int metric = pl_metric_by_name(name);
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
    tolerance.given = true;
    const char *value = text + length + 1;
    tolerance.off = strcmp(value, "off") == 0;
    size_t relative = strcspn(value, ",");
    if (!tolerance.off &&
        (!read_bound(value, relative, &tolerance.relative) ||
         (value[relative] == ',' &&
          !read_bound(value + relative + 1, strlen(value + relative + 1), &tolerance.absolute)))) {
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
enum { OPERATOR_COUNT = sizeof operators / sizeof operators[0] };

static const char name_letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";

static pl_status fail_at(const char *text, const char *at, const char *expected, pl_error *error)
{
    int length = (int)strcspn(at, " \t");
    return pl_fail(error, PL_BAD_INPUT,
                   "--fail-if \"%.120s\": column %d: expected %s, found %s%.*s%s", text,
                   (int)(at - text) + 1, expected, length == 0 ? "nothing" : "\"",
                   length > 60 ? 60 : length, at, length == 0 ? "" : "\"");
}

static const char *skip_blanks(const char *at)
{
    return at + strspn(at, " \t");
}

/* Copies without blanks at either end; an empty pattern becomes "*". False: too long. */
static bool copy_pattern(const char *from, const char *end, char pattern[256])
{
    from = skip_blanks(from);
    while (end > from && (end[-1] == ' ' || end[-1] == '\t')) {
        --end;
    }
    if (end - from > 255) {
        return false;
    }
    snprintf(pattern, 256, "%.*s", (int)(end - from), from);
    if (pattern[0] == '\0') {
        snprintf(pattern, 256, "*");
    }
    return true;
}

/* Reads "SCENARIO/ENGINE:" and returns the rest of the text; NULL: too long. */
static const char *read_filter(const char *text, pl_gate_rule *rule)
{
    snprintf(rule->scenario, sizeof rule->scenario, "*");
    snprintf(rule->engine, sizeof rule->engine, "*");
    const char *colon = strrchr(text, ':');
    if (colon == NULL) {
        return text;
    }
    const char *slash = colon;
    while (slash > text && *slash != '/') {
        --slash;
    }
    bool has_engine = *slash == '/';
    if (!copy_pattern(text, has_engine ? slash : colon, rule->scenario) ||
        (has_engine && !copy_pattern(slash + 1, colon, rule->engine))) {
        return NULL;
    }
    return colon + 1;
}

static pl_status read_metric(const char *text, const char *at, pl_gate_rule *rule, pl_error *error)
{
    char hint[PL_SUGGESTION_SIZE];
    size_t length = strspn(at, name_letters);
    if (length == 0 || length >= sizeof rule->metric) {
        return fail_at(text, at, "a metric", error);
    }
    snprintf(rule->metric, sizeof rule->metric, "%.*s", (int)length, at);
    return is_known(rule->metric, hint)
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT,
                         "--fail-if \"%.120s\": column %d: there is no metric %s%s", text,
                         (int)(at - text) + 1, rule->metric, hint);
}

/* The length without blanks at the end. */
static size_t trimmed_length(const char *at)
{
    size_t length = strlen(at);
    while (length > 0 && (at[length - 1] == ' ' || at[length - 1] == '\t')) {
        --length;
    }
    return length;
}

static pl_status read_number(const char *text, const char *at, pl_gate_rule *rule, pl_error *error)
{
    char number[64] = "";
    size_t length = trimmed_length(at);
    bool plus = at[0] == '+', minus = at[0] == '-';
    bool percent = length > 0 && at[length - 1] == '%';
    if (length < sizeof number && length > (size_t)plus + percent) {
        snprintf(number, sizeof number, "%.*s", (int)(length - plus - percent), at + plus);
    }
    if (number[0] == '+' || !pl_parse_number(number, &rule->value)) {
        return fail_at(text, at, "a number, or one with a sign and %", error);
    }
    if ((plus && !percent) || (percent && !plus && !minus)) {
        return fail_at(text, at, "a sign and % together, as in +10%", error);
    }
    rule->is_relative = percent;
    rule->value *= percent ? 0.01 : 1;
    bool is_bound = rule->op != PL_GATE_EQUAL && rule->op != PL_GATE_OTHER;
    if (percent && !is_bound) {
        return fail_at(text, at, "a number without % after == and !=", error);
    }
    bool is_growth = plus && (rule->op == PL_GATE_ABOVE || rule->op == PL_GATE_AT_LEAST);
    if (pl_gate_rule_is_cost(rule) && !is_growth) {
        return fail_at(text, at, "growth of a time or of instructions, as in >+10%", error);
    }
    return PL_OK;
}

static pl_status read_word(const char *text, const char *at, pl_gate_rule *rule, pl_error *error)
{
    size_t length = trimmed_length(at);
    if (length == 0 || length >= sizeof rule->word) {
        return fail_at(text, at, "a text", error);
    }
    snprintf(rule->word, sizeof rule->word, "%.*s", (int)length, at);
    const bool is_outcome = strcmp(rule->metric, "outcome") == 0;
    const bool is_verdict = strcmp(rule->metric, "verdict") == 0;
    bool known = !is_outcome && !is_verdict;
    for (int i = 0; i < PL_OUTCOME_COUNT && is_outcome; ++i) {
        known |= strcmp(pl_outcome_name((pl_outcome)i), rule->word) == 0;
    }
    for (int i = 0; i < PL_VERDICT_COUNT && is_verdict; ++i) {
        known |= strcmp(pl_verdict_name((pl_verdict)i), rule->word) == 0;
    }
    return known ? PL_OK
                 : fail_at(text, at,
                           is_verdict ? "accurate, inaccurate, failed or not judged"
                                      : "ok, collapsed, diverged, nonfinite, crashed, timeout or "
                                        "unsupported",
                           error);
}

pl_status pl_gate_rule_parse(const char *text, pl_gate_rule *rule, pl_error *error)
{
    *rule = (pl_gate_rule){.text = text};
    const char *at = read_filter(text, rule);
    if (at == NULL) {
        return fail_at(text, text, "names of at most 255 bytes", error);
    }
    at = skip_blanks(at);
    pl_status status = read_metric(text, at, rule, error);
    if (status != PL_OK) {
        return status;
    }
    at = skip_blanks(at + strlen(rule->metric));
    int i = 0;
    while (i < OPERATOR_COUNT && strncmp(at, operators[i].text, strlen(operators[i].text)) != 0) {
        ++i;
    }
    if (i == OPERATOR_COUNT) {
        return fail_at(text, at, "one of > >= < <= == !=", error);
    }
    rule->op = operators[i].op;
    rule->is_text = strcmp(rule->metric, "outcome") == 0 || strcmp(rule->metric, "verdict") == 0 ||
                    pl_metric_is(pl_metric_by_name(rule->metric), PL_TRAIT_TEXT);
    if (rule->is_text && rule->op != PL_GATE_EQUAL && rule->op != PL_GATE_OTHER) {
        return fail_at(text, at, "== or != before a text", error);
    }
    at = skip_blanks(at + strlen(operators[i].text));
    rule->value_column = (int)(at - text) + 1;
    return rule->is_text ? read_word(text, at, rule, error) : read_number(text, at, rule, error);
}

bool pl_gate_rule_selects(const pl_gate_rule *rule, const pl_gate_row *row)
{
    char engine[256];
    snprintf(engine, sizeof engine, "%.*s", (int)strcspn(row->label, ":"), row->label);
    return (fnmatch(rule->scenario, row->scenario, 0) == 0 ||
            fnmatch(rule->scenario, row->name, 0) == 0) &&
           (fnmatch(rule->engine, row->label, 0) == 0 || fnmatch(rule->engine, engine, 0) == 0);
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
