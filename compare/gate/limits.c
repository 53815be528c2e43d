/* The limits of metrics.
 *
 * A deterministic engine gives the same numbers at every run, so its limits are those of rounding:
 * a millionth, or 1e-9 in the metric's own unit, below which a number is rounding of the engine or
 * of the referee over some thousands of steps. A time to rest is known to a step. */
#include "limits.h"

#include "ratio.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double default_relative = 1e-6, value_floor = 1e-9;
static const double default_time = 0.1, default_instructions = 0.02;

const char *const pl_gate_own_names[PL_GATE_OWN_COUNT] = {
    "outcome", "time_ratio", "instructions_ratio", "instructions_per_step"};

pl_gate_limits pl_gate_limits_default(void)
{
    pl_gate_limits limits = {.time = default_time, .instructions = default_instructions};
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        limits.of[i] = (pl_gate_limit){.relative = default_relative, .absolute = value_floor};
    }
    return limits;
}

bool pl_gate_name_is_known(const char *name)
{
    bool known = pl_metric_by_name(name) >= 0;
    for (int i = 0; i < PL_GATE_OWN_COUNT; ++i) {
        known |= strcmp(pl_gate_own_names[i], name) == 0;
    }
    return known;
}

const char *pl_gate_nearest_name(const char *name)
{
    const char *names[PL_METRIC_COUNT + PL_GATE_OWN_COUNT];
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        names[i] = pl_metric_table[i].name;
    }
    for (int i = 0; i < PL_GATE_OWN_COUNT; ++i) {
        names[PL_METRIC_COUNT + i] = pl_gate_own_names[i];
    }
    return pl_nearest_name(name, names, PL_METRIC_COUNT + PL_GATE_OWN_COUNT);
}

static pl_status fail(const char *text, const char *what, pl_error *error)
{
    return pl_fail(error, PL_BAD_INPUT, "--tolerance \"%.80s\": %s", text, what);
}

/* The part of "RELATIVE,ABSOLUTE" up to `length` as a number that is not negative. */
static bool read_number(const char *text, size_t length, double *value)
{
    char number[64];
    if (length >= sizeof number) {
        return false;
    }
    memcpy(number, text, length);
    number[length] = '\0';
    return pl_parse_number(number, value) && *value >= 0;
}

pl_status pl_gate_limits_parse(const char *text, pl_gate_limits *limits, pl_error *error)
{
    char name[PL_NAME_SIZE];
    size_t length = strcspn(text, "=");
    if (text[length] != '=' || length == 0 || length >= sizeof name) {
        return fail(text, "expected METRIC=RELATIVE[,ABSOLUTE] or METRIC=off", error);
    }
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    int metric = pl_metric_by_name(name);
    if (pl_gate_cost_of(name) >= 0 || strcmp(name, "outcome") == 0) {
        return fail(text,
                    "times and instructions have --time-limit and --instruction-limit, and "
                    "an outcome has no tolerance",
                    error);
    }
    if (metric < 0) {
        const char *nearest = pl_gate_nearest_name(name);
        return pl_fail(error, PL_BAD_INPUT, "--tolerance: there is no metric %s%s%s%s", name,
                       nearest == NULL ? "; see plumb list metrics" : "; did you mean ",
                       nearest == NULL ? "" : nearest, nearest == NULL ? "" : "?");
    }
    pl_gate_limit limit = limits->of[metric];
    limit.given = true;
    const char *value = text + length + 1;
    limit.off = strcmp(value, "off") == 0;
    size_t relative = strcspn(value, ",");
    if (!limit.off &&
        (!read_number(value, relative, &limit.relative) ||
         (value[relative] == ',' &&
          !read_number(value + relative + 1, strlen(value + relative + 1), &limit.absolute)))) {
        return fail(text, "expected numbers that are not negative, RELATIVE[,ABSOLUTE], or off",
                    error);
    }
    limits->of[metric] = limit;
    return PL_OK;
}

double pl_gate_limit_at(const pl_gate_limit *limit, int metric, double value, double dt)
{
    double absolute = limit->absolute;
    if (metric == PL_METRIC_SETTLE_TIME && !limit->given) {
        absolute += dt;
    }
    return fmax(absolute, limit->relative * fabs(value));
}

bool pl_gate_limits_keep(const pl_gate_limits *limits, int metric, bool deterministic)
{
    return deterministic || (metric >= 0 && limits->of[metric].given && !limits->of[metric].off);
}
