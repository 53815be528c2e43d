/* Numbers as text. */
#ifndef PLUMB_NUMBER_H
#define PLUMB_NUMBER_H

enum { PL_NUMBER_SIZE = 32 };

/* The shortest decimal of at most 17 digits that reads back as the same double, in any locale with
 * a decimal point; "nan", "inf" or "-inf" for the rest. Returns `text`. */
const char *pl_number_text(double value, char text[PL_NUMBER_SIZE]);

#endif
