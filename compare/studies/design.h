/* A design of experiments: the settings of engines that a study tries, and where in their ranges they lie. */
#ifndef PLUMB_DESIGN_H
#define PLUMB_DESIGN_H

#include "engines/registry.h"

/* An engine with its options, and the time step. */
typedef struct pl_setting {
    pl_engine_choice choice;
    double dt; /* s; NAN: each scenario's own */
} pl_setting;

/* The place of a point, 0 <= point, along one dimension: between 0 and 1, the same on every machine. The points of a
 * dimension are a van der Corput sequence whose digits are scrambled by the seed (Owen 1995, "Randomly permuted
 * (t,m,s)-nets and (t,s)-sequences"): of the first 2^k points, and of each 2^k after them, one lies in each 2^k-th of
 * the range, in an order that the seed gives. So the first 2^k points of several dimensions, each with a seed of its
 * own, are a Latin hypercube, and how many points there will be need not be known. */
double pl_design_place(uint64_t seed, int point);

#endif
