/* The power series x - x^3/3! + ... and 1 - x^2/2! + ... by Horner's rule from the far end: 13
 * terms leave less than 1e-20 for x <= 1.6. */
#include "trigonometry.h"

/* The sum of all terms but the first over the first, whose power of x is `first_power`. */
static double later_terms(double x, int first_power)
{
    double sum = 0;
    for (int power = first_power + 26; power > first_power; power -= 2) {
        sum = (1 + sum) * -(x * x) / (power * (power - 1));
    }
    return sum;
}

double pl_sine(double angle)
{
    return angle + angle * later_terms(angle, 1);
}

double pl_cosine(double angle)
{
    return 1 + later_terms(angle, 0);
}
