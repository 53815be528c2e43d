/* What the engine's step alone costs: CPU time of the process (all threads), and the instructions
 * it executes in user space (Linux perf events), where the kernel and the machine count them. */
#ifndef PLUMB_STEP_METER_H
#define PLUMB_STEP_METER_H

#include <stdint.h>

typedef struct pl_step_cost {
    double cpu_time;     /* s */
    double instructions; /* without the meter's own; NAN where they are not counted */
} pl_step_cost;

typedef struct pl_step_timer {
    int counter;       /* of perf_event_open(2); -1: none */
    uint64_t count;    /* as last read */
    double own;        /* instructions that an empty measurement counts */
    double cpu_before; /* s */
} pl_step_timer;

/* Before the engine is created, so that threads that it starts count. Never fails: what cannot be
 * counted is NAN. */
pl_step_timer pl_step_timer_open(void);
void pl_step_timer_close(pl_step_timer *meter);

/* Around one step. */
void pl_step_timer_begin(pl_step_timer *meter);
pl_step_cost pl_step_timer_end(pl_step_timer *meter);

#endif
