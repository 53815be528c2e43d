#include "heap.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { EXIT_FAILED = 3 }; /* PL_EXIT_FAILED of the command */

const char pl_out_of_memory_message[] =
    "plumb: out of memory; runs that ended are in their results.jsonl\n";

_Noreturn void pl_out_of_memory(void)
{
    (void)!write(STDERR_FILENO, pl_out_of_memory_message, strlen(pl_out_of_memory_message));
    _exit(EXIT_FAILED);
}

/* `memory`, of `size` bytes, which is NULL for 0 bytes too. */
static void *checked(void *memory, size_t size)
{
    if (memory == NULL && size > 0) {
        pl_out_of_memory();
    }
    return memory;
}

static void *allocate(size_t size)
{
    return checked(malloc(size), size);
}

void pl_heap_guard_json(void)
{
    json_set_alloc_funcs(allocate, free);
}

void *pl_heap_new(size_t count, size_t size)
{
    return checked(calloc(count > 0 ? count : 1, size), 1);
}

char *pl_heap_copy(const char *text)
{
    return checked(strdup(text), 1);
}

char *pl_heap_format_list(const char *format, va_list arguments)
{
    char *text;
    return checked(vasprintf(&text, format, arguments) < 0 ? NULL : text, 1);
}

char *pl_heap_format(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *text = pl_heap_format_list(format, arguments);
    va_end(arguments);
    return text;
}

char *pl_heap_json(const json_t *value, size_t layout)
{
    const size_t flags = layout | JSON_SORT_KEYS | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17);
    return checked(json_dumps(value, flags), 1);
}

void pl_push(void *items, int *count, const void *item, size_t size)
{
    if (pl_array_push(items, count, item, size, NULL) != PL_OK) {
        pl_out_of_memory();
    }
}

char *pl_text_take(pl_text_buffer *text)
{
    if (text->failed) {
        pl_out_of_memory();
    }
    char *taken = text->data != NULL ? text->data : pl_heap_copy("");
    *text = (pl_text_buffer){0};
    return taken;
}

void pl_text_print(pl_text_buffer *text, FILE *out)
{
    char *whole = pl_text_take(text);
    fputs(whole, out);
    free(whole);
}
