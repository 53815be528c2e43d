/* Identifies the run of a row, and sorts and finds rows.
 *
 * Parameters at their defaults are left out of the key: a parameter that a scenario gets later, and
 * that changes nothing unless it is set, must not make old rows another run. */
#include "gate_rows.h"

#include "plumb/scenario.h"
#include "results/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Separates the parts of a key. No name has this character, and it sorts before those of names. */
static const char part_end[] = "\x01";

static int compare_texts(const void *left, const void *right)
{
    return strcmp(*(const char *const *)left, *(const char *const *)right);
}

static double number_of(const json_t *row, const char *key)
{
    return json_number_value(json_object_get(row, key));
}

/* Writes "name=value" for every parameter, by name. */
static bool print_params(FILE *out, const json_t *params)
{
    size_t count = json_object_size(params), filled = 0;
    const char **names = calloc(count + 1, sizeof *names);
    if (names == NULL) {
        return false;
    }
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)params, name, value)
    {
        names[filled++] = name;
    }
    qsort(names, filled, sizeof *names, compare_texts);
    for (size_t i = 0; i < filled; ++i) {
        fprintf(out, " %s=%.17g", names[i], number_of(params, names[i]));
    }
    free(names);
    return true;
}

static bool make_key(pl_gate_row *row)
{
    size_t size = 0;
    FILE *out = open_memstream(&row->key, &size);
    if (out == NULL) {
        return false;
    }
    fprintf(out, "%s%s", row->scenario, part_end);
    bool printed = print_params(out, json_object_get(row->json, "params"));
    fprintf(out, "%s%.17g%s%.17g%s%.17g%s", part_end, number_of(row->json, "dt"), part_end,
            number_of(row->json, "duration"), part_end, number_of(row->json, "seed"), part_end);
    if (json_object_get(row->json, "member") != NULL) {
        fprintf(out, "%.17g", number_of(row->json, "member"));
    }
    fputs(part_end, out);
    long case_length = ftell(out);
    fputs(row->label, out);
    row->case_length = case_length < 0 ? 0 : (size_t)case_length;
    return fclose(out) == 0 && printed;
}

static void append_number(pl_gate_row *row, const char *what, double value)
{
    size_t length = strlen(row->name);
    snprintf(row->name + length, sizeof row->name - length, " %s=%.6g", what, value);
}

bool pl_gate_row_identify(pl_gate_row *row)
{
    row->scenario = pl_json_get_text(row->json, "scenario");
    row->label = pl_json_get_text(row->json, "engine");
    row->outcome = pl_json_get_text(row->json, "outcome");
    row->verdict = pl_verdict_of(row->json);
    row->metrics = json_object_get(row->json, "metrics");
    snprintf(row->name, sizeof row->name, "%.120s", row->scenario);
    const json_t *params = json_object_get(row->json, "params");
    const pl_scenario *scenario = pl_scenario_find(row->scenario, NULL);
    for (int i = 0; scenario != NULL && i < scenario->param_count; ++i) {
        const json_t *value = json_object_get(params, scenario->params[i].name);
        if (value != NULL && json_number_value(value) != scenario->params[i].value) {
            append_number(row, scenario->params[i].name, json_number_value(value));
        }
    }
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)params, name, value)
    {
        if (scenario == NULL) { /* the defaults of a scene file are not known here */
            append_number(row, name, json_number_value(value));
        }
    }
    if (json_object_get(row->json, "member") != NULL) {
        append_number(row, "member", number_of(row->json, "member"));
    }
    return make_key(row);
}

static int compare_rows(const void *left, const void *right)
{
    const pl_gate_row *a = left, *b = right;
    return strcmp(a->key, b->key);
}

void pl_gate_rows_sort(pl_gate_rows *rows)
{
    if (rows->count > 0) {
        qsort(rows->items, (size_t)rows->count, sizeof *rows->items, compare_rows);
    }
}

/* Returns the bytes of the key up to the end of the parameters. */
static size_t scene_length(const pl_gate_row *row)
{
    size_t length = strcspn(row->key, part_end) + 1;
    return length + strcspn(row->key + length, part_end);
}

/* Whether another run has the same name. */
static bool has_same_name(const pl_gate_rows *rows, const pl_gate_row *row)
{
    size_t length = scene_length(row);
    for (int i = 0; rows != NULL && i < rows->count; ++i) {
        const pl_gate_row *other = &rows->items[i];
        if (strcmp(other->label, row->label) == 0 && scene_length(other) == length &&
            strncmp(other->key, row->key, length) == 0 && strcmp(other->key, row->key) != 0) {
            return true;
        }
    }
    return false;
}

static void disambiguate(pl_gate_rows *rows, const pl_gate_rows *other)
{
    for (int i = 0; i < rows->count; ++i) {
        pl_gate_row *row = &rows->items[i];
        if (has_same_name(rows, row) || has_same_name(other, row)) {
            append_number(row, "dt", number_of(row->json, "dt"));
            append_number(row, "duration", number_of(row->json, "duration"));
            append_number(row, "seed", number_of(row->json, "seed"));
        }
    }
}

void pl_gate_rows_disambiguate(pl_gate_rows *rows, pl_gate_rows *other)
{
    disambiguate(rows, other);
    if (other != NULL) {
        disambiguate(other, rows);
    }
}

const pl_gate_row *pl_gate_rows_find(const pl_gate_rows *rows, const char *key)
{
    const pl_gate_row wanted = {.key = (char *)key};
    return rows->count == 0 ? NULL
                            : bsearch(&wanted, rows->items, (size_t)rows->count,
                                      sizeof *rows->items, compare_rows);
}

const pl_gate_row *pl_gate_rows_same_case(const pl_gate_rows *rows, const pl_gate_row *row,
                                          const char *label)
{
    for (int i = 0; i < rows->count; ++i) {
        const pl_gate_row *other = &rows->items[i];
        if (other->case_length == row->case_length &&
            strncmp(other->key, row->key, row->case_length) == 0 &&
            strcmp(other->label, label) == 0) {
            return other;
        }
    }
    return NULL;
}

bool pl_gate_row_is_ok(const pl_gate_row *row)
{
    return strcmp(row->outcome, "ok") == 0;
}

void pl_gate_row_free(pl_gate_row *row)
{
    json_decref(row->json);
    json_decref(row->reasons);
    json_decref(row->spread);
    json_decref(row->measured);
    free(row->key);
    free(row->samples);
    *row = (pl_gate_row){0};
}

void pl_gate_rows_free(pl_gate_rows *rows)
{
    for (int i = 0; i < rows->count; ++i) {
        pl_gate_row_free(&rows->items[i]);
    }
    free(rows->items);
    *rows = (pl_gate_rows){0};
}
