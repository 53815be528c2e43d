#include "probe.h"

#include <math.h>
#include <stdio.h>

/* Ratios and guesses are recognised to this relative difference: far below the difference between
 * two mistakes, and above the errors of an integrator. */
static const double RECOGNISED = 2e-3;

const char *pl_guess_cause(pl_vec found, const pl_guess *guesses, int count, const char *otherwise)
{
    for (int i = 0; i < count; ++i) {
        const pl_vec value = guesses[i].value;
        if (pl_vec_length(pl_vec_sub(found, value)) <= RECOGNISED * pl_vec_length(value)) {
            return guesses[i].cause;
        }
    }
    return otherwise;
}

static const char *ratio_name(double ratio)
{
    static const struct {
        double ratio;
        const char *name;
    } known[] = {
        {57.295779513, ": degrees in place of radians"},
        {0.01745329252, ": radians taken for degrees"},
        {-1, ": the opposite sign"},
        {2, ": double"},
        {0.5, ": half"},
        {-2, ": double, with the opposite sign"},
        {-0.5, ": half, with the opposite sign"},
        {100, ": centimetres in place of metres"},
        {0.01, ": metres taken for centimetres"},
        {1000, ": a thousand"},
        {0.001, ": a thousandth"},
        {9.81, ": multiplied by gravity"},
        {1 / 9.81, ": divided by gravity"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i) {
        if (fabs(ratio - known[i].ratio) <= RECOGNISED * fabs(known[i].ratio)) {
            return known[i].name;
        }
    }
    return "";
}

void pl_describe_ratio(pl_vec found, pl_vec expected, char *text, size_t size)
{
    const double length = pl_vec_length(expected);
    text[0] = '\0';
    if (!(length > 0)) {
        return;
    }
    const double ratio = pl_vec_dot(found, expected) / (length * length);
    const double off = pl_vec_length(pl_vec_mad(found, -ratio, expected));
    if (pl_vec_length(found) <= RECOGNISED * length) {
        snprintf(text, size, ", which is nothing");
    } else if (off <= RECOGNISED * fabs(ratio) * length) {
        snprintf(text, size, ", which is %.5g times what was expected%s", ratio, ratio_name(ratio));
    }
}
