/* An arena: memory that is allocated piece by piece and freed together. An arena starts as {0}.
 *
 *     pl_arena arena = {0};
 *     double *mass = pl_arena_take(&arena, body_count, sizeof *mass);
 *     ...
 *     pl_arena_free(&arena);
 *
 * Memory that ends ends the process. */
#ifndef PLUMB_ARENA_H
#define PLUMB_ARENA_H

#include <stddef.h>

/* The pieces of memory that are freed together. */
typedef struct pl_arena {
    struct pl_arena_block *blocks; /* the pieces, last first */
} pl_arena;

/* `count` zeroed items of `size` bytes, aligned for any type. A count of 0 gives a pointer that must not
 * be read. */
void *pl_arena_take(pl_arena *arena, size_t count, size_t size);

/* Makes room for at least `wanted` items in the array whose address is `items`, and keeps those that it
 * has. A new array is at least twice as long; the old one remains in the arena until its end. */
void pl_arena_reserve(pl_arena *arena, void *items, int *capacity, int wanted, size_t size);

/* Has the system give the pages of memory just allocated, all in one call: page by page, as each is
 * first written, takes twice as long. A hint, for memory that is then written from end to end:
 * madvise(2) has it from Linux 5.14 on. */
void pl_make_resident(void *memory, size_t size);

/* Frees all pieces. The arena is then empty and may be used again. */
void pl_arena_free(pl_arena *arena);

#endif
