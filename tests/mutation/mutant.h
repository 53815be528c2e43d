/* Compiled into every file of a mutated tree: M(a, b) is a, and b where the mutation is active. */
#ifndef PLUMB_MUTANT_H
#define PLUMB_MUTANT_H

extern int plumb_active_mutation; /* the number in PLUMB_MUTATION; 0: none */

#define PLUMB_MUTANT(number, original, mutated)                                                    \
    (plumb_active_mutation == (number) ? (mutated) : (original))

#endif
