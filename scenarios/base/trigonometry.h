/* Sine and cosine for scenarios: the same bits on every machine, unlike those of the C library. */
#ifndef PLUMB_TRIGONOMETRY_H
#define PLUMB_TRIGONOMETRY_H

/* The sine of an angle from -1.6 to 1.6 rad, good to a few units in the last place. */
double pl_sine(double angle);

/* The cosine of an angle from -1.6 to 1.6 rad, good to a few units in the last place. */
double pl_cosine(double angle);

/* The sine of any angle from 0 to 1e6 rad, good to 1e-16 of the angle. */
double pl_sine_of_any(double angle);

/* The cosine of any angle from 0 to 1e6 rad, good to 1e-16 of the angle. */
double pl_cosine_of_any(double angle);

/* The point of the unit circle at the part k / n of a turn, 0 <= k, 0 < n. Points that mirror each
 * other in an axis do so to the bit. */
void pl_circle_point(int k, int n, double *x, double *y);

/* The level direction at so many degrees from x towards y, 0 to 90: exact at both ends, and the
 * mirror image of itself about 45. */
void pl_azimuth(double degrees, double direction[3]);

#endif
