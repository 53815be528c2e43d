#include "tune_parameter.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double cut(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static double rounded(const pl_tune_parameter *parameter, double value)
{
    const double exact_below = 1000;
    char text[32];
    if (parameter->integer && fabs(value) < exact_below) {
        return cut(nearbyint(value), ceil(parameter->low), floor(parameter->high));
    }
    snprintf(text, sizeof text, "%.3g", value);
    return cut(strtod(text, NULL), parameter->integer ? ceil(parameter->low) : parameter->low,
               parameter->integer ? floor(parameter->high) : parameter->high);
}

double pl_tune_value(const pl_tune_parameter *parameter, double unit)
{
    const double u = cut(unit, 0, 1);
    return rounded(parameter, parameter->logarithmic
                                  ? parameter->low * pow(parameter->high / parameter->low, u)
                                  : parameter->low + u * (parameter->high - parameter->low));
}

double pl_tune_unit(const pl_tune_parameter *parameter, double value)
{
    const double v = cut(value, parameter->low, parameter->high);
    return parameter->logarithmic ? log(v / parameter->low) / log(parameter->high / parameter->low)
                                  : (v - parameter->low) / (parameter->high - parameter->low);
}

double pl_tune_neighbour(const pl_tune_parameter *parameter, double value, int direction)
{
    const double part = 0.1, least_part = 0.01;
    double step = part * fabs(value);
    if (parameter->integer && step < 1) {
        step = 1;
    } else if (step <= 0) {
        step = least_part * (parameter->high - parameter->low);
    }
    return rounded(parameter, direction < 0 ? value - step : value + step);
}
