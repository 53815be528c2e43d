/* Sequences of calls of the engine's public interface, made from any bytes, and the laws that hold in
 * all of them.
 *
 * A world has settings in and out of range, one or two threads, sleep or not, and up to 12 bodies of all
 * shapes that overlap, of masses from 1e-6 to 1e6 kg, with velocities and forces. Between steps bodies
 * come and go, are put elsewhere, and materials change. */
#ifndef PLUMB_TEST_RANDOM_CALLS_H
#define PLUMB_TEST_RANDOM_CALLS_H

#include "plumb/engine.h"

/* What the calls did. */
typedef struct random_calls_found {
    char broken[256]; /* the first law that was broken, with what was found; empty: none */
    int calls;        /* of the interface */
    int steps;        /* that succeeded */
    int refused;      /* calls that were refused, as they had to be */
    int undone;       /* steps that ended with PE_NOT_FINITE */
    int destroyed;    /* bodies */
    int slept;        /* steps with a body asleep */
    int contacts;     /* reported */
    int overlapping;  /* steps that left deep overlap */
} random_calls_found;

/* Makes the calls that `size` bytes describe, and stops where a law is broken:
 *
 * - what is out of range is refused, and so is the id of a body that was destroyed;
 * - after PE_OK all states are finite, and no body has moved beyond the law of step_laws.h;
 * - after another status all states are as they were, to the bit;
 * - where no force was applied, nothing overlaps by more than 1e-5 m, no body turns by more than half a
 *   radian or is a kilometre away, and the solver may iterate 200 times, the kinetic energy grows by no
 *   more than gravity's work on the bodies that fall, and 2 % of both;
 * - contacts are of living bodies, with unit normals, finite impulses, and in the order of each body's
 *   solves;
 * - a captured problem is valid.
 *
 * Counts are added to *found. */
void random_calls_run(const uint8_t *bytes, size_t size, pe_profile profile,
                      random_calls_found *found);

#endif
