/* What the fuzz targets share: libFuzzer's entry, and a check that also holds in release builds. */
#ifndef PLUMB_FUZZ_H
#define PLUMB_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Prints `law` and aborts unless `holds`. */
void fuzz_check(bool holds, const char *law);

#endif
