#include "mismatch.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

/* Ratios and guesses are recognised to this relative difference: far below the difference between
 * two mistakes, and above the errors of an integrator. */
static const double RECOGNISED = 2e-3;

static double length_of(const double *v, int count)
{
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        sum += v[i] * v[i];
    }
    return sqrt(sum);
}

static double distance_of(const double *a, const double *b, double scale, int count)
{
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double difference = a[i] - scale * b[i];
        sum += difference * difference;
    }
    return sqrt(sum);
}

const char *pl_guess_cause(const double found[3], const pl_guess *guesses, int count,
                           const char *otherwise)
{
    for (int i = 0; i < count; ++i) {
        const double size = length_of(guesses[i].value, 3);
        if (distance_of(found, guesses[i].value, 1, 3) <= RECOGNISED * size) {
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

void pl_describe_ratio(const double *found, const double *expected, int count, char *text,
                       size_t size)
{
    const double length = length_of(expected, count);
    text[0] = '\0';
    if (!(length > 0)) {
        return;
    }
    double ratio = 0;
    for (int i = 0; i < count; ++i) {
        ratio += found[i] * expected[i] / (length * length);
    }
    const double off = distance_of(found, expected, ratio, count);
    if (length_of(found, count) <= RECOGNISED * length) {
        snprintf(text, size, ", which is nothing");
    } else if (off <= RECOGNISED * fabs(ratio) * length) {
        snprintf(text, size, ", which is %.5g times what was expected%s", ratio, ratio_name(ratio));
    }
}
