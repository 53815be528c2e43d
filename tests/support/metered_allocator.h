/* An allocator that counts bytes. */
#ifndef PLUMB_TEST_METERED_ALLOCATOR_H
#define PLUMB_TEST_METERED_ALLOCATOR_H

#include <stdatomic.h>
#include <stddef.h>

typedef struct meter {
    atomic_size_t now, most; /* bytes */
} meter;

/* For pe_allocator, with a meter as its context; safe to call from several threads at once. */
void *meter_allocate(void *context, size_t size);
void meter_release(void *context, void *memory);

#endif
