#include "vary.h"

#include "vary_range.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Splits "OWNER.KEY", which has `length` characters. A key has no '.'; the name of an engine may.
 */
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

/* Leaves the first of equal numbers, in the order given. */
static pl_status drop_doubles(pl_numbers *numbers, pl_error *error)
{
    placed *sorted = malloc((size_t)numbers->count * sizeof *sorted);
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

/* A key of names that this one, which takes numbers, is nearly; NULL when there is none. */
static const char *meant_key(const char *key)
{
    static const char *const keys[] = {"solver", PL_VARY_PROFILE};
    return strcmp(key, PL_VARY_PROFILE) == 0 ? NULL : pl_nearest_name(key, keys, 2);
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
            const char *meant = meant_key(vary->key);
            pl_fail(error, status, "--vary %.*s: %s%s%s%s", (int)(equals - text), text, why.message,
                    meant == NULL ? "" : "; did you mean ", meant == NULL ? "" : meant,
                    meant == NULL ? "" : "?");
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
