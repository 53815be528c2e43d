#include "tune.h"

#include "results/result.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The excess that a run whose outcome is not ok adds to that of its numbers. */
static const double failed_run = 2;

static pl_status fail_metric(const char *name, pl_error *error)
{
    const char *names[PL_METRIC_COUNT];
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        names[i] = pl_metric_table[i].name;
    }
    char suggestion[PL_SUGGESTION_SIZE];
    pl_did_you_mean(name, names, PL_METRIC_COUNT, suggestion);
    return pl_fail(error, PL_BAD_INPUT, "--target: there is no metric %s%s", name,
                   suggestion[0] == '\0' ? "; see plumb list metrics" : suggestion);
}

pl_status pl_target_add(pl_targets *targets, const char *text, pl_error *error)
{
    char name[PL_NAME_SIZE];
    const size_t length = strcspn(text, "<>=!");
    const char *sign = text + length;
    const bool strict = sign[0] == '<' && sign[1] != '=';
    pl_target target = {.strict = strict};
    if (sign[0] != '<' || length == 0 || length >= sizeof name) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--target takes METRIC<=VALUE or METRIC<VALUE; found \"%.200s\"", text);
    }
    memcpy(name, text, length);
    name[length] = '\0';
    target.metric = pl_metric_by_name(name);
    if (target.metric < 0) {
        return fail_metric(name, error);
    }
    if (pl_metric_table[target.metric].direction != PL_LOWER_IS_BETTER) {
        return pl_fail(error, PL_BAD_INPUT, "--target: of %s lower is not better", name);
    }
    if (!pl_parse_number(sign + (strict ? 1 : 2), &target.bound) || !(target.bound > 0)) {
        return pl_fail(error, PL_BAD_INPUT, "--target %s: expected a positive number, found \"%s\"",
                       name, sign + (strict ? 1 : 2));
    }
    if (targets->count == PL_TUNE_MOST_TARGETS) {
        return pl_fail(error, PL_BAD_INPUT, "--target: more than %d", (int)PL_TUNE_MOST_TARGETS);
    }
    targets->items[targets->count++] = target;
    return PL_OK;
}

void pl_target_text(const pl_target *target, char text[96])
{
    char bound[32] = "";
    for (int digits = 6; strtod(bound, NULL) != target->bound && digits <= 17; ++digits) {
        snprintf(bound, sizeof bound, "%.*g", digits, target->bound);
    }
    snprintf(text, 96, "%s%s%s", pl_metric_table[target->metric].name,
             target->strict ? "<" : "<=", bound);
}

static double excess_of(const pl_target *target, double value)
{
    if (!isfinite(value)) {
        return PL_SEARCH_WORST;
    }
    if (value <= 0) {
        return -PL_SEARCH_WORST;
    }
    const double excess = log(value / target->bound);
    /* Rounding of the quotient must not decide whether the target is met. */
    if (value > target->bound || (target->strict && value >= target->bound)) {
        return fmin(fmax(excess, DBL_EPSILON), PL_SEARCH_WORST);
    }
    return fmax(fmin(excess, 0), -PL_SEARCH_WORST);
}

double pl_targets_excess(const pl_targets *targets, const json_t *result)
{
    double excess = -PL_SEARCH_WORST;
    for (int i = 0; i < targets->count; ++i) {
        const pl_target *target = &targets->items[i];
        const char *name = pl_metric_table[target->metric].name;
        excess = fmax(excess, excess_of(target, pl_result_metric(result, name)));
    }
    return strcmp(pl_json_get_text(result, "outcome"), "ok") == 0
               ? excess
               : fmin(fmax(excess, 0) + failed_run, PL_SEARCH_WORST);
}

json_t *pl_targets_values(const pl_targets *targets, const json_t *result)
{
    json_t *values = json_object();
    for (int i = 0; i < targets->count; ++i) {
        const char *name = pl_metric_table[targets->items[i].metric].name;
        json_object_set_new(values, name, pl_json_number_or_null(pl_result_metric(result, name)));
    }
    return values;
}
