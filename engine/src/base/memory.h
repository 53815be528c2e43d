/* Memory of a world: growing arrays that live as long as it does, and an arena for the data of one
 * step. */
#ifndef PE_MEMORY_H
#define PE_MEMORY_H

#include "plumb/engine.h"

/* Fills `error` (when not NULL) as printf does and returns `status`. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
pe_status
pe_fail(pe_error *error, pe_status status, const char *format, ...);

/* clang's static analyzer sees one file at a time: this tells it what pe_fail returns. */
#ifdef __clang_analyzer__
#define pe_fail(error, status, ...) (pe_fail(error, status, __VA_ARGS__), (status))
#endif

/* An allocator of aligned_alloc and free. */
pe_allocator pe_allocator_default(void);

/* Gives memory back to the allocator. NULL is allowed. */
void pe_release(const pe_allocator *allocator, void *memory);

/* A growing array of plain data. All zero is the empty array. */
typedef struct pe_array {
    void *items;
    size_t capacity; /* in items */
} pe_array;

/* Makes room for `count` items of `stride` bytes and keeps the first `used` items. The array grows
 * by at least a half, so that a scene that stops growing stops allocating. On PE_NO_MEMORY the
 * array is as it was. */
pe_status pe_array_reserve(pe_array *array, const pe_allocator *allocator, size_t stride,
                           size_t count, size_t used, pe_error *error);

/* Releases the items; the array is empty then. */
void pe_array_free(pe_array *array, const pe_allocator *allocator);

/* Blocks from which a step takes memory, all of which is given back at once. When the last block is full
 * another one is taken, and the next reset makes one of them all. */
typedef struct pe_arena {
    struct pe_arena_block *last,
        *spare;          /* in use, with those before it; the one that was left last */
    size_t used;         /* bytes of the last block */
    size_t wanted, most; /* bytes: in use now, and at most since the last reset */
    int slack;           /* resets in a row by which a far smaller block would have done */
    size_t least;        /* bytes of a new block, at least */
    bool failed;         /* a request since the last reset was refused */
} pe_arena;

/* `count` items of `stride` bytes, aligned to 64 bytes, uninitialised; NULL when out of memory. */
void *pe_arena_take(pe_arena *arena, const pe_allocator *allocator, size_t count, size_t stride);

/* The state of an arena that pe_arena_rewind goes back to. */
typedef struct pe_arena_mark {
    const struct pe_arena_block *last;
    size_t used, wanted;
} pe_arena_mark;

/* The state now. */
pe_arena_mark pe_arena_fill(const pe_arena *arena);

/* Gives back all memory that was taken since the mark. */
void pe_arena_rewind(pe_arena *arena, const pe_allocator *allocator, pe_arena_mark mark);

/* Gives all memory back, for the next step. */
void pe_arena_reset(pe_arena *arena, const pe_allocator *allocator);

/* Releases the arena's own memory. */
void pe_arena_free(pe_arena *arena, const pe_allocator *allocator);

/* FNV-1a over the numbers (Fowler, Noll, Vo 1991). */
uint64_t pe_hash_ints(const int *numbers, int count);

/* The threads of a world (pool.h). */
typedef struct pe_pool pe_pool;

/* Where a function takes memory that its caller gives back, and the threads that it may use. */
typedef struct pe_workspace {
    pe_arena *arena;
    const pe_allocator *allocator;
    pe_pool *pool; /* NULL: the calling thread alone */
} pe_workspace;

/* pe_arena_take of the workspace. */
static inline void *pe_take(pe_workspace work, size_t count, size_t stride)
{
    return pe_arena_take(work.arena, work.allocator, count, stride);
}

#endif
