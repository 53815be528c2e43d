/* Loaded before a program (LD_PRELOAD): allocation number FAIL_AT of the program fails, or of each process
 * that it forks where FAIL_IN is "forked". COUNT_TO is a file that gets the number of allocations. */
#include <errno.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* glibc's own. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);

static pid_t program;
static long fail_at;
static int is_in_forked;
static atomic_long done;

__attribute__((constructor)) static void begin(void)
{
    const char *number = getenv("FAIL_AT"), *where = getenv("FAIL_IN");
    program = getpid();
    fail_at = number == NULL ? 0 : strtol(number, NULL, 10);
    is_in_forked = where != NULL && strcmp(where, "forked") == 0;
    atomic_store(&done, 0);
}

__attribute__((destructor)) static void end(void)
{
    const char *path = getenv("COUNT_TO");
    const long count = atomic_load(&done);
    FILE *file = path == NULL || getpid() != program ? NULL : fopen(path, "w");
    if (file != NULL) {
        fprintf(file, "%ld\n", count);
        fclose(file);
    }
}

static int fails(void)
{
    if ((getpid() != program) != is_in_forked || atomic_fetch_add(&done, 1) + 1 != fail_at) {
        return 0;
    }
    errno = ENOMEM;
    return 1;
}

void *malloc(size_t size)
{
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size)
{
    return fails() ? NULL : __libc_realloc(memory, size);
}
