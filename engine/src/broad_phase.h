/* Which pairs of bodies are near enough to be looked at closely. */
#ifndef PE_BROAD_PHASE_H
#define PE_BROAD_PHASE_H

#include "world.h"

typedef struct pe_pair {
    int a, b; /* slots, a < b, not both static */
} pe_pair;

/* How far, in m, the surfaces of two bodies can come towards each other within a step of dt, and
 * the contact margin: pairs with a smaller gap need contacts now. Bound: relative velocity, each
 * body's rotation at its bounding radius, and one step of gravity. */
double pe_pair_margin(const pe_world *world, int a, int b, double dt);

/* All pairs whose gap may be below their margin, sorted by (a, b), in the step's arena. Sort and
 * sweep along the axis on which the bodies are spread widest (Baraff 1992); planes against every
 * dynamic body directly. */
pe_status pe_broad_phase(pe_world *world, double dt, pe_pair **pairs, int *count, pe_error *error);

#endif
