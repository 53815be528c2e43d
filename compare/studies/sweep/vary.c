/* Parses what a sweep varies. */
#include "vary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct pl_numbers {
    double *items; /* (count), owned */
    int count;
} pl_numbers;

enum { LONGEST_NUMBER = 64 };

/* The distance, in steps, up to which a step that misses the end of its range still ends on it. */
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

/* Reads the first `length` characters as a number. */
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

/* Reads the text after the ':'; NULL: there is none. */
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

/* Appends the number, or the numbers of the range, that one text stands for. */
static pl_status pl_vary_range(const char *text, pl_numbers *numbers, pl_error *error)
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

/* Splits "OWNER.KEY" of `length` characters. A key has no '.'; an engine's name may have one. */
static pl_status read_key(const char *text, size_t length, pl_vary *vary, pl_error *error)
{
    size_t owner = length;
    while (owner > 0 && text[owner - 1] != '.') {
        --owner;
    }
    const size_t key_length = length - owner;
    const size_t owner_length = owner == 0 ? 0 : owner - 1;
    if (key_length == 0 || (owner > 0 && owner_length == 0) || key_length >= sizeof vary->key ||
        owner_length >= sizeof vary->owner) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--vary takes KEY=VALUES or ENGINE.KEY=VALUES; found \"%.200s\"", text);
    }
    memcpy(vary->owner, text, owner_length);
    memcpy(vary->key, text + owner, key_length);
    if (strcmp(vary->key, "solver") == 0) {
        snprintf(vary->key, sizeof vary->key, "%s", PL_VARY_PROFILE);
    }
    return PL_OK;
}

static pl_status add_name(pl_vary *vary, const char *name, pl_error *error)
{
    for (int i = 0; i < vary->count; ++i) {
        if (strcmp(vary->names[i], name) == 0) {
            return PL_OK;
        }
    }
    char **grown = realloc(vary->names, ((size_t)vary->count + 1) * sizeof *grown);
    char *copy = strdup(name);
    vary->names = grown == NULL ? vary->names : grown;
    if (grown == NULL || copy == NULL) {
        free(copy);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %s", name);
    }
    vary->names[vary->count++] = copy;
    return PL_OK;
}

typedef struct placed {
    double value;
    int place;
} placed;

static int by_value(const void *left, const void *right)
{
    const placed *a = left, *b = right;
    if (a->value != b->value) {
        return a->value < b->value ? -1 : 1;
    }
    return (a->place > b->place) - (a->place < b->place);
}

static int by_place(const void *left, const void *right)
{
    const placed *a = left, *b = right;
    return (a->place > b->place) - (a->place < b->place);
}

/* Keeps the first of equal numbers, in the order given. */
static pl_status drop_doubles(pl_numbers *numbers, pl_error *error)
{
    placed *sorted = malloc(((size_t)numbers->count + 1) * sizeof *sorted);
    if (sorted == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d values", numbers->count);
    }
    for (int i = 0; i < numbers->count; ++i) {
        sorted[i] = (placed){numbers->items[i], i};
    }
    qsort(sorted, (size_t)numbers->count, sizeof *sorted, by_value);
    int kept = 0;
    for (int i = 0; i < numbers->count; ++i) {
        if (i == 0 || sorted[i].value != sorted[kept - 1].value) {
            sorted[kept++] = sorted[i];
        }
    }
    qsort(sorted, (size_t)kept, sizeof *sorted, by_place);
    for (int i = 0; i < kept; ++i) {
        numbers->items[i] = sorted[i].value;
    }
    numbers->count = kept;
    free(sorted);
    return PL_OK;
}

static pl_status read_values(char *values, pl_vary *vary, pl_error *error)
{
    const bool are_names = strcmp(vary->key, PL_VARY_PROFILE) == 0;
    pl_numbers numbers = {.count = 0};
    pl_status status = PL_OK;
    for (char *rest = values; status == PL_OK && rest != NULL;) {
        const char *value = strsep(&rest, ",");
        if (value[0] == '\0') {
            status = pl_fail(error, PL_BAD_INPUT, "a value is missing");
        } else {
            status =
                are_names ? add_name(vary, value, error) : pl_vary_range(value, &numbers, error);
        }
    }
    if (status == PL_OK && !are_names) {
        status = drop_doubles(&numbers, error);
    }
    if (!are_names) {
        vary->numbers = numbers.items;
        vary->count = numbers.count;
    }
    return status;
}

pl_status pl_vary_parse(const char *text, pl_vary *vary, pl_error *error)
{
    *vary = (pl_vary){.count = 0};
    const char *equals = strchr(text, '=');
    if (equals == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "--vary takes KEY=VALUES; found \"%.200s\"", text);
    }
    char *values = strdup(equals + 1);
    if (values == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for --vary");
    }
    pl_error why = {.message = ""};
    pl_status status = read_key(text, (size_t)(equals - text), vary, error);
    if (status == PL_OK) {
        status = read_values(values, vary, &why);
        if (status != PL_OK) {
            /* Another key takes numbers; it may be a misspelt key of names. */
            static const char *const of_names[] = {"solver", PL_VARY_PROFILE};
            const bool is_profile = strcmp(vary->key, PL_VARY_PROFILE) == 0;
            char suggestion[PL_SUGGESTION_SIZE];
            pl_did_you_mean(vary->key, of_names, is_profile ? 0 : 2, suggestion);
            pl_fail(error, status, "--vary %.*s: %s%s", (int)(equals - text), text, why.message,
                    suggestion);
        }
    }
    free(values);
    if (status != PL_OK) {
        pl_vary_free(vary);
    }
    return status;
}

void pl_vary_free(pl_vary *vary)
{
    for (int i = 0; vary->names != NULL && i < vary->count; ++i) {
        free(vary->names[i]);
    }
    free(vary->names);
    free(vary->numbers);
    *vary = (pl_vary){.count = 0};
}
