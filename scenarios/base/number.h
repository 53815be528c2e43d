/* Numbers as text, with a decimal point in any locale. */
#ifndef PLUMB_NUMBER_H
#define PLUMB_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PL_NUMBER_SIZE = 32 };

/* The shortest decimal of at most 17 digits that reads back as the same double; "nan", "inf" or
 * "-inf" for the rest. Returns `text`. */
const char *pl_number_text(double value, char text[PL_NUMBER_SIZE]);

/* Reads all of text[0 .. length) as a decimal number such as -12.5e-3, rounded to the nearest
 * double. False for anything else, and for a number too large for a finite double. */
bool pl_decimal(const char *text, size_t length, double *value);

/* digits / 10^places, rounded to the nearest double, the even one of two. False for more than 19
 * places, of which this does not tell. */
bool pl_scale_decimal(uint64_t digits, int places, double *value);

#endif
