#include "tune_parameter.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double cut(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static double rounded(const pl_tune_axis *axis, double value)
{
    const double exact_below = 1000;
    char text[32];
    if (axis->integer && fabs(value) < exact_below) {
        return cut(nearbyint(value), ceil(axis->low), floor(axis->high));
    }
    snprintf(text, sizeof text, "%.3g", value);
    return cut(strtod(text, NULL), axis->integer ? ceil(axis->low) : axis->low,
               axis->integer ? floor(axis->high) : axis->high);
}

double pl_tune_value(const pl_tune_axis *axis, double unit)
{
    const double u = cut(unit, 0, 1);
    return rounded(axis, axis->logarithmic ? axis->low * pow(axis->high / axis->low, u)
                                           : axis->low + u * (axis->high - axis->low));
}

double pl_tune_unit(const pl_tune_axis *axis, double value)
{
    const double v = cut(value, axis->low, axis->high);
    return axis->logarithmic ? log(v / axis->low) / log(axis->high / axis->low)
                             : (v - axis->low) / (axis->high - axis->low);
}

double pl_tune_neighbour(const pl_tune_axis *axis, double value, int direction)
{
    const double part = 0.1, least_part = 0.01;
    double step = part * fabs(value);
    if (axis->integer && step < 1) {
        step = 1;
    } else if (step <= 0) {
        step = least_part * (axis->high - axis->low);
    }
    return rounded(axis, direction < 0 ? value - step : value + step);
}
