#include "draw.h"

#include <math.h>

double pl_draw_uniform(pl_random *random, double low, double high)
{
    return low + (high - low) * pl_random_unit(random);
}

void pl_draw_orientation(pl_random *random, double q[4])
{
    double square;
    do {
        square = 0;
        for (int k = 0; k < 4; k++) {
            q[k] = pl_draw_uniform(random, -1, 1);
            square += q[k] * q[k];
        }
    } while (square > 1 || square < 0.01);
    double length = sqrt(square);
    for (int k = 0; k < 4; k++) {
        q[k] /= length;
    }
}
