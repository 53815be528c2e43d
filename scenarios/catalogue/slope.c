#include "slope.h"

/* The series x - x^3/3! + ... from its first term and first power, by Horner's rule from the far
 * end: 13 terms leave less than 1e-20 for x <= 1.6. */
static double alternating_series(double x, int first_power)
{
    double sum = 0;
    for (int power = first_power + 26; power > first_power; power -= 2) {
        sum = (1 + sum) * -(x * x) / (power * (power - 1));
    }
    return first_power == 0 ? 1 + sum : x + x * sum;
}

pl_slope pl_slope_of(double angle, double friction)
{
    return (pl_slope){.sine = alternating_series(angle, 1),
                      .cosine = alternating_series(angle, 0),
                      .friction = friction};
}

bool pl_slope_holds(const pl_slope *slope)
{
    return slope->sine < slope->friction * slope->cosine;
}

int pl_build_slope(pl_builder *builder, const pl_slope *slope, double angle)
{
    const double half_height = 0.25;
    const pl_slope half = pl_slope_of(angle / 2, 0);
    pl_build_floor(builder, slope->sine, 0, slope->cosine, 0);
    pl_body block = pl_body_default();
    block.shape =
        pl_shape_box(half_height * PL_SLOPE_TIPPING, half_height * PL_SLOPE_TIPPING, half_height);
    block.position[0] = half_height * slope->sine;
    block.position[2] = half_height * slope->cosine;
    block.orientation[0] = half.cosine;
    block.orientation[2] = half.sine;
    return pl_build_body(builder, &block, "block");
}
