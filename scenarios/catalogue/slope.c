#include "slope.h"

#include "trigonometry.h"

#include <string.h>

pl_slope pl_slope_of(double angle, double friction)
{
    return (pl_slope){
        .angle = angle, .sine = pl_sine(angle), .cosine = pl_cosine(angle), .friction = friction};
}

bool pl_slope_holds(const pl_slope *slope)
{
    return slope->sine < slope->friction * slope->cosine;
}

int pl_build_slope(pl_builder *builder, const pl_slope *slope, const double velocity[3])
{
    const double half_height = 0.25;
    pl_build_floor(builder, slope->sine, 0, slope->cosine, 0);
    pl_body block = pl_body_default();
    block.shape =
        pl_shape_box(half_height * PL_SLOPE_TIPPING, half_height * PL_SLOPE_TIPPING, half_height);
    block.position[0] = half_height * slope->sine;
    block.position[2] = half_height * slope->cosine;
    block.orientation[0] = pl_cosine(slope->angle / 2);
    block.orientation[2] = pl_sine(slope->angle / 2);
    memcpy(block.velocity, velocity, sizeof block.velocity);
    return pl_build_body(builder, &block, "block");
}
