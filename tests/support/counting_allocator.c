#include "counting_allocator.h"

#include <stdlib.h>

void *count_allocate(void *context, size_t size)
{
    counter *c = context;
    int call = c->calls++;
    if (call == c->fail_at || (c->lasting && c->fail_at >= 0 && call > c->fail_at)) {
        return NULL;
    }
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    c->living += memory != NULL;
    return memory;
}

void count_release(void *context, void *memory)
{
    counter *c = context;
    c->living -= 1;
    free(memory);
}
