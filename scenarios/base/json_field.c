#include "json_field.h"

#include "number.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool pl_json_lacked_memory(const json_error_t *fault)
{
    return fault->text[0] == '\0' || json_error_code(fault) == json_error_out_of_memory;
}

const char *pl_json_found(const json_t *json, char text[PL_FOUND_SIZE])
{
    char number[PL_NUMBER_SIZE], quoted[PL_QUOTED_SIZE];
    if (json == NULL) {
        snprintf(text, PL_FOUND_SIZE, "nothing");
    } else if (json_is_string(json)) {
        snprintf(text, PL_FOUND_SIZE, "%s", pl_quoted(json_string_value(json), quoted));
    } else if (json_is_number(json)) {
        snprintf(text, PL_FOUND_SIZE, "%s", pl_number_text(json_number_value(json), number));
    } else if (json_is_array(json)) {
        snprintf(text, PL_FOUND_SIZE, "an array of %zu", json_array_size(json));
    } else if (json_is_object(json)) {
        snprintf(text, PL_FOUND_SIZE, "an object");
    } else {
        snprintf(text, PL_FOUND_SIZE, "%s",
                 json_is_null(json)   ? "null"
                 : json_is_true(json) ? "true"
                                      : "false");
    }
    return text;
}

static bool diagnose_type(pl_diagnostic *diagnostic, const char *key, const char *expected,
                          const json_t *json)
{
    char found[PL_FOUND_SIZE];
    return pl_diagnose_field(diagnostic, key, "expected %s, found %s", expected,
                             pl_json_found(json, found));
}

static bool diagnose_unknown_key(const pl_key_set *keys, const char *key, pl_diagnostic *diagnostic)
{
    char quoted[PL_QUOTED_SIZE];
    diagnostic->at_key = true;
    const char *nearest = pl_nearest_name(key, keys->keys, keys->count);
    if (nearest != NULL) {
        return pl_diagnose_field(diagnostic, key,
                                 "expected a known key, found %s; did you mean \"%s\"?",
                                 pl_quoted(key, quoted), nearest);
    }
    char known[200] = "";
    for (int i = 0; i < keys->count; ++i) {
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", i == 0 ? "" : ", ", keys->keys[i]);
    }
    return pl_diagnose_field(diagnostic, key, "expected one of %s, found %s", known,
                             pl_quoted(key, quoted));
}

bool pl_json_object(const json_t *json, const pl_key_set *keys, pl_diagnostic *diagnostic)
{
    if (!json_is_object(json)) {
        char found[PL_FOUND_SIZE];
        return pl_diagnose(diagnostic, "expected an object, found %s", pl_json_found(json, found));
    }
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)json, key, value)
    {
        bool known = false;
        for (int i = 0; i < keys->count && !known; ++i) {
            known = strcmp(key, keys->keys[i]) == 0;
        }
        if (!known) {
            return diagnose_unknown_key(keys, key, diagnostic);
        }
    }
    return true;
}

bool pl_json_array(const json_t *object, const char *key, pl_presence presence,
                   const json_t **array, pl_diagnostic *diagnostic)
{
    *array = json_object_get(object, key);
    return json_is_array(*array) || (*array == NULL && presence == PL_OPTIONAL) ||
           diagnose_type(diagnostic, key, "an array", *array);
}

bool pl_json_bool(const json_t *object, const char *key, bool *value, pl_diagnostic *diagnostic)
{
    const json_t *json = json_object_get(object, key);
    if (json == NULL) {
        return true;
    }
    if (!json_is_boolean(json)) {
        return diagnose_type(diagnostic, key, "true or false", json);
    }
    *value = json_is_true(json);
    return true;
}

bool pl_json_number(const json_t *object, const char *key, pl_presence presence, double *value,
                    pl_diagnostic *diagnostic)
{
    const json_t *json = json_object_get(object, key);
    if (json == NULL && presence == PL_OPTIONAL) {
        return true;
    }
    if (!json_is_number(json)) {
        return diagnose_type(diagnostic, key, "a number", json);
    }
    *value = json_number_value(json);
    return true;
}

/* An array of exactly `count` numbers, at the path as it stands. */
static bool read_numbers(const json_t *json, double *values, int count, pl_diagnostic *diagnostic)
{
    char found[PL_FOUND_SIZE];
    if (!json_is_array(json) || json_array_size(json) != (size_t)count) {
        return pl_diagnose(diagnostic, "expected an array of %d numbers, found %s", count,
                           pl_json_found(json, found));
    }
    for (int i = 0; i < count; ++i) {
        const json_t *item = json_array_get(json, (size_t)i);
        if (!json_is_number(item)) {
            pl_path_push_index(&diagnostic->path, i);
            return pl_diagnose(diagnostic, "expected a number, found %s",
                               pl_json_found(item, found));
        }
        values[i] = json_number_value(item);
    }
    return true;
}

bool pl_json_vector(const json_t *object, const char *key, pl_presence presence, double *values,
                    int count, pl_diagnostic *diagnostic)
{
    const json_t *json = json_object_get(object, key);
    if (json == NULL && presence == PL_OPTIONAL) {
        return true;
    }
    pl_path_push_key(&diagnostic->path, key);
    if (!read_numbers(json, values, count, diagnostic)) {
        return false;
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* People write few digits: a vector that is almost of unit length is made so. One that is of unit
 * length to rounding stays, so that what was written reads back number for number; any other stays
 * too, and scene_check.c rejects it. */
void pl_normalize_written(double *vector, int n)
{
    const double written_tolerance = 1e-6;
    double norm = pl_norm(vector, n);
    if (fabs(norm - 1) > PL_UNIT_TOLERANCE && fabs(norm - 1) <= written_tolerance) {
        for (int k = 0; k < n; ++k) {
            vector[k] /= norm;
        }
    }
}

bool pl_json_unit(const json_t *object, const char *key, pl_presence presence, double *values,
                  int count, pl_diagnostic *diagnostic)
{
    if (!pl_json_vector(object, key, presence, values, count, diagnostic)) {
        return false;
    }
    pl_normalize_written(values, count);
    return true;
}

static bool read_triples(const json_t *array, double (*triples)[3], pl_diagnostic *diagnostic)
{
    size_t i;
    json_t *item;
    json_array_foreach(array, i, item)
    {
        pl_path_push_index(&diagnostic->path, (int)i);
        if (!read_numbers(item, triples[i], 3, diagnostic)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    return true;
}

bool pl_json_triples(const json_t *object, const char *key, double (**triples)[3], int *count,
                     pl_diagnostic *diagnostic)
{
    const json_t *array;
    if (!pl_json_array(object, key, PL_REQUIRED, &array, diagnostic)) {
        return false;
    }
    double(*made)[3] = malloc(json_array_size(array) * sizeof *made + 1);
    if (made == NULL) {
        return pl_diagnose_no_memory(diagnostic);
    }
    pl_path_push_key(&diagnostic->path, key);
    if (!read_triples(array, made, diagnostic)) {
        free(made);
        return false;
    }
    pl_path_pop(&diagnostic->path);
    *triples = made;
    *count = (int)json_array_size(array);
    return true;
}

bool pl_json_string(const json_t *object, const char *key, pl_presence presence,
                    const char *expected, const char **value, pl_diagnostic *diagnostic)
{
    const json_t *json = json_object_get(object, key);
    if (json == NULL && presence == PL_OPTIONAL) {
        return true;
    }
    if (!json_is_string(json)) {
        return diagnose_type(diagnostic, key, expected, json);
    }
    *value = json_string_value(json);
    return true;
}

bool pl_json_name(const json_t *object, const char *key, pl_presence presence,
                  char name[PL_NAME_SIZE], pl_diagnostic *diagnostic)
{
    const char *value = NULL;
    if (!pl_json_string(object, key, presence, "a name", &value, diagnostic)) {
        return false;
    }
    if (value == NULL) {
        return true;
    }
    pl_path_push_key(&diagnostic->path, key);
    if (!pl_check_name(value, strlen(value), diagnostic)) {
        return false;
    }
    pl_path_pop(&diagnostic->path);
    memcpy(name, value, strlen(value) + 1);
    return true;
}

const char *pl_json_get_text(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text == NULL ? "" : text;
}

json_t *pl_json_bytes(const char *bytes, size_t length)
{
    json_malloc_t take;
    json_free_t give;
    json_get_alloc_funcs(&take, &give);
    char *clean = take(length + 1);
    if (clean == NULL) {
        return NULL;
    }
    for (size_t i = 0; i < length; ++i) {
        unsigned char c = (unsigned char)bytes[i];
        bool control = (c < 0x20 && c != '\n' && c != '\t') || c == 0x7f;
        if (c == 0xc2 && i + 1 < length && (bytes[i + 1] & 0xe0) == 0x80) { /* C1: U+0080..009F */
            clean[i++] = '?';
            control = true;
        }
        clean[i] = control ? '?' : bytes[i];
    }
    json_t *text = json_stringn(clean, length);
    if (text == NULL) {
        for (size_t i = 0; i < length; ++i) {
            clean[i] = (unsigned char)clean[i] < 0x80 ? clean[i] : '?';
        }
        text = json_stringn(clean, length);
    }
    give(clean);
    return text;
}

json_t *pl_json_text(const char *text)
{
    return pl_json_bytes(text, strlen(text));
}
