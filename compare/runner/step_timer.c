#include "step_timer.h"

#include <linux/perf_event.h>
#include <math.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { EMPTY_MEASUREMENTS = 16 };

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
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

static void give_up(pl_step_timer *meter)
{
    if (meter->counter >= 0) {
        close(meter->counter);
    }
    meter->counter = -1;
}

/* The instructions since the last call. Gives up for good when the counter had to share the
 * hardware with others: it is then an estimate. */
static double count_since(pl_step_timer *meter)
{
    struct {
        uint64_t count, enabled, running;
    } now;
    if (meter->counter < 0) {
        return NAN;
    }
    if (read(meter->counter, &now, sizeof now) != (ssize_t)sizeof now ||
        now.running < now.enabled) {
        give_up(meter);
        return NAN;
    }
    const double counted = (double)(now.count - meter->count);
    meter->count = now.count;
    return counted;
}

pl_step_timer pl_step_timer_open(void)
{
    pl_step_timer meter = {.counter = open_counter()};
    double least = INFINITY;
    for (int i = 0; i < EMPTY_MEASUREMENTS && meter.counter >= 0; ++i) {
        pl_step_timer_begin(&meter);
        least = fmin(least, pl_step_timer_end(&meter).instructions);
    }
    meter.own = meter.counter < 0 ? 0 : least;
    return meter;
}

void pl_step_timer_close(pl_step_timer *meter)
{
    give_up(meter);
}

/* The clock is read innermost, so that the time has no part of the counter's. */
void pl_step_timer_begin(pl_step_timer *meter)
{
    if (meter->counter >= 0 && ioctl(meter->counter, PERF_EVENT_IOC_ENABLE, 0) != 0) {
        give_up(meter);
    }
    meter->cpu_before = cpu_seconds();
}

pl_step_cost pl_step_timer_end(pl_step_timer *meter)
{
    pl_step_cost cost = {.cpu_time = cpu_seconds() - meter->cpu_before};
    if (meter->counter >= 0 && ioctl(meter->counter, PERF_EVENT_IOC_DISABLE, 0) != 0) {
        give_up(meter);
    }
    const double counted = count_since(meter);
    cost.instructions = isnan(counted) ? counted : fmax(0, counted - meter->own);
    return cost;
}
