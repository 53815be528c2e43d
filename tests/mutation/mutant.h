/* Compiled into every file of a mutated tree: M(a, b) is a, and b where the mutation is active. */
#ifndef PLUMB_MUTANT_H
#define PLUMB_MUTANT_H

#ifdef __cplusplus
extern "C" {
#endif

extern int plumb_active_mutation; /* the number in PLUMB_MUTATION; 0: none */

/* Which mutations were reached; the file named by PLUMB_MUTATIONS_REACHED, where there is one. */
extern unsigned char *plumb_reached_mutations;

#ifdef __cplusplus
}
#endif

#define PLUMB_MUTANT(number, original, mutated)                                                    \
    (plumb_reached_mutations[number] = 1,                                                          \
     plumb_active_mutation == (number) ? (mutated) : (original))

#endif
