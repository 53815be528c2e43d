/* What an engine costs: CPU time, wall time and instructions of its calls, and the memory it takes. Linux. */
#ifndef PLUMB_RESOURCE_USAGE_H
#define PLUMB_RESOURCE_USAGE_H

#include <stdint.h>
#include <sys/types.h>

/* What a call to an engine costs. */
typedef struct pl_call_cost {
    double cpu_time;  /* s, of the process, all threads */
    double wall_time; /* s */
    double
        instructions; /* in user space, without the timer's own; NAN where they are not counted */
} pl_call_cost;

/* Counts by perf_event_open(2), where the kernel and the machine support it. */
typedef struct pl_call_timer {
    int counter;        /* file descriptor; -1: none */
    uint64_t count;     /* as last read */
    double own;         /* instructions that an empty measurement counts */
    double cpu_before;  /* s */
    double wall_before; /* s */
} pl_call_timer;

/* Opens a timer: before the engine is created, so that threads that it starts count. Never fails:
 * what cannot be counted is NAN. */
pl_call_timer pl_call_timer_open(void);

/* Closes it. */
void pl_call_timer_close(pl_call_timer *timer);

/* Called before a call. */
void pl_call_timer_begin(pl_call_timer *timer);

/* Called after the call. */
pl_call_cost pl_call_timer_end(pl_call_timer *timer);

/* Prepares a measurement of memory (proc(5): clear_refs, status) of a child of this process, or, where
 * `pid` is 0, of this process: returns unused heap, loads the code that a run may execute, and resets
 * the peak. Returns the resident set size now, in bytes; NAN where /proc does not have it. */
double pl_resident_set_baseline(pid_t pid);

/* The resident set size now, in bytes; NAN where it is not known. */
double pl_resident_set(pid_t pid);

/* Bytes by which the peak resident set size since then is above `baseline`; NAN where it is not
 * known. */
double pl_resident_set_growth(pid_t pid, double baseline);

#endif
