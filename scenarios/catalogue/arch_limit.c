/* Let the crown push with H at height y, and M = H y. At the joint at an angle f from the vertical,
 * with the weight V of all between it and the crown and its moment S about the centre, the thrust
 * passes the joint at the radius r where, by moments about the centre,
 *     r (H cos f + V sin f) = M + S.
 * It lies within the joint for inner <= r <= outer: for every joint a lower and an upper bound on
 * M, linear in H. The arch stands iff some H leaves room between them; that room is concave in H.
 * The forces may be taken as symmetric, because they could be averaged with their mirror image. */
#include "arch_limit.h"

#include <math.h>
#include <stdbool.h>

static const double half_turn = 3.1415926535897931;

double pl_voussoir_centre(int count, double thickness)
{
    const double inner = 1 - thickness / 2, outer = 1 + thickness / 2;
    /* Of a trapezium, its sides as the radii. */
    return cos(half_turn / (2 * count)) *
           (inner + thickness / 3 * (inner + 2 * outer) / (inner + outer));
}

/* The room for M at this H, where a voussoir weighs 1. The uppermost joint is at the crown, or, of
 * an odd count, half a voussoir beside it. */
static double room(int count, double thickness, double thrust)
{
    const double inner = 1 - thickness / 2, outer = 1 + thickness / 2;
    const double centre = pl_voussoir_centre(count, thickness), half = half_turn / (2 * count);
    const bool odd = count % 2 != 0;
    double joint = odd ? half : 0, weight = odd ? 0.5 : 0;
    double moment = weight * sin(half) / 3 * (inner + outer * outer / (inner + outer));
    double least = -HUGE_VAL, most = HUGE_VAL;
    for (int i = 0; i <= count / 2; i++) {
        const double across = thrust * cos(joint) + weight * sin(joint);
        least = fmax(least, inner * across - moment);
        most = fmin(most, outer * across - moment);
        moment += centre * sin(joint + half);
        weight += 1;
        joint += 2 * half;
    }
    return most - least;
}

static bool stands(int count, double thickness)
{
    double low = 0, high = count;
    for (int i = 0; i < 100; i++) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (room(count, thickness, a) < room(count, thickness, b)) {
            low = a;
        } else {
            high = b;
        }
    }
    return room(count, thickness, low) >= 0;
}

double pl_arch_limit(int count)
{
    double low = 0, high = 1;
    for (int i = 0; i < 60; i++) {
        const double middle = low + (high - low) / 2;
        *(stands(count, middle) ? &high : &low) = middle;
    }
    return low + (high - low) / 2;
}
