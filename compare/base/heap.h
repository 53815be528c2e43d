/* Memory of the program. Where none is left these functions end the process with exit code 3 and a message, so
 * their callers have no such case: the runs that ended are on disk, and each engine runs in a process of its own.
 * Libraries that adapters link report PL_NO_MEMORY instead. A returned pointer is never NULL, and the caller frees
 * it. */
#ifndef PLUMB_HEAP_H
#define PLUMB_HEAP_H

#include "base/text_buffer.h"

#include <jansson.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

/* Ends the process with this message, a line, and exit code 3. */
_Noreturn void pl_out_of_memory(void);
extern const char pl_out_of_memory_message[];

/* Makes jansson end the process in the same way: its functions then fail only for wrong arguments. Call it before
 * the first of them. */
void pl_heap_guard_json(void);

/* `count` elements of `size` bytes, all zero. */
void *pl_heap_new(size_t count, size_t size);

/* A copy of the text. */
char *pl_heap_copy(const char *text);

/* Text as of printf. */
__attribute__((format(printf, 1, 2))) char *pl_heap_format(const char *format, ...);

/* Text as of vprintf. */
__attribute__((format(printf, 1, 0))) char *pl_heap_format_list(const char *format,
                                                                va_list arguments);

/* Any value of JSON as text with sorted keys and 17 significant digits. `layout` is JSON_COMPACT or JSON_INDENT(n). */
char *pl_heap_json(const json_t *value, size_t layout);

/* pl_array_push where memory does not end. */
void pl_push(void *items, int *count, const void *item, size_t size);

/* The text of the buffer, "" for one to which nothing was added. The buffer is then empty. */
char *pl_text_take(pl_text_buffer *text);

/* Writes the text of the buffer, which is empty then. */
void pl_text_print(pl_text_buffer *text, FILE *out);

#endif
