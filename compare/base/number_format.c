#include "number_format.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char pl_no_number[] = "–";

typedef struct scale {
    double factor;
    const char *unit;
} scale;

/* The largest unit first; the last one serves everything smaller. */
static const scale time_scales[] = {{1, "s"}, {1e-3, "ms"}, {1e-6, "µs"}, {1e-9, "ns"}};
static const scale byte_scales[] = {{1e9, "GB"}, {1e6, "MB"}, {1e3, "kB"}, {1, "B"}};

/* Writes a number as a power of ten with `places` places: "1.20e-7". */
static void power_of_ten(double value, int places, char text[32])
{
    snprintf(text, 32, "%.*e", places, value);
    char *e = strchr(text, 'e');
    if (e != NULL) { /* "e-07" */
        snprintf(e + 1, 8, "%d", (int)strtol(e + 1, NULL, 10));
    }
}

/* Writes three significant digits; numbers of four or five digits stay whole, which reads better
 * than a power. */
static void digits(double value, char text[32])
{
    double size = fabs(value);
    if (size == 0) {
        snprintf(text, 32, "0");
    } else if (size < 0.9995e-3 || size >= 99999.5) {
        power_of_ten(value, 2, text);
    } else {
        int places = 2 - (int)floor(log10(size * 1.0005));
        snprintf(text, 32, "%.*f", places > 0 ? places : 0, value);
    }
}

/* Writes a spread with as many places as the text of its number, and at least one digit. */
static void spread_digits(double spread, const char *number, char text[32])
{
    const char *point = strchr(number, '.');
    const double size = fabs(spread);
    if (size < 0.9995e-3 || size >= 99999.5 || strchr(number, 'e') != NULL) {
        digits(spread, text);
    } else {
        const int places = point == NULL ? 0 : (int)strlen(point + 1);
        const int least = -(int)floor(log10(size * 1.05));
        snprintf(text, 32, "%.*f", places > least ? places : least, spread);
    }
}

/* The scale in which a number of this unit is written. */
static scale scale_of(double value, const char *unit)
{
    const bool is_bytes = strcmp(unit, "bytes") == 0 || strcmp(unit, "B") == 0;
    if (!is_bytes && (strcmp(unit, "s") != 0 || value == 0)) {
        return (scale){1, strcmp(unit, "1") == 0 ? "" : unit};
    }
    const scale *scales = is_bytes ? byte_scales : time_scales;
    int i = 0;
    while (i < 3 && fabs(value) < 0.9995 * scales[i].factor) {
        ++i;
    }
    return scales[i];
}

void pl_format_number(double value, const char *unit, char text[PL_QUANTITY_SIZE])
{
    if (!isfinite(value)) {
        snprintf(text, PL_QUANTITY_SIZE, "%s", pl_no_number);
        return;
    }
    const scale in = scale_of(value, unit);
    char number[32];
    digits(value / in.factor, number);
    snprintf(text, PL_QUANTITY_SIZE, "%s%s%.40s", number, in.unit[0] == '\0' ? "" : " ", in.unit);
}

void pl_format_spread(double value, double spread, const char *unit, char text[PL_QUANTITY_SIZE])
{
    const scale in = scale_of(value, unit);
    char number[32], around[32];
    digits(value / in.factor, number);
    spread_digits(spread / in.factor, number, around);
    snprintf(text, PL_QUANTITY_SIZE, "%s ± %s%s%.20s", number, around,
             in.unit[0] == '\0' ? "" : " ", in.unit);
}

void pl_format_given(double value, const char *unit, char text[PL_QUANTITY_SIZE])
{
    bool bare = strcmp(unit, "1") == 0 || unit[0] == '\0';
    if (!isfinite(value)) {
        snprintf(text, PL_QUANTITY_SIZE, "%s", pl_no_number);
    } else {
        snprintf(text, PL_QUANTITY_SIZE, "%.6g%s%.40s", value, bare ? "" : " ", bare ? "" : unit);
    }
}

void pl_format_ratio(double ratio, char text[PL_QUANTITY_SIZE])
{
    if (isinf(ratio)) {
        snprintf(text, PL_QUANTITY_SIZE, "×∞");
        return;
    }
    if (isnan(ratio)) {
        snprintf(text, PL_QUANTITY_SIZE, "%s", pl_no_number);
        return;
    }
    char number[32];
    digits(ratio, number);
    snprintf(text, PL_QUANTITY_SIZE, "×%s", number);
}

void pl_format_power(double value, char text[PL_QUANTITY_SIZE])
{
    power_of_ten(value, 0, text);
}

void pl_format_step(double dt, char text[PL_QUANTITY_SIZE])
{
    double whole = round(1 / dt);
    if (whole > 1 && whole < 1e6 && fabs(whole * dt - 1) < 1e-12) {
        snprintf(text, PL_QUANTITY_SIZE, "1/%.0f s", whole);
    } else {
        snprintf(text, PL_QUANTITY_SIZE, "%.6g s", dt);
    }
}
