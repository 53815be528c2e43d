#include "resident_set.h"

#include <malloc.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* A line "NAME:   1234 kB" of /proc/self/status in bytes. `name` ends with the colon. */
static double read_status(const char *name)
{
    char line[256];
    double bytes = NAN;
    FILE *file = fopen("/proc/self/status", "re");
    if (file == NULL) {
        return bytes;
    }
    while (fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, name, strlen(name)) == 0) {
            bytes = 1024 * strtod(line + strlen(name), NULL);
        }
    }
    fclose(file);
    return bytes;
}

/* Makes the code of every loaded library resident: pages of a file that come in when they are first
 * run are no memory that an engine takes. madvise(2): Linux 5.14; where it is refused, code counts.
 */
static void load_code(void)
{
    enum { LARGEST = 64 << 20 };
    char line[4608];
    FILE *file = fopen("/proc/self/maps", "re");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        char *end;
        uintptr_t from = strtoull(line, &end, 16);
        uintptr_t to = strtoull(end + 1, &end, 16);
        bool readable_file = end[1] == 'r' && strchr(end, '/') != NULL;
        if (readable_file && to - from <= LARGEST) {
            madvise((void *)from, to - from, MADV_POPULATE_READ);
        }
    }
    if (file != NULL) {
        fclose(file);
    }
}

double pl_resident_set_baseline(void)
{
    load_code();
    /* Freed heap that is still resident would hide what an engine takes. */
    malloc_trim(0);
    FILE *file = fopen("/proc/self/clear_refs", "we");
    if (file == NULL) {
        return NAN;
    }
    bool reset = fputs("5", file) >= 0;
    reset = fclose(file) == 0 && reset;
    return reset ? read_status("VmRSS:") : (double)NAN;
}

double pl_resident_set_growth(double baseline)
{
    double peak = read_status("VmHWM:");
    return peak < baseline ? 0 : peak - baseline;
}
