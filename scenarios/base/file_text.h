/* A file's bytes: from a path or standard input, and never more than its kind may have. */
#ifndef PLUMB_FILE_TEXT_H
#define PLUMB_FILE_TEXT_H

#include "plumb/base.h"

#include <stddef.h>

/* A kind of file. */
typedef struct pl_file_kind {
    const char *noun; /* what messages call it, such as "scene" */
    size_t most_bytes;
} pl_file_kind;

/* All of the file ("-" is standard input), malloc'd; the text has no zero at its end. PL_BAD_INPUT:
 * none to read, a directory, too large; PL_IO. */
pl_status pl_file_read(const pl_file_kind *kind, const char *path, char **text, size_t *length,
                       pl_error *error);

/* What messages call a path: itself, or <stdin>. */
const char *pl_file_label(const char *path);

#endif
