/* The power series x - x^3/3! + ... and 1 - x^2/2! + ... by Horner's rule from the far end: 13
 * terms leave less than 1e-20 for x <= 1.6. */
#include "trigonometry.h"

#include <math.h>
#include <stdbool.h>

static const double right_angle = 1.5707963267948966;

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

/* Turns (*x, *y) by so many right angles. */
static void turn(long long right_angles, double *x, double *y)
{
    double c = *x, s = *y;
    switch (right_angles % 4) {
    case 1:
        *x = -s, *y = c;
        break;
    case 2:
        *x = -c, *y = -s;
        break;
    case 3:
        *x = s, *y = -c;
        break;
    default:
        break;
    }
}

static void point_at(double angle, double *x, double *y)
{
    double right_angles = floor(angle / right_angle);
    double rest = fmax(angle - right_angles * right_angle, 0);
    *x = pl_cosine(rest);
    *y = pl_sine(rest);
    turn((long long)right_angles, x, y);
}

double pl_sine_of_any(double angle)
{
    double x, y;
    point_at(angle, &x, &y);
    return y;
}

double pl_cosine_of_any(double angle)
{
    double x, y;
    point_at(angle, &x, &y);
    return x;
}

void pl_circle_point(int k, int n, double *x, double *y)
{
    long long eighths = 8LL * k, octant = eighths / n;
    /* The remaining angle counts from the start of the octant in even octants, and from its end in
     * odd ones. */
    double part = (double)(octant % 2 == 0 ? eighths - octant * n : (octant + 1) * n - eighths) / n;
    bool diagonal = part == 1; /* where sine and cosine are one number */
    double c = diagonal ? sqrt(0.5) : pl_cosine(part * right_angle / 2);
    double s = diagonal ? sqrt(0.5) : pl_sine(part * right_angle / 2);
    *x = octant % 2 == 0 ? c : s;
    *y = octant % 2 == 0 ? s : c;
    turn(octant / 2, x, y);
}

void pl_azimuth(double degrees, double direction[3])
{
    const double radian = 0.017453292519943295; /* pi / 180 */
    bool steep = degrees > 45;
    double angle = radian * (steep ? 90 - degrees : degrees);
    direction[steep ? 1 : 0] = pl_cosine(angle);
    direction[steep ? 0 : 1] = pl_sine(angle);
    direction[2] = 0;
}
