/* Reads a file of results. */
#include "gather.h"

#include "results/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

pl_status pl_gate_file_read(const char *path, pl_gate_file *file, pl_error *error)
{
    struct stat found;
    long long whole = 0;
    char *inside = NULL;
    *file = (pl_gate_file){.path = path};
    if (stat(path, &found) == 0 && S_ISDIR(found.st_mode)) {
        if (asprintf(&inside, "%s/results.jsonl", path) < 0) {
            return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path);
        }
        path = inside;
    }
    pl_status status = pl_results_read(path, &file->results, &whole, error);
    if (status == PL_OK && stat(path, &found) == 0 && S_ISREG(found.st_mode) &&
        found.st_size > whole) {
        fprintf(stderr, "%s: the last line is not whole, and left out\n", path);
    }
    free(inside);
    return status;
}
