#include "memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64 };

/* A new block of an arena has at least this part of what is in use, so that there are few of them. */
enum { GROWTH = 64 };

/* What is given out begins ALIGNMENT bytes after the block. */
struct pe_arena_block {
    struct pe_arena_block *before;
    size_t capacity; /* bytes */
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

/* A block for at least `size` bytes: the spare one, if it is large enough. NULL when out of memory. */
static struct pe_arena_block *take_block(pe_arena *arena, const pe_allocator *allocator,
                                         size_t size)
{
    struct pe_arena_block *block = arena->spare;
    if (block != NULL && block->capacity >= size) {
        arena->spare = NULL;
        return block;
    }
    const size_t grown = round_up(arena->wanted / GROWTH);
    const size_t least = grown < arena->least ? arena->least : grown;
    size = size < least ? least : size;
    block = allocator->allocate(allocator->context, ALIGNMENT + size);
    if (block != NULL) {
        block->capacity = size;
    }
    return block;
}

void *pe_arena_take(pe_arena *arena, const pe_allocator *allocator, size_t count, size_t stride)
{
    if (count > SIZE_MAX / 2 / stride) {
        arena->failed = true;
        return NULL;
    }
    size_t size = round_up(count * stride);
    if (arena->last == NULL || size > arena->last->capacity - arena->used) {
        struct pe_arena_block *block = take_block(arena, allocator, size);
        if (block == NULL) {
            arena->failed = true;
            return NULL;
        }
        block->before = arena->last;
        arena->last = block;
        arena->used = 0;
    }
    arena->wanted += size;
    arena->most = arena->most > arena->wanted ? arena->most : arena->wanted;
    char *taken = (char *)arena->last + ALIGNMENT + arena->used;
    arena->used += size;
    return taken;
}

/* Leaves the last block, which stays as the spare one if it is larger than that. */
static void leave_block(pe_arena *arena, const pe_allocator *allocator)
{
    struct pe_arena_block *left = arena->last;
    arena->last = left->before;
    if (arena->spare == NULL || arena->spare->capacity < left->capacity) {
        pe_release(allocator, arena->spare);
        arena->spare = left;
    } else {
        pe_release(allocator, left);
    }
}

pe_arena_mark pe_arena_fill(const pe_arena *arena)
{
    return (pe_arena_mark){arena->last, arena->used, arena->wanted};
}

void pe_arena_rewind(pe_arena *arena, const pe_allocator *allocator, pe_arena_mark mark)
{
    while (arena->last != mark.last) {
        leave_block(arena, allocator);
    }
    arena->used = mark.used;
    arena->wanted = mark.wanted;
}

/* Whether the blocks are to be replaced: by one, and by a smaller one where much has not been needed for
 * long. Small arenas keep what they have. */
static bool is_ill_sized(pe_arena *arena)
{
    enum { KEPT = 1 << 20, PART = 2, PATIENCE = 60 };
    const size_t capacity = arena->last->capacity;
    const bool slack = capacity > KEPT && arena->most < capacity / PART;
    arena->slack = slack ? arena->slack + 1 : 0;
    return arena->most > capacity || arena->slack > PATIENCE;
}

void pe_arena_reset(pe_arena *arena, const pe_allocator *allocator)
{
    if (arena->last != NULL && is_ill_sized(arena)) {
        /* A quarter more than was needed, so that slow growth does not allocate at each step. Without
         * memory for it the old blocks stay, and others are needed again. */
        const size_t most = arena->most + arena->most / 4, least = arena->least;
        struct pe_arena_block *block = take_block(arena, allocator, round_up(most));
        if (block != NULL) {
            block->before = NULL;
            pe_arena_free(arena, allocator);
            arena->last = block;
            arena->least = least;
        }
    }
    while (arena->last != NULL && arena->last->before != NULL) {
        leave_block(arena, allocator);
    }
    if (arena->spare != NULL &&
        (arena->last == NULL || arena->spare->capacity > arena->last->capacity)) {
        struct pe_arena_block *first = arena->last;
        arena->last = arena->spare;
        arena->last->before = NULL;
        arena->spare = first;
    }
    pe_release(allocator, arena->spare);
    arena->spare = NULL;
    arena->used = 0;
    arena->wanted = 0;
    arena->most = 0;
    arena->failed = false;
}

void pe_arena_free(pe_arena *arena, const pe_allocator *allocator)
{
    while (arena->last != NULL) {
        struct pe_arena_block *before = arena->last->before;
        pe_release(allocator, arena->last);
        arena->last = before;
    }
    pe_release(allocator, arena->spare);
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
