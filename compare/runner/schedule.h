/* Which runs are made at the same time: at most as many as there are jobs, and no more threads than
 * the process has CPUs, so that no run takes time from another one's step. */
#ifndef PLUMB_SCHEDULE_H
#define PLUMB_SCHEDULE_H

#include <stdbool.h>

/* The runs in progress and their CPUs. Starts with the first two set and the others 0. */
typedef struct pl_schedule {
    int jobs; /* runs at a time, >= 1 */
    int cpus; /* >= 1 */
    int runs, busy_cpus;
} pl_schedule;

/* Whether a run whose engine has `threads` threads may begin. A run that wants more than there are
 * gets all CPUs, and runs alone. */
bool pl_schedule_has_room(const pl_schedule *schedule, int threads);

/* Begins a run for which there is room. Returns the CPUs that it may use from now on: as many as its
 * engine has threads, and at least its share of all, cpus / jobs, as far as that is free. */
int pl_schedule_begin(pl_schedule *schedule, int threads);

/* Ends a run that began with so many CPUs. */
void pl_schedule_end(pl_schedule *schedule, int cpus);

#endif
