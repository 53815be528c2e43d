#include "command.h"

#include "base/json_field.h"
#include "base/statistics.h"
#include "base/table.h"
#include "engines/process.h"
#include "plumb/engine.h"
#include "runner/resource_usage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

static const double GIB = 0x1p30;

enum { TEXT_SIZE = 16384 };

/* Reads the beginning of a file; "" where it cannot be read. */
static const char *read_text(const char *path, char text[TEXT_SIZE])
{
    FILE *file = fopen(path, "re");
    const size_t length = file == NULL ? 0 : fread(text, 1, TEXT_SIZE - 1, file);
    text[length] = '\0';
    if (file != NULL) {
        fclose(file);
    }
    return text;
}

/* The number that a text begins with, after blanks; NAN where there is none, such as in "max". */
static double leading_number(const char *text)
{
    char *end;
    const double number = strtod(text, &end);
    return end == text ? (double)NAN : number;
}

static double read_number(const char *path)
{
    char text[TEXT_SIZE];
    return leading_number(read_text(path, text));
}

static json_t *number_or_null(double number)
{
    return isfinite(number) ? json_real(number) : NULL;
}

/* ---- Processor ---- */

static json_t *list_features(void)
{
    json_t *list = json_array();
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) {
        json_array_append_new(list, json_string("avx2"));
    }
    if (__builtin_cpu_supports("avx512f")) {
        json_array_append_new(list, json_string("avx512f"));
    }
#endif
    return list;
}

/* How the first CPU chooses its frequency; NULL: that cannot be read. */
static json_t *governor(void)
{
    char text[TEXT_SIZE];
    read_text("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", text);
    text[strcspn(text, " \n")] = '\0';
    return text[0] == '\0' ? NULL : pl_json_text(text);
}

/* Whether the processor may exceed its nominal frequency; NULL: that cannot be read. */
static json_t *turbo(void)
{
    const double boost = read_number("/sys/devices/system/cpu/cpufreq/boost");
    const double none = read_number("/sys/devices/system/cpu/intel_pstate/no_turbo");
    return isfinite(boost) || isfinite(none) ? json_boolean(isfinite(boost) ? boost > 0 : none == 0)
                                             : NULL;
}

/* ---- Memory ---- */

/* A line of /proc/meminfo, bytes; NAN: there is none. */
static double memory_of(const char *key)
{
    char text[TEXT_SIZE];
    const char *line = strstr(read_text("/proc/meminfo", text), key);
    return line == NULL ? (double)NAN : 1024 * leading_number(line + strlen(key));
}

/* The least limit of a control group and of those around it, bytes; INFINITY: none. */
static double group_limit(const char *root, const char *name, const char *file)
{
    char path[2048];
    double least = INFINITY;
    size_t length = strlen(name);
    for (;;) {
        while (length > 0 && name[length - 1] == '/') {
            --length;
        }
        snprintf(path, sizeof path, "%s%.*s/%s", root, (int)length, name, file);
        least = fmin(least, read_number(path));
        if (length == 0) {
            return least;
        }
        while (length > 0 && name[length - 1] != '/') {
            --length;
        }
    }
}

static double limit_of(const struct rlimit *limit)
{
    return limit->rlim_cur == RLIM_INFINITY ? (double)INFINITY : (double)limit->rlim_cur;
}

/* What this process may have, bytes, by its control groups (versions 1 and 2) and ulimit(1); NAN
 * where that is no less than the machine has. */
static double memory_limit(double total)
{
    char text[TEXT_SIZE], *rest = text;
    struct rlimit space = {.rlim_cur = RLIM_INFINITY}, data = space;
    getrlimit(RLIMIT_AS, &space);
    getrlimit(RLIMIT_DATA, &data);
    double least = fmin(limit_of(&space), limit_of(&data));
    read_text("/proc/self/cgroup", text);
    for (const char *line; (line = strsep(&rest, "\n")) != NULL;) {
        const char *memory = strstr(line, ":memory:");
        if (strncmp(line, "0::", 3) == 0) {
            least = fmin(least, group_limit("/sys/fs/cgroup", line + 3, "memory.max"));
        } else if (memory != NULL) {
            least = fmin(least,
                         group_limit("/sys/fs/cgroup/memory", memory + 8, "memory.limit_in_bytes"));
        }
    }
    return least < total ? least : (double)NAN;
}

/* ---- Clock ---- */

/* The work is that of a short step. */
static const double STEP = 1e-5, LONGEST = 0.15; /* s */
enum { EMPTY_REPEATS = 201, TRIALS = 5, REPEATS = 5001, MOST_ROUNDS = 1 << 24 };

/* Times multiplications and additions in a chain: each waits for the one before. Numbers that the compiler
 * may not foresee keep the work between the calls of the timer. */
static double time_work(pl_call_timer *timer, int rounds)
{
    volatile double number = 1;
    pl_call_timer_begin(timer);
    double x = number;
    for (int i = 0; i < rounds; ++i) {
        x = 0.999 * x + 0.001;
    }
    number = x;
    return pl_call_timer_end(timer).cpu_time;
}

/* The rounds of work that take about STEP. */
static int find_rounds(pl_call_timer *timer, double empty)
{
    int rounds = 64;
    double least = 0;
    while (least < STEP && rounds < MOST_ROUNDS) {
        rounds *= 2;
        least = INFINITY;
        for (int i = 0; i < TRIALS; ++i) {
            least = fmin(least, time_work(timer, rounds) - empty);
        }
    }
    return (int)fmax(1, rounds * STEP / fmax(least, STEP));
}

/* How well the clock that times steps repeats: what it gives for the same work, many times, as pl_call_timer measures
 * a step. "resolution": s, as the system states it; "empty" and "step": s, the medians of measurements of nothing and
 * of the work; "spread": the median distance from that median, divided by it; "slow": the 99th percentile divided by
 * the median. Takes 0.2 s at most, on a machine that is not overloaded. */
static json_t *clock_noise(void)
{
    double times[REPEATS];
    int repeats = 0;
    struct timespec resolution = {.tv_nsec = 0};
    pl_call_timer timer = pl_call_timer_open();
    const double begin = pl_monotonic_seconds();
    clock_getres(CLOCK_PROCESS_CPUTIME_ID, &resolution);
    for (int i = 0; i < EMPTY_REPEATS; ++i) {
        times[i] = time_work(&timer, 0);
    }
    const double empty = pl_median(times, EMPTY_REPEATS);
    const int rounds = find_rounds(&timer, empty);
    while (repeats < REPEATS && pl_monotonic_seconds() - begin < LONGEST) {
        times[repeats++] = time_work(&timer, rounds);
    }
    pl_call_timer_close(&timer);
    const double step = pl_median(times, repeats);
    const double slow = pl_quantile(times, repeats, 0.99) / step;
    for (int i = 0; i < repeats; ++i) {
        times[i] = fabs(times[i] - step);
    }
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:i}", "resolution",
                     (double)resolution.tv_sec + 1e-9 * (double)resolution.tv_nsec, "empty", empty,
                     "step", step, "spread", pl_median(times, repeats) / step, "slow", slow,
                     "repeats", repeats);
}

/* ---- All of it ---- */

json_t *pl_machine(void)
{
    double loads[3] = {NAN, NAN, NAN};
    const double total = memory_of("MemTotal:");
    (void)!getloadavg(loads, 3);
    return json_pack("{s:o, s:i, s:o*, s:o*, s:o*, s:o*, s:{s:o*, s:o*, s:o*}, s:o}", "features",
                     list_features(), "kernel_lanes", pe_kernel_lanes(), "governor", governor(),
                     "turbo", turbo(), "load", number_or_null(loads[0]), "cpus_online",
                     json_integer(sysconf(_SC_NPROCESSORS_ONLN)), "memory", "total",
                     number_or_null(total), "available", number_or_null(memory_of("MemAvailable:")),
                     "limit", number_or_null(memory_limit(total)), "timer", clock_noise());
}

/* ---- Text ---- */

static double number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return value == NULL ? (double)NAN : json_number_value(value);
}

static const char *has_feature(const json_t *machine, const char *name)
{
    size_t index;
    const json_t *feature;
    json_array_foreach(json_object_get(machine, "features"), index, feature)
    {
        if (strcmp(json_string_value(feature), name) == 0) {
            return "yes";
        }
    }
    return "no";
}

static void print_kernels(const json_t *machine, pl_table *table)
{
    const int lanes = (int)number(machine, "kernel_lanes");
    pl_table_add(table, "kernels");
    pl_table_format_cell(table,
                         "Plumb's engine solves up to %d contact manifold%s at once; instructions "
                         "of the processor: avx2 %s, avx512f %s",
                         lanes, lanes == 1 ? "" : "s", has_feature(machine, "avx2"),
                         has_feature(machine, "avx512f"));
}

static void print_frequency(const json_t *machine, pl_table *table)
{
    const json_t *governed = json_object_get(machine, "governor");
    const json_t *boost = json_object_get(machine, "turbo");
    pl_table_add(table, "frequency");
    if (governed == NULL && boost == NULL) {
        pl_table_add(table, "governor and turbo cannot be read, as on most virtual machines");
        return;
    }
    pl_table_format_cell(table, "governor %s; turbo %s",
                         governed == NULL ? "unknown" : json_string_value(governed),
                         boost == NULL         ? "unknown"
                         : json_is_true(boost) ? "on: the frequency depends on the load of all CPUs"
                                               : "off");
}

static void print_timer(const json_t *timer, pl_table *table)
{
    pl_table_add(table, "clock of steps");
    pl_table_format_cell(table, "resolution %.3g ns; an empty step measures as %.2g µs",
                         1e9 * number(timer, "resolution"), 1e6 * number(timer, "empty"));
    pl_table_add(table, "noise");
    pl_table_format_cell(
        table,
        "repeats of a step of %.2g µs differ by %.2g %% (median distance from the median of %d); "
        "one in a hundred takes %.3g times the median or more",
        1e6 * number(timer, "step"), 100 * number(timer, "spread"), (int)number(timer, "repeats"),
        number(timer, "slow"));
}

static void print_load(const json_t *machine, int cpus, pl_table *table)
{
    const double load = number(machine, "load");
    pl_table_add(table, "load");
    if (isnan(load)) {
        pl_table_add(table, "unknown");
        return;
    }
    pl_table_format_cell(table, "%.3g processes on average over the last minute, for %d CPUs: %s",
                         load, cpus,
                         load > cpus       ? "times are disturbed; wait until the others have ended"
                         : 2 * load > cpus ? "times may be disturbed"
                                           : "times are hardly disturbed");
}

static void print_memory(const json_t *memory, pl_table *table)
{
    const double limit = number(memory, "limit");
    pl_table_add(table, "memory");
    if (isnan(limit)) {
        pl_table_format_cell(table,
                             "%.3g GiB, of which %.3g GiB are available; no limit below that",
                             number(memory, "total") / GIB, number(memory, "available") / GIB);
    } else {
        pl_table_format_cell(
            table, "%.3g GiB, of which %.3g GiB are available; this process may use %.3g GiB",
            number(memory, "total") / GIB, number(memory, "available") / GIB, limit / GIB);
    }
}

void pl_machine_print(const json_t *host, const json_t *machine, FILE *out)
{
    pl_table table = {0};
    const int cpus = (int)number(host, "cpus"), online = (int)number(machine, "cpus_online");
    pl_table_columns(&table, "machine|what was found");
    pl_table_add(&table, "processor");
    pl_table_add(&table, pl_json_get_text(host, "cpu"));
    pl_table_add(&table, "CPUs");
    pl_table_format_cell(&table, "this process may use %d of %d", cpus, online);
    print_kernels(machine, &table);
    print_frequency(machine, &table);
    print_timer(json_object_get(machine, "timer"), &table);
    print_load(machine, online, &table);
    print_memory(json_object_get(machine, "memory"), &table);
    pl_table_print(&table, out);
    pl_table_free(&table);
}
