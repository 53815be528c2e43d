/* Motion under a constant acceleration, and expectations of it at the end of a scene.
 *
 * With t = n h:
 *   continuous:           x = v t + a t^2 / 2
 *   semi-implicit Euler:  x_n = n h v + a h^2 n (n + 1) / 2, the sum of h v_k, v_k = v + k h a */
#ifndef PLUMB_UNIFORM_MOTION_H
#define PLUMB_UNIFORM_MOTION_H

#include "scene_builder.h"

typedef struct pl_answer {
    double continuous, discrete; /* discrete: NAN where there is none */
} pl_answer;

/* From speed v at acceleration a (both signed) over `steps` steps of h. */
pl_answer pl_uniform_way(double v, double a, double h, double steps);

/* The same where friction takes `braking` > 0 from the speed v >= 0 until nothing is left. A
 * discrete answer of 0 is none. */
pl_answer pl_braked_way(double v, double braking, double h, double steps);

/* An answer that is one number. */
pl_answer pl_exactly(double value);

/* An answer of the continuous problem alone. */
pl_answer pl_continuous(double value);

/* Expects `quantity` of the body along `direction` at the end of the scene. */
void pl_build_at_end(pl_builder *builder, int body, pl_quantity quantity, const double direction[3],
                     pl_answer answer, double scale);

extern const double pl_axis_x[3], pl_axis_y[3], pl_axis_z[3];

#endif
