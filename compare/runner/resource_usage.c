#include "resource_usage.h"

#include "engines/process.h"

#include <linux/perf_event.h>
#include <malloc.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/* ---- Time and instructions ---- */

enum { EMPTY_MEASUREMENTS = 16 };

static double seconds_of(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Without the kernel's share, which unprivileged users may not count, and which differs from run to
 * run. */
static int open_counter(void)
{
    struct perf_event_attr attributes = {.type = PERF_TYPE_HARDWARE,
                                         .size = sizeof attributes,
                                         .config = PERF_COUNT_HW_INSTRUCTIONS,
                                         .read_format = PERF_FORMAT_TOTAL_TIME_ENABLED |
                                                        PERF_FORMAT_TOTAL_TIME_RUNNING,
                                         .disabled = 1,
                                         .inherit = 1,
                                         .exclude_kernel = 1,
                                         .exclude_hv = 1};
    return (int)syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC);
}

void pl_call_timer_close(pl_call_timer *timer)
{
    if (timer->counter >= 0) {
        close(timer->counter);
    }
    timer->counter = -1;
}

/* The instructions since the last call. Gives up for good when the counter had to share the
 * hardware with others: it is then an estimate. */
static double count_since(pl_call_timer *timer)
{
    struct {
        uint64_t count, enabled, running;
    } now;
    if (timer->counter < 0) {
        return NAN;
    }
    if (read(timer->counter, &now, sizeof now) != (ssize_t)sizeof now ||
        now.running < now.enabled) {
        pl_call_timer_close(timer);
        return NAN;
    }
    const double counted = (double)(now.count - timer->count);
    timer->count = now.count;
    return counted;
}

pl_call_timer pl_call_timer_open(void)
{
    pl_call_timer timer = {.counter = open_counter()};
    double least = INFINITY;
    for (int i = 0; i < EMPTY_MEASUREMENTS && timer.counter >= 0; ++i) {
        pl_call_timer_begin(&timer);
        least = fmin(least, pl_call_timer_end(&timer).instructions);
    }
    timer.own = timer.counter < 0 ? 0 : least;
    return timer;
}

/* The clocks are read innermost, so that the times have no part of the counter's. */
void pl_call_timer_begin(pl_call_timer *timer)
{
    if (timer->counter >= 0 && ioctl(timer->counter, PERF_EVENT_IOC_ENABLE, 0) != 0) {
        pl_call_timer_close(timer);
    }
    timer->wall_before = seconds_of(CLOCK_MONOTONIC);
    timer->cpu_before = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}

pl_call_cost pl_call_timer_end(pl_call_timer *timer)
{
    pl_call_cost cost = {.cpu_time = seconds_of(CLOCK_PROCESS_CPUTIME_ID) - timer->cpu_before};
    cost.wall_time = seconds_of(CLOCK_MONOTONIC) - timer->wall_before;
    if (timer->counter >= 0 && ioctl(timer->counter, PERF_EVENT_IOC_DISABLE, 0) != 0) {
        pl_call_timer_close(timer);
    }
    const double counted = count_since(timer);
    cost.instructions = isnan(counted) ? counted : fmax(0, counted - timer->own);
    return cost;
}

/* ---- Memory ---- */

/* The path of a file of a process in /proc; 0: this process. */
static void proc_path(pid_t pid, const char *name, char path[64])
{
    const int length = snprintf(path, 64, pid > 0 ? "/proc/%d/" : "/proc/self/", (int)pid);
    snprintf(path + length, 64 - (size_t)length, "%s", name);
}

/* A field of a process's status in bytes. */
static double read_status(pid_t pid, const char *name)
{
    char path[64], text[64];
    proc_path(pid, "status", path);
    pl_file_field(path, name, text, sizeof text);
    return text[0] == '\0' ? (double)NAN : 1024 * strtod(text, NULL);
}

/* Makes the code of every loaded library resident: code pages that are loaded on their first use
 * must not count as an engine's memory. madvise(2) needs Linux 5.14; without it, code counts. */
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

double pl_resident_set(pid_t pid)
{
    return read_status(pid, "VmRSS");
}

double pl_resident_set_baseline(pid_t pid)
{
    load_code();
    /* Freed heap that is still resident would hide what an engine takes. */
    malloc_trim(0);
    char path[64];
    proc_path(pid, "clear_refs", path);
    FILE *file = fopen(path, "we");
    bool reset = file != NULL && fputs("5", file) >= 0;
    reset = file != NULL && fclose(file) == 0 && reset;
    return reset ? pl_resident_set(pid) : (double)NAN;
}

double pl_resident_set_growth(pid_t pid, double baseline)
{
    double peak = read_status(pid, "VmHWM");
    return peak < baseline ? 0 : peak - baseline;
}
