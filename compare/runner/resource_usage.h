/* What an engine costs: CPU time and instructions of its steps, and the memory it takes. Linux. */
#ifndef PLUMB_RESOURCE_USAGE_H
#define PLUMB_RESOURCE_USAGE_H

#include <stdint.h>

/* What the engine's step alone costs. */
typedef struct pl_step_cost {
    double cpu_time; /* s, of the process, all threads */
    double
        instructions; /* in user space, without the timer's own; NAN where they are not counted */
} pl_step_cost;

/* Counts by perf_event_open(2), where the kernel and the machine support it. */
typedef struct pl_step_timer {
    int counter;       /* file descriptor; -1: none */
    uint64_t count;    /* as last read */
    double own;        /* instructions that an empty measurement counts */
    double cpu_before; /* s */
} pl_step_timer;

/* Opens a timer: before the engine is created, so that threads that it starts count. Never fails:
 * what cannot be counted is NAN. */
pl_step_timer pl_step_timer_open(void);

/* Closes it. */
void pl_step_timer_close(pl_step_timer *timer);

/* Called before a step. */
void pl_step_timer_begin(pl_step_timer *timer);

/* Called after the step. */
pl_step_cost pl_step_timer_end(pl_step_timer *timer);

/* Prepares a measurement of memory (proc(5): clear_refs, status): returns unused heap, loads the
 * code that a run may execute, and resets the peak. Returns the resident set size now, in bytes;
 * NAN where /proc does not have it. */
double pl_resident_set_baseline(void);

/* Bytes by which the peak resident set size since then is above `baseline`; NAN where it is not
 * known. */
double pl_resident_set_growth(double baseline);

#endif
