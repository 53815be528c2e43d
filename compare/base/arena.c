#include "arena.h"

#include "heap.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#ifndef MADV_POPULATE_WRITE
#define MADV_POPULATE_WRITE 23
#endif

struct pl_arena_block {
    struct pl_arena_block *next;
    max_align_t data[];
};

void pl_make_resident(void *memory, size_t size)
{
    enum { PAGE = 4096, LEAST = 64 * PAGE }; /* less is not worth a call */
    if (size >= LEAST) {
        const uintptr_t begin = ((uintptr_t)memory + PAGE - 1) / PAGE * PAGE;
        const uintptr_t end = ((uintptr_t)memory + size) / PAGE * PAGE;
        (void)madvise((void *)begin, end - begin, MADV_POPULATE_WRITE);
    }
}

void *pl_arena_take(pl_arena *arena, size_t count, size_t size)
{
    struct pl_arena_block *block = NULL;
    if (size == 0 || count <= (SIZE_MAX - sizeof *block) / size) {
        block = malloc(sizeof *block + count * size);
    }
    if (block == NULL) {
        pl_out_of_memory();
    }
    /* Writes every page now, which calloc leaves to the first use: memory of the harness must not
     * look like growth of an engine's. The empty statement keeps the compiler from making a calloc of
     * malloc and memset. */
    pl_make_resident(block, sizeof *block + count * size);
    memset(block->data, 0, count * size);
    __asm__ volatile("" : : "r"(block->data) : "memory");
    block->next = arena->blocks;
    arena->blocks = block;
    return block->data;
}

void pl_arena_reserve(pl_arena *arena, void *items, int *capacity, int wanted, size_t size)
{
    const int had = *capacity;
    if (wanted <= had) {
        return;
    }
    void *old;
    memcpy(&old, items, sizeof old);
    *capacity = wanted > 2 * had ? wanted : 2 * had;
    void *longer = pl_arena_take(arena, (size_t)*capacity, size);
    if (had > 0) {
        memcpy(longer, old, (size_t)had * size);
    }
    memcpy(items, &longer, sizeof longer);
}

void pl_arena_free(pl_arena *arena)
{
    while (arena->blocks != NULL) {
        struct pl_arena_block *next = arena->blocks->next;
        free(arena->blocks);
        arena->blocks = next;
    }
}
