/* An allocator that counts, and fails one call, or all from one on. */
#ifndef PLUMB_TEST_COUNTING_ALLOCATOR_H
#define PLUMB_TEST_COUNTING_ALLOCATOR_H

#include <stdbool.h>
#include <stddef.h>

typedef struct counter {
    int calls, living;
    int fail_at;  /* the call, from 0, that fails; below 0: none */
    bool lasting; /* all after it fail too */
} counter;

/* For pe_allocator, with a counter as its context. */
void *count_allocate(void *context, size_t size);
void count_release(void *context, void *memory);

#endif
