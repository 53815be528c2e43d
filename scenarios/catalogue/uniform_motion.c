#include "uniform_motion.h"

#include <math.h>
#include <string.h>

const double pl_axis_x[3] = {1, 0, 0}, pl_axis_y[3] = {0, 1, 0}, pl_axis_z[3] = {0, 0, 1};

pl_answer pl_uniform_way(double v, double a, double h, double steps)
{
    double t = steps * h;
    return (pl_answer){v * t + a * t * t / 2, v * t + a * h * h * steps * (steps + 1) / 2};
}

pl_answer pl_braked_way(double v, double braking, double h, double steps)
{
    double t = fmin(steps * h, v / braking);
    double moving = fmin(steps, floor(v / (braking * h)));
    double discrete = pl_uniform_way(v, -braking, h, moving).discrete;
    return (pl_answer){v * t - braking * t * t / 2, discrete > 0 ? discrete : (double)NAN};
}

pl_answer pl_exactly(double value)
{
    return (pl_answer){value, value};
}

pl_answer pl_continuous(double value)
{
    return (pl_answer){value, (double)NAN};
}

void pl_build_at_end(pl_builder *builder, int body, pl_quantity quantity, const double direction[3],
                     pl_answer answer, double scale)
{
    pl_expect_value value = pl_expect_value_default(builder->scene);
    value.body = body;
    value.quantity = quantity;
    memcpy(value.direction, direction, sizeof value.direction);
    value.value = answer.continuous;
    value.discrete = answer.discrete;
    value.scale = scale;
    pl_build_value(builder, &value);
}
