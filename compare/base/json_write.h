/* A tree of JSON as text: the bytes that jansson makes with JSON_SORT_KEYS and JSON_REAL_PRECISION(17),
 * in a fraction of its time. */
#ifndef PLUMB_JSON_WRITE_H
#define PLUMB_JSON_WRITE_H

#include "base/text_buffer.h"

#include <jansson.h>

/* How the text is laid out. */
typedef enum pl_json_layout {
    PL_JSON_COMPACT, /* on one line, without blanks: JSON_COMPACT */
    PL_JSON_INDENTED /* an item a line, indented by a space a level: JSON_INDENT(1) */
} pl_json_layout;

/* Adds a value. The buffer has failed when `json` is NULL. */
void pl_text_add_json_tree(pl_text_buffer *out, const json_t *json, pl_json_layout layout);

#endif
