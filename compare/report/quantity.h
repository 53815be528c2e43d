/* Numbers as people read them: three significant digits and an engineer's unit. */
#ifndef PLUMB_QUANTITY_H
#define PLUMB_QUANTITY_H

enum { PL_QUANTITY_SIZE = 96 };

/* Writes `value` with its unit: seconds as ns, µs, ms or s; bytes as kB, MB, GB; others with the
 * unit as given ("1" shows none) and a power of ten outside 1e-3 .. 1e5. UTF-8. A value that is not
 * finite is written as pl_quantity_missing. */
void pl_quantity_text(double value, const char *unit, char text[PL_QUANTITY_SIZE]);

/* A number that was given, not measured: as short as it is exact to six digits, with its unit. */
void pl_quantity_given(double value, const char *unit, char text[PL_QUANTITY_SIZE]);

/* "×2.50"; "×∞" when it is infinite. */
void pl_quantity_ratio(double ratio, char text[PL_QUANTITY_SIZE]);

/* What stands where there is no number. */
extern const char pl_quantity_missing[];

#endif
