/* What `plumb doctor` says of the machine. */
#ifndef PLUMB_MACHINE_H
#define PLUMB_MACHINE_H

#include <jansson.h>
#include <stdio.h>

/* The machine as a JSON object: the processor's features and settings, the clock that times steps, load and
 * memory. What cannot be read is left out. A new reference. It takes about 0.2 s. */
json_t *pl_machine(void);

/* How well the clock that times steps repeats: what it gives for the same work of about 10 us, many times, as
 * pl_call_timer measures a step. An object of "resolution" (s, as the system states it); "empty" and "step" (s: the
 * medians of measurements of nothing and of the work); "spread" (the median distance from that median, divided by
 * it); "slow" (the 99th percentile divided by the median) and "repeats" of the work. A new reference. It takes 0.2 s
 * at most, on a machine that is not overloaded. */
json_t *pl_clock_noise(void);

/* Prints the machine as a table, with the host of a provenance (pl_provenance). */
void pl_machine_print(const json_t *host, const json_t *machine, FILE *out);

#endif
