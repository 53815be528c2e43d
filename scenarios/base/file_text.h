/* Reads files whole: from a path or standard input, up to the size that their kind may have. */
#ifndef PLUMB_FILE_TEXT_H
#define PLUMB_FILE_TEXT_H

#include "plumb/base.h"

#include <stddef.h>

/* A kind of file. */
typedef struct pl_file_kind {
    const char *noun; /* what messages call it, such as "scene" */
    size_t most_bytes;
} pl_file_kind;

/* Reads all of a file ("-" is standard input). *text is malloc'd; *length does not count the zero
 * at its end. PL_BAD_INPUT: there is no such file, it is a directory, or it is too large. PL_IO. */
pl_status pl_file_read(const pl_file_kind *kind, const char *path, char **text, size_t *length,
                       pl_error *error);

/* The same for an open file, which it closes. `label` stands for the file's name. */
pl_status pl_file_read_open(const pl_file_kind *kind, int descriptor, const char *label,
                            char **text, size_t *length, pl_error *error);

/* The bytes of a UTF-8 byte order mark at the beginning of a text: 3, or 0 where there is none. */
size_t pl_byte_order_mark(const char *text, size_t length);

/* The name of a path in messages: the path itself, or "stdin" in angle brackets for "-". */
const char *pl_file_label(const char *path);

#endif
