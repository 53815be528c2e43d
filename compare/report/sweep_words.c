#include "sweep_words.h"

#include "quantity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void pl_sweep_ratio_text(const pl_sweep_ratio *ratio, char text[PL_SWEEP_TEXT_SIZE])
{
    char value[PL_QUANTITY_SIZE], low[PL_QUANTITY_SIZE], high[PL_QUANTITY_SIZE];
    pl_quantity_ratio(ratio->value, value);
    pl_quantity_text(ratio->low, "1", low);
    pl_quantity_text(ratio->high, "1", high);
    if (isnan(ratio->value))
        snprintf(text, PL_SWEEP_TEXT_SIZE, "%s", pl_quantity_missing);
    else if (isnan(ratio->low))
        snprintf(text, PL_SWEEP_TEXT_SIZE, "%.60s", value);
    else
        snprintf(text, PL_SWEEP_TEXT_SIZE, "%.60s (%.60s to %.60s)", value, low, high);
}

void pl_sweep_power_text(double value, char text[PL_SWEEP_TEXT_SIZE])
{
    char power[32]; /* "1e-03" */
    snprintf(power, sizeof power, "%.0e", value);
    char *e = strchr(power, 'e');
    int exponent = e == NULL ? 0 : (int)strtol(e + 1, NULL, 10);
    snprintf(text, PL_SWEEP_TEXT_SIZE, "%.*se%d", e == NULL ? 8 : (int)(e - power), power,
             exponent);
}

void pl_sweep_error_text(double error, const char *unit, char text[PL_SWEEP_TEXT_SIZE])
{
    char number[PL_QUANTITY_SIZE];
    bool bare = unit[0] == '\0' || (unit[0] == '1' && unit[1] == '\0');
    if (error <= pl_sweep_error_floor) {
        char floor[PL_SWEEP_TEXT_SIZE];
        pl_sweep_power_text(pl_sweep_error_floor, floor);
        snprintf(text, PL_SWEEP_TEXT_SIZE, "≤ %.20s%s%.40s", floor, bare ? "" : " ",
                 bare ? "" : unit);
        return;
    }
    pl_quantity_text(error, bare ? "1" : unit, number);
    snprintf(text, PL_SWEEP_TEXT_SIZE, "%s", number);
}

void pl_sweep_step_text(double dt, char text[PL_SWEEP_TEXT_SIZE])
{
    double whole = round(1 / dt);
    if (whole > 1 && whole < 1e6 && fabs(whole * dt - 1) < 1e-12)
        snprintf(text, PL_SWEEP_TEXT_SIZE, "1/%.0f s", whole);
    else
        snprintf(text, PL_SWEEP_TEXT_SIZE, "%.6g s", dt);
}

void pl_sweep_cost_text(double cost, char text[PL_SWEEP_TEXT_SIZE])
{
    char number[PL_QUANTITY_SIZE];
    pl_quantity_text(cost, "s", number);
    snprintf(text, PL_SWEEP_TEXT_SIZE, "%s", number);
}
