/* Reads JSON text and files with a reader of the caller, and reports every fault at
 * FILE:LINE:COLUMN. */
#ifndef PLUMB_JSON_TEXT_H
#define PLUMB_JSON_TEXT_H

#include "diagnostic.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/* A kind of file. */
typedef struct pl_json_kind {
    const char *noun; /* what messages call it, such as "scene" */
    size_t most_bytes;
    /* Reads the parsed text, whole numbers as reals. False with a diagnostic, whose path may borrow
     * from `json`, when anything is wrong. */
    bool (*read)(const json_t *json, void *user, pl_diagnostic *diagnostic);
} pl_json_kind;

/* `label` stands for the file's name. PL_BAD_INPUT says LABEL:LINE:COLUMN: path.to.field: what was
 * expected, what was found. */
pl_status pl_json_read_text(const pl_json_kind *kind, const char *text, size_t length,
                            const char *label, void *user, pl_error *error);

/* The same for a file ("-" is standard input), of which no more than kind->most_bytes are read. */
pl_status pl_json_read_file(const pl_json_kind *kind, const char *path, void *user,
                            pl_error *error);

/* ---- A long array, item by item ---- */

/* The items of an array that was taken out of a JSON text. The tree of a whole text is several times
 * as large as the text; that of one item stays in the processor's cache. */
typedef struct pl_json_items {
    const char *text; /* borrowed */
    size_t at, end;   /* the next item; the closing bracket */
    bool is_first;
    bool failed; /* something is no JSON */
} pl_json_items;

/* Takes the array out that an object has at `key`: `items` are its own, and the result is the text
 * without them, malloc'd and *rest_length bytes long. NULL when there is no such array, when the text
 * is no JSON, though not every fault is seen here, and when out of memory. */
char *pl_json_take_out(const char *text, size_t length, const char *key, pl_json_items *items,
                       size_t *rest_length);

/* Goes to the next item. False at the end, and with `failed` at a fault. */
bool pl_json_next_item(pl_json_items *items);

/* Parses the item, and goes behind it. A new reference; NULL with `failed` at a fault or out of
 * memory. */
json_t *pl_json_parse_item(pl_json_items *items);

/* Parses a text as pl_json_read_text does; NULL when it is no JSON, and when out of memory. */
json_t *pl_json_parse(const char *text, size_t length);

#endif
