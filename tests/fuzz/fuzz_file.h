/* A file of memory, for functions that read one by its path. */
#ifndef PLUMB_FUZZ_FILE_H
#define PLUMB_FUZZ_FILE_H

#include "fuzz.h"

#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { FUZZ_PATH_SIZE = 64 };

/* Opens a file of `size` bytes, and writes its path. Returns its descriptor, for close. */
static inline int fuzz_file(const void *data, size_t size, char path[FUZZ_PATH_SIZE])
{
    const int file = memfd_create("input", MFD_CLOEXEC);
    fuzz_check(file >= 0 && write(file, data, size) == (ssize_t)size, "there is memory");
    snprintf(path, FUZZ_PATH_SIZE, "/proc/self/fd/%d", file);
    return file;
}

/* Whether the message begins with PATH:LINE:COLUMN. */
static inline bool fuzz_has_place(const char *message, const char *path)
{
    int line = 0, column = -1;
    return strncmp(message, path, strlen(path)) == 0 &&
           sscanf(message + strlen(path), ":%d:%d: ", &line, &column) == 2 && line >= 1 &&
           column >= 0;
}

#endif
