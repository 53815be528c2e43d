#include "memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64 };

struct pe_arena_extra {
    struct pe_arena_extra *next;
};

pe_status(pe_fail)(pe_error *error, pe_status status, const char *format, ...)
{
    if (error != NULL) {
        va_list arguments;
        va_start(arguments, format);
        error->status = status;
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
    }
    return status;
}

static size_t round_up(size_t size)
{
    return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

static void *default_allocate(void *context, size_t size)
{
    (void)context;
    return aligned_alloc(ALIGNMENT, round_up(size));
}

static void default_release(void *context, void *memory)
{
    (void)context;
    free(memory);
}

pe_allocator pe_allocator_default(void)
{
    return (pe_allocator){.allocate = default_allocate, .release = default_release};
}

void pe_release(const pe_allocator *allocator, void *memory)
{
    if (memory != NULL) {
        allocator->release(allocator->context, memory);
    }
}

pe_status pe_array_reserve(pe_array *array, const pe_allocator *allocator, size_t stride,
                           size_t count, size_t used, pe_error *error)
{
    if (count <= array->capacity) {
        return PE_OK;
    }
    size_t capacity = array->capacity + array->capacity / 2;
    capacity = capacity < count ? count : capacity;
    capacity = capacity < 16 ? 16 : capacity;
    void *items = capacity <= SIZE_MAX / 2 / stride
                      ? allocator->allocate(allocator->context, capacity * stride)
                      : NULL;
    if (items == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu items of %zu bytes", capacity,
                       stride);
    }
    if (used > 0) {
        memcpy(items, array->items, used * stride);
    }
    pe_release(allocator, array->items);
    array->items = items;
    array->capacity = capacity;
    return PE_OK;
}

void pe_array_free(pe_array *array, const pe_allocator *allocator)
{
    pe_release(allocator, array->items);
    *array = (pe_array){0};
}

void *pe_arena_take(pe_arena *arena, const pe_allocator *allocator, size_t count, size_t stride)
{
    if (count > SIZE_MAX / 2 / stride) {
        arena->failed = true;
        return NULL;
    }
    size_t size = round_up(count * stride);
    arena->wanted += size;
    arena->most = arena->most > arena->wanted ? arena->most : arena->wanted;
    if (size <= arena->capacity - arena->used) {
        char *taken = arena->block + arena->used;
        arena->used += size;
        return taken;
    }
    struct pe_arena_extra *extra = allocator->allocate(allocator->context, ALIGNMENT + size);
    if (extra == NULL) {
        arena->failed = true;
        return NULL;
    }
    extra->next = arena->extras;
    arena->extras = extra;
    return (char *)extra + ALIGNMENT;
}

/* Releases the extra blocks that were taken after `kept`; NULL: all. */
static void release_extras(pe_arena *arena, const pe_allocator *allocator,
                           const struct pe_arena_extra *kept)
{
    while (arena->extras != kept) {
        struct pe_arena_extra *next = arena->extras->next;
        pe_release(allocator, arena->extras);
        arena->extras = next;
    }
}

pe_arena_mark pe_arena_fill(const pe_arena *arena)
{
    return (pe_arena_mark){arena->used, arena->wanted, arena->extras};
}

void pe_arena_rewind(pe_arena *arena, const pe_allocator *allocator, pe_arena_mark mark)
{
    release_extras(arena, allocator, mark.extras);
    arena->used = mark.used;
    arena->wanted = mark.wanted;
}

void pe_arena_reset(pe_arena *arena, const pe_allocator *allocator)
{
    release_extras(arena, allocator, NULL);
    if (arena->most > arena->capacity) {
        /* A quarter more than was needed, so that slow growth does not allocate at each step.
         * Without memory for it the old block stays, and extra blocks are needed again. */
        size_t capacity = round_up(arena->most + arena->most / 4);
        void *block = allocator->allocate(allocator->context, capacity);
        if (block != NULL) {
            pe_release(allocator, arena->block);
            arena->block = block;
            arena->capacity = capacity;
        }
    }
    arena->used = 0;
    arena->wanted = 0;
    arena->most = 0;
    arena->failed = false;
}

void pe_arena_free(pe_arena *arena, const pe_allocator *allocator)
{
    release_extras(arena, allocator, NULL);
    pe_release(allocator, arena->block);
    *arena = (pe_arena){0};
}

uint64_t pe_hash_ints(const int *numbers, int count)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    for (int i = 0; i < count; ++i) {
        hash = (hash ^ (uint32_t)numbers[i]) * UINT64_C(1099511628211);
    }
    return hash;
}
