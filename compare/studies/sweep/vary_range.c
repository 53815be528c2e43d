#include "vary_range.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_NUMBER = 64 };

/* How far a step may miss the end of its range and still end on it, in steps. */
static const double end_slack = 1e-9;

typedef struct range {
    double first, last, step; /* step: added, or the factor */
    bool geometric;
    bool decimal; /* no part is a fraction */
} range;

static pl_status append(pl_numbers *numbers, double value, const char *text, pl_error *error)
{
    if (numbers->count >= PL_VARY_MOST_VALUES) {
        return pl_fail(error, PL_BAD_INPUT, "%s: more than %d values", text,
                       (int)PL_VARY_MOST_VALUES);
    }
    /* Room doubles: at every power of two it is full. */
    if ((numbers->count & (numbers->count - 1)) == 0) {
        size_t room = numbers->count == 0 ? 1 : 2 * (size_t)numbers->count;
        double *grown = realloc(numbers->items, room * sizeof *grown);
        if (grown == NULL) {
            return pl_fail(error, PL_NO_MEMORY, "out of memory for %s", text);
        }
        numbers->items = grown;
    }
    numbers->items[numbers->count++] = value;
    return PL_OK;
}

/* The number that the first `length` characters are. */
static pl_status read_number(const char *text, size_t length, double *value, pl_error *error)
{
    char part[LONGEST_NUMBER];
    if (length < sizeof part) {
        memcpy(part, text, length);
        part[length] = '\0';
    }
    if (length >= sizeof part || !pl_parse_number(part, value)) {
        return pl_fail(error, PL_BAD_INPUT,
                       "\"%.*s\" is no number: expected a decimal or a fraction such as 1/60",
                       length > 200 ? 200 : (int)length, text);
    }
    return PL_OK;
}

static double rounded(const range *r, double value)
{
    char text[32];
    if (!r->decimal) {
        return value;
    }
    snprintf(text, sizeof text, "%.15g", value);
    return strtod(text, NULL);
}

static pl_status append_sums(const range *r, const char *text, pl_numbers *numbers, pl_error *error)
{
    const double steps = floor((r->last - r->first) / r->step + end_slack);
    if (steps >= PL_VARY_MOST_VALUES) {
        return pl_fail(error, PL_BAD_INPUT, "%s: more than %d values", text,
                       (int)PL_VARY_MOST_VALUES);
    }
    pl_status status = PL_OK;
    for (int i = 0; i <= (int)steps && status == PL_OK; ++i) {
        double value = r->first + i * r->step;
        bool is_end = fabs(value - r->last) <= end_slack * r->step;
        status = append(numbers, is_end ? r->last : rounded(r, value), text, error);
    }
    return status;
}

static pl_status append_products(const range *r, const char *text, pl_numbers *numbers,
                                 pl_error *error)
{
    const double slack = end_slack * (r->step - 1);
    pl_status status = PL_OK;
    for (double value = r->first; value <= r->last * (1 + slack) && status == PL_OK;
         value *= r->step) {
        bool is_end = fabs(value - r->last) <= slack * r->last;
        status = append(numbers, is_end ? r->last : rounded(r, value), text, error);
        if (value * r->step <= value) {
            return pl_fail(error, PL_BAD_INPUT, "%s is endless: the factor is too near to 1", text);
        }
    }
    return status;
}

/* `step` is what follows the ':', or NULL. */
static pl_status read_step(const char *text, const char *step, range *r, pl_error *error)
{
    r->step = 1;
    if (step == NULL) {
        return PL_OK;
    }
    if (step[0] != '+' && step[0] != 'x') {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s: after \":\" expected +STEP or xFACTOR, found \"%s\"", text, step);
    }
    r->geometric = step[0] == 'x';
    pl_status status = read_number(step + 1, strlen(step + 1), &r->step, error);
    if (status != PL_OK) {
        return status;
    }
    if (!r->geometric && !(r->step > 0)) {
        return pl_fail(error, PL_BAD_INPUT, "%s is endless: the step must be above 0", text);
    }
    if (r->geometric && !(r->step > 1)) {
        return pl_fail(error, PL_BAD_INPUT, "%s is endless: the factor must be above 1", text);
    }
    if (r->geometric && !(r->first > 0)) {
        return pl_fail(error, PL_BAD_INPUT, "%s is endless: times a factor it must begin above 0",
                       text);
    }
    return PL_OK;
}

pl_status pl_vary_range(const char *text, pl_numbers *numbers, pl_error *error)
{
    const char *dots = strstr(text, "..");
    if (dots == NULL) {
        double value = 0;
        pl_status status = read_number(text, strlen(text), &value, error);
        return status == PL_OK ? append(numbers, value, text, error) : status;
    }
    range r = {.decimal = strchr(text, '/') == NULL};
    const char *end = dots + 2;
    const char *colon = strchr(end, ':');
    size_t end_length = colon == NULL ? strlen(end) : (size_t)(colon - end);
    pl_status status = read_number(text, (size_t)(dots - text), &r.first, error);
    if (status == PL_OK) {
        status = read_number(end, end_length, &r.last, error);
    }
    if (status == PL_OK) {
        status = read_step(text, colon == NULL ? NULL : colon + 1, &r, error);
    }
    if (status != PL_OK) {
        return status;
    }
    if (r.first > r.last) {
        return pl_fail(error, PL_BAD_INPUT, "%s is empty: a range goes up, from %g to %g", text,
                       r.last, r.first);
    }
    return r.geometric ? append_products(&r, text, numbers, error)
                       : append_sums(&r, text, numbers, error);
}
