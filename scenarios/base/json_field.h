/* Typed members of JSON objects, with a diagnostic for every other type. Each function returns
 * false after an error; on true the path of the diagnostic is as before. An absent member that
 * is not required leaves the output as it is, so that defaults are set beforehand. */
#ifndef PLUMB_JSON_FIELD_H
#define PLUMB_JSON_FIELD_H

#include "diagnostic.h"

#include <jansson.h>

/* The keys that an object of a file may have. */
typedef struct pl_key_set {
    const char *object; /* its name in the JSON Schema */
    const char *const *keys;
    int count;
} pl_key_set;

/* The initialiser of a key set from an array of keys. */
#define PL_KEY_SET(name, array)                                                                    \
    {                                                                                              \
        .object = (name), .keys = (array), .count = sizeof(array) / sizeof(array)[0]               \
    }

/* Whether a key may be absent. */
typedef enum pl_presence { PL_OPTIONAL, PL_REQUIRED } pl_presence;

/* The size of the text of pl_json_found, in bytes. */
enum { PL_FOUND_SIZE = 80 };

/* What was found, for messages: "nothing" (NULL), "null", "-1", "\"text\"", "an array of 2", ...
 * Returns `text`. */
const char *pl_json_found(const json_t *json, char text[PL_FOUND_SIZE]);

/* Whether a text of JSON could not be read for want of memory. jansson reports a code for some of its own
 * allocations alone, but a message for every fault of the text. */
bool pl_json_lacked_memory(const json_error_t *fault);

/* Checks that `json`, at the current path, is an object without keys other than those of `keys`. */
bool pl_json_object(const json_t *json, const pl_key_set *keys, pl_diagnostic *diagnostic);

/* The array `key` in *array; NULL when it is absent and optional. */
bool pl_json_array(const json_t *object, const char *key, pl_presence presence,
                   const json_t **array, pl_diagnostic *diagnostic);

/* true or false. */
bool pl_json_bool(const json_t *object, const char *key, bool *value, pl_diagnostic *diagnostic);

/* A number. */
bool pl_json_number(const json_t *object, const char *key, pl_presence presence, double *value,
                    pl_diagnostic *diagnostic);

/* An array of exactly `count` numbers. */
bool pl_json_vector(const json_t *object, const char *key, pl_presence presence, double *values,
                    int count, pl_diagnostic *diagnostic);

/* The same, normalised as written. */
bool pl_json_unit(const json_t *object, const char *key, pl_presence presence, double *values,
                  int count, pl_diagnostic *diagnostic);

/* Makes a vector of n numbers of unit length where people wrote too few digits. */
void pl_normalize_written(double *vector, int n);

/* An array of arrays of three numbers, malloc'd: *triples is (*count). */
bool pl_json_triples(const json_t *object, const char *key, double (**triples)[3], int *count,
                     pl_diagnostic *diagnostic);

/* Borrowed from `object`. `expected` says in a message what the string should be. */
bool pl_json_string(const json_t *object, const char *key, pl_presence presence,
                    const char *expected, const char **value, pl_diagnostic *diagnostic);

/* A name, by the rules of pl_check_name. */
bool pl_json_name(const json_t *object, const char *key, pl_presence presence,
                  char name[PL_NAME_SIZE], pl_diagnostic *diagnostic);

/* The text of a key of an object, borrowed; "" where there is none or it is no text. */
const char *pl_json_get_text(const json_t *object, const char *key);

/* The number of a key of an object; 0 where there is none or it is no number. */
static inline double pl_json_get_number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

/* A JSON string of any bytes: where they are no UTF-8 text, each byte outside of ASCII becomes '?'.
 * Control characters (C0, DEL, C1) but tab and newline become '?' too. */
json_t *pl_json_bytes(const char *bytes, size_t length);

/* The same of a text that ends with a zero. */
json_t *pl_json_text(const char *text);

#endif
