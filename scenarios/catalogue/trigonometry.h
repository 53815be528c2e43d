/* Sine and cosine of scenarios' angles: the same bits on every machine, which the C library's are
 * not. Good to a few units in the last place for 0 <= angle <= 1.6. */
#ifndef PLUMB_TRIGONOMETRY_H
#define PLUMB_TRIGONOMETRY_H

double pl_sine(double angle);
double pl_cosine(double angle);

#endif
