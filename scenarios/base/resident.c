#include "resident.h"

#include <stdint.h>
#include <sys/mman.h>

#ifndef MADV_POPULATE_WRITE
#define MADV_POPULATE_WRITE 23
#endif

void pl_make_resident(void *memory, size_t size)
{
    enum { PAGE = 4096, LEAST = 64 * PAGE }; /* less is not worth a call */
    if (size >= LEAST) {
        const uintptr_t begin = ((uintptr_t)memory + PAGE - 1) / PAGE * PAGE;
        const uintptr_t end = ((uintptr_t)memory + size) / PAGE * PAGE;
        (void)madvise((void *)begin, end - begin, MADV_POPULATE_WRITE);
    }
}
