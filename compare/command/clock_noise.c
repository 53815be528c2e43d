#include "machine.h"

#include "base/statistics.h"
#include "engines/process.h"
#include "runner/resource_usage.h"

#include <math.h>
#include <time.h>

/* The work is that of a short step. */
static const double STEP = 1e-5, LONGEST = 0.15; /* s */
enum { EMPTY_REPEATS = 201, TRIALS = 5, REPEATS = 5001, MOST_ROUNDS = 1 << 24 };

/* Times multiplications and additions each of which waits for the one before. Numbers that the compiler
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

json_t *pl_clock_noise(void)
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
