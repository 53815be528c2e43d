/* Shared by the fuzz targets: libFuzzer's entry point, and a check that release builds keep. */
#ifndef PLUMB_FUZZ_H
#define PLUMB_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* Runs the target on one input of `size` bytes. Returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Prints `law` and aborts unless `holds`. */
static inline void fuzz_check(bool holds, const char *law)
{
    if (!holds) {
        fprintf(stderr, "broken: %s\n", law);
        abort();
    }
}

#endif
