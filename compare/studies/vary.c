/* Parses what a study varies. */
#include "vary.h"

#include "base/heap.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_NUMBER = 64 };

/* The distance, in steps, up to which a step that misses the end of its range still ends on it. */
static const double end_slack = 1e-9;

/* "A..B:+S" */
typedef struct range {
    const char *text;
    double first, last, step; /* step: added, or the factor */
    bool geometric;
    bool decimal; /* no part is a fraction */
} range;

static pl_status fail_many(const char *text, pl_error *error)
{
    return pl_fail(error, PL_BAD_INPUT, "%s: more than %d values", text, (int)PL_VARY_MOST_VALUES);
}

/* Appends a number, or a name where that is not NULL, unless `seen` has it. `part` is the text that it is of. */
static pl_status append(pl_vary *vary, json_t *seen, double value, const char *name,
                        const char *part, pl_error *error)
{
    char number[32];
    snprintf(number, sizeof number, "%.17g", value + 0.0); /* -0 is 0 */
    const char *text = name == NULL ? number : name;
    if (json_object_get(seen, text) != NULL) {
        return PL_OK;
    }
    if (vary->count >= PL_VARY_MOST_VALUES) {
        return fail_many(part, error);
    }
    json_object_set_new_nocheck(seen, text, json_true());
    if (name == NULL) {
        pl_push(&vary->numbers, &vary->count, &value, sizeof value);
    } else {
        char *copy = pl_heap_copy(name);
        pl_push(&vary->names, &vary->count, &copy, sizeof copy);
    }
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

static pl_status append_range(const range *r, pl_vary *vary, json_t *seen, pl_error *error)
{
    const double slack = end_slack * (r->geometric ? (r->step - 1) * r->last : r->step);
    double value = r->first, before = -HUGE_VAL;
    pl_status status = PL_OK;
    for (int i = 0; status == PL_OK; ++i) {
        value = r->geometric ? value : r->first + i * r->step;
        if (r->geometric ? value > r->last + slack : i * r->step > r->last - r->first + slack) {
            break;
        }
        if (i == PL_VARY_MOST_VALUES) {
            return fail_many(r->text, error);
        }
        if (r->geometric && value <= before) {
            return pl_fail(error, PL_BAD_INPUT, "%s is endless: the factor is too near to 1",
                           r->text);
        }
        const bool is_end = fabs(value - r->last) <= slack;
        status = append(vary, seen, is_end ? r->last : rounded(r, value), NULL, r->text, error);
        before = value;
        value *= r->step;
    }
    return status;
}

/* Reads the text after the ':'; NULL: there is none. */
static pl_status read_step(const char *step, range *r, pl_error *error)
{
    r->step = 1;
    if (step == NULL) {
        return PL_OK;
    }
    if (step[0] != '+' && step[0] != 'x') {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s: after \":\" expected +STEP or xFACTOR, found \"%s\"", r->text, step);
    }
    r->geometric = step[0] == 'x';
    const pl_status status = read_number(step + 1, strlen(step + 1), &r->step, error);
    const char *fault = !r->geometric && !(r->step > 0)   ? "the step must be above 0"
                        : r->geometric && !(r->step > 1)  ? "the factor must be above 1"
                        : r->geometric && !(r->first > 0) ? "times a factor it must begin above 0"
                                                          : NULL;
    return status != PL_OK || fault == NULL
               ? status
               : pl_fail(error, PL_BAD_INPUT, "%s is endless: %s", r->text, fault);
}

/* Reads "A..B", which ends at `end`. */
static pl_status read_ends(const char *end, bool may_be_equal, range *r, pl_error *error)
{
    const char *dots = strstr(r->text, "..");
    pl_status status = read_number(r->text, (size_t)(dots - r->text), &r->first, error);
    if (status == PL_OK) {
        status = read_number(dots + 2, (size_t)(end - dots - 2), &r->last, error);
    }
    if (status == PL_OK && r->first > r->last) {
        return pl_fail(error, PL_BAD_INPUT, "%s is empty: a range goes up, from %g to %g", r->text,
                       r->last, r->first);
    }
    return status != PL_OK || may_be_equal || r->first < r->last
               ? status
               : pl_fail(error, PL_BAD_INPUT, "%s is empty: its ends are equal", r->text);
}

/* Appends the number, or the numbers of the range, that one text stands for. */
static pl_status add_numbers(const char *text, pl_vary *vary, json_t *seen, pl_error *error)
{
    const char *dots = strstr(text, "..");
    if (dots == NULL) {
        double value = 0;
        const pl_status status = read_number(text, strlen(text), &value, error);
        return status == PL_OK ? append(vary, seen, value, NULL, text, error) : status;
    }
    range r = {.text = text, .decimal = strchr(text, '/') == NULL};
    const char *colon = strchr(dots, ':');
    pl_status status = read_ends(colon == NULL ? text + strlen(text) : colon, true, &r, error);
    if (status == PL_OK) {
        status = read_step(colon == NULL ? NULL : colon + 1, &r, error);
    }
    return status == PL_OK ? append_range(&r, vary, seen, error) : status;
}

/* Reads values separated by commas; of equal ones the first counts. */
static pl_status read_values(const char *text, pl_vary *vary, pl_error *error)
{
    const bool are_names = strcmp(vary->key, PL_VARY_PROFILE) == 0;
    char *values = pl_heap_copy(text), *rest = values;
    json_t *seen = json_object();
    pl_status status = PL_OK;
    while (status == PL_OK && rest != NULL) {
        const char *value = strsep(&rest, ",");
        status = value[0] == '\0' ? pl_fail(error, PL_BAD_INPUT, "a value is missing")
                 : are_names      ? append(vary, seen, 0, value, value, error)
                                  : add_numbers(value, vary, seen, error);
    }
    json_decref(seen);
    free(values);
    return status;
}

static pl_status read_range(const char *text, pl_vary *vary, pl_error *error)
{
    range r = {.text = text};
    const pl_status status = read_ends(text + strlen(text), false, &r, error);
    vary->low = r.first;
    vary->high = r.last;
    return status;
}

/* How each form is written. */
static const struct {
    const char *option, *takes;
} forms[] = {[PL_VARY_VALUES] = {"--vary", "KEY=VALUES or ENGINE.KEY=VALUES"},
             [PL_VARY_RANGE] = {"--vary", "KEY=LOW..HIGH"},
             [PL_VARY_KNOWN_RANGE] = {"--vary", "NAME or NAME=LOW..HIGH"},
             [PL_VARY_FIX] = {"--fix", "KEY=VALUE"}};

/* Splits "OWNER.KEY" of `length` characters. A key has no '.'; an engine's name may have one. */
static bool split_key(const char *text, size_t length, pl_vary *vary)
{
    size_t owner = length;
    while (owner > 0 && text[owner - 1] != '.') {
        --owner;
    }
    const size_t key_length = length - owner;
    const size_t owner_length = owner == 0 ? 0 : owner - 1;
    if (key_length == 0 || (owner > 0 && owner_length == 0) || key_length >= sizeof vary->key ||
        owner_length >= sizeof vary->owner) {
        return false;
    }
    memcpy(vary->owner, text, owner_length);
    memcpy(vary->key, text + owner, key_length);
    return true;
}

/* Whether what stands after the key can be of the form; NULL: there is nothing. */
static bool fits(pl_vary_form form, const char *rest)
{
    const bool has_range = rest != NULL && strstr(rest, "..") != NULL;
    return form == PL_VARY_RANGE         ? has_range
           : form == PL_VARY_KNOWN_RANGE ? rest == NULL || has_range
                                         : rest != NULL;
}

static pl_status read_rest(const char *rest, pl_vary_form form, pl_vary *vary, pl_error *error)
{
    double value = 0;
    if (form == PL_VARY_VALUES) {
        return read_values(rest, vary, error);
    }
    if (form != PL_VARY_FIX) {
        return rest == NULL ? PL_OK : read_range(rest, vary, error);
    }
    const pl_status status = read_number(rest, strlen(rest), &value, error);
    if (status == PL_OK) {
        pl_push(&vary->numbers, &vary->count, &value, sizeof value);
    }
    return status;
}

pl_status pl_vary_parse(const char *text, pl_vary_form form, pl_vary *vary, pl_error *error)
{
    const size_t length = strcspn(text, "=");
    const char *rest = text[length] == '\0' ? NULL : text + length + 1;
    pl_error why = {.message = ""};
    *vary = (pl_vary){.low = (double)NAN, .high = (double)NAN};
    if (!split_key(text, length, vary) || !fits(form, rest)) {
        *vary = (pl_vary){.count = 0};
        return pl_fail(error, PL_BAD_INPUT, "%s takes %s; found \"%.200s\"", forms[form].option,
                       forms[form].takes, text);
    }
    if (form == PL_VARY_VALUES && strcmp(vary->key, "solver") == 0) {
        snprintf(vary->key, sizeof vary->key, "%s", PL_VARY_PROFILE);
    }
    const pl_status status = read_rest(rest, form, vary, &why);
    if (status != PL_OK) {
        /* Another key takes numbers; it may be a misspelt key of names. */
        static const char *const of_names[] = {"solver", PL_VARY_PROFILE};
        const bool is_other = form == PL_VARY_VALUES && strcmp(vary->key, PL_VARY_PROFILE) != 0;
        char suggestion[PL_SUGGESTION_SIZE];
        pl_did_you_mean(vary->key, of_names, is_other ? 2 : 0, suggestion);
        pl_fail(error, status, "%s %.*s: %s%s", forms[form].option, (int)length, text, why.message,
                suggestion);
        pl_vary_free(vary);
    }
    return status;
}

bool pl_vary_is_of(const pl_vary *vary, const char *name)
{
    return vary->owner[0] == '\0' || strcmp(vary->owner, name) == 0;
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
