/* Numbers as text, in any locale with a decimal point. */
#ifndef PLUMB_NUMBER_H
#define PLUMB_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

enum { PL_NUMBER_SIZE = 32 };

/* The shortest decimal of at most 17 digits that reads back as the same double; "nan", "inf" or
 * "-inf" for the rest. Returns `text`. */
const char *pl_number_text(double value, char text[PL_NUMBER_SIZE]);

/* The number that text[0 .. length) is as a whole: a decimal such as -12.5e-3 that a finite double
 * is near. False for anything else. */
bool pl_decimal(const char *text, size_t length, double *value);

#endif
