/* How well the clock that times steps repeats. */
#ifndef PLUMB_CLOCK_NOISE_H
#define PLUMB_CLOCK_NOISE_H

/* What the clock gives for the same work, many times, as pl_call_timer measures a step. */
typedef struct pl_clock_noise {
    double resolution; /* s, as the system states it */
    double empty;      /* s: the median of measurements of nothing */
    double step;       /* s: the median of those of the work */
    double spread;     /* the median distance from that median, divided by it */
    double slow;       /* the 99th percentile divided by the median */
    int repeats;       /* of the work */
} pl_clock_noise;

/* Measures it, with work that takes about 10 us. Takes 0.2 s at most, on a machine that is not
 * overloaded. */
pl_clock_noise pl_clock_noise_measure(void);

#endif
