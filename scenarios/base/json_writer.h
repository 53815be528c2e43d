/* JSON text in the making: strings, numbers and members one after another. */
#ifndef PLUMB_JSON_WRITER_H
#define PLUMB_JSON_WRITER_H

#include <stdbool.h>
#include <stddef.h>

/* Begins as zeros; the text is malloc'd and the caller's. */
typedef struct pl_json_writer {
    char *text;
    size_t length, capacity;
    bool out_of_memory; /* what is put afterwards is lost */
} pl_json_writer;

/* Text as it is. */
void pl_put(pl_json_writer *w, const char *text);

/* A string in quotes, escaped. */
void pl_put_string(pl_json_writer *w, const char *string);

/* JSON has no word for what is not finite: null, which the reader takes where it has a meaning. */
void pl_put_number(pl_json_writer *w, double value);
void pl_put_vector(pl_json_writer *w, const double *values, int count);

/* Members of an object: `before` is what separates it from the member before, with its line breaks.
 */
void pl_put_key(pl_json_writer *w, const char *before, const char *key);
void pl_put_string_member(pl_json_writer *w, const char *before, const char *key,
                          const char *value);
void pl_put_number_member(pl_json_writer *w, const char *before, const char *key, double value);
void pl_put_vector_member(pl_json_writer *w, const char *before, const char *key,
                          const double *values, int count);

#endif
