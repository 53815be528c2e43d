/* Reads JSON text and files with a reader of the caller, and reports every fault at
 * FILE:LINE:COLUMN. */
#ifndef PLUMB_JSON_TEXT_H
#define PLUMB_JSON_TEXT_H

#include "diagnostic.h"

#include <jansson.h>

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

#endif
