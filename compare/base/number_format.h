/* Numbers as people read them: three significant digits and a unit of a fitting size. */
#ifndef PLUMB_NUMBER_FORMAT_H
#define PLUMB_NUMBER_FORMAT_H

enum { PL_QUANTITY_SIZE = 96 };

/* Stands where there is no number: an en dash. */
extern const char pl_no_number[];

/* Writes `value` with its unit: seconds as ns, µs, ms or s; bytes as kB, MB, GB; others with the
 * unit as given ("1" shows none) and a power of ten outside 1e-3 .. 1e5. UTF-8. A value that is not
 * finite is written as pl_no_number. */
void pl_format_number(double value, const char *unit, char text[PL_QUANTITY_SIZE]);

/* Writes a finite number with its spread, which has as many places and at least one digit, and the
 * number's unit: "12.3 ± 0.4 µs". */
void pl_format_spread(double value, double spread, const char *unit, char text[PL_QUANTITY_SIZE]);

/* Writes a number that was given, not measured: with up to six digits, and its unit. */
void pl_format_given(double value, const char *unit, char text[PL_QUANTITY_SIZE]);

/* Writes "×2.50"; "×∞" for INFINITY. */
void pl_format_ratio(double ratio, char text[PL_QUANTITY_SIZE]);

/* Writes a power of ten: "1e-3". */
void pl_format_power(double value, char text[PL_QUANTITY_SIZE]);

/* Writes a time step as it is given to engines: "1/240 s" where it is one over a whole number. */
void pl_format_step(double dt, char text[PL_QUANTITY_SIZE]);

#endif
