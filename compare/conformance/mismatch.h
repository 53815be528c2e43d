/* How a number that was found relates to the one expected: the mistakes that have a known ratio. */
#ifndef PLUMB_MISMATCH_H
#define PLUMB_MISMATCH_H

#include "plumb/vec.h"

#include <stddef.h>

/* What a known mistake would have given. */
typedef struct pl_guess {
    pl_vec value;
    const char *cause; /* static */
} pl_guess;

/* The cause of the first of `count` guesses whose value is `found`, to a thousandth of its length;
 * `otherwise` where there is none. */
const char *pl_guess_cause(pl_vec found, const pl_guess *guesses, int count, const char *otherwise);

/* Writes how many times `expected` `found` is, such as ", which is 57.296 times as much: degrees in place
 * of radians"; an empty text where the components have no common ratio. */
void pl_describe_ratio(pl_vec found, pl_vec expected, char *text, size_t size);

#endif
