#include "metered_allocator.h"

#include "base/memory.h"

#include <string.h>

enum { HEADER = 64 }; /* bytes before each block, which hold its size */

void *meter_allocate(void *context, size_t size)
{
    meter *m = context;
    const pe_allocator below = pe_allocator_default();
    char *memory = below.allocate(below.context, size + HEADER);
    if (memory == NULL) {
        return NULL;
    }
    memcpy(memory, &size, sizeof size);
    size_t now = atomic_fetch_add(&m->now, size) + size;
    for (size_t most = m->most;
         now > most && !atomic_compare_exchange_weak(&m->most, &most, now);) {}
    return memory + HEADER;
}

void meter_release(void *context, void *memory)
{
    meter *m = context;
    size_t size;
    memcpy(&size, (char *)memory - HEADER, sizeof size);
    atomic_fetch_sub(&m->now, size);
    const pe_allocator below = pe_allocator_default();
    below.release(below.context, (char *)memory - HEADER);
}
