/* A tall block on a slope: it tips, or slides, whichever comes first.
 *
 * The block, half width hb across the slope's fall line and half height hh, has its centre hh above
 * the slope. Its weight passes the lower edge when tan(angle) = hb / hh, and it slides when
 * tan(angle) = friction: so it tips first iff friction > hb / hh, and holds iff tan(angle) is below
 * both.
 *
 * Beyond the critical angle by d it slides as in slope-threshold, g d / cos(critical), 0.1 m in 30
 * s at 5e-5 of the angle; or it turns about its lower edge by d (cosh(k t) - 1) with k^2 = 3 g / (4
 * R), R = sqrt(hb^2 + hh^2), 3.6 / s for the default block: any d above 1e-15 rad is a fall within
 * 10 s. */
#include "catalogue.h"
#include "degree.h"
#include "scene_builder.h"
#include "trigonometry.h"

#include <math.h>

enum { FRICTION, WIDTH, ANGLE, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [FRICTION] = {.name = "friction",
                  .value = 1,
                  .min = 0,
                  .max = 10,
                  .unit = "1",
                  .help = "Coulomb coefficient; above `slenderness` the block tips first"},
    [WIDTH] = {.name = "slenderness",
               .value = 0.5,
               .min = 0.1,
               .max = 2,
               .unit = "1",
               .help = "half width over half height"},
    [ANGLE] = {.name = "angle",
               .value = 26.5,
               .min = 0,
               .max = 85,
               .unit = "deg",
               .help = "of the slope"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(30),
};

static double critical(const double *values)
{
    return atan(fmin(values[FRICTION], values[WIDTH])) / PL_RADIANS_PER_DEGREE;
}

static const pl_threshold threshold = {.param = "angle",
                                       .low = 0,
                                       .high = 85,
                                       .holds_below = true,
                                       .tolerance = 2e-4,
                                       .critical = critical,
                                       .formula = "atan(min(friction, half width / half height))"};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half_height = 0.5, angle = PL_RADIANS_PER_DEGREE * values[ANGLE];
    pl_builder builder = pl_build_begin(scene, pl_scenario_slope_tip.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, pl_sine(angle), 0, pl_cosine(angle), 0);
    pl_body block = pl_body_default();
    block.shape = pl_shape_box(half_height * values[WIDTH], half_height, half_height);
    block.position[0] = half_height * pl_sine(angle);
    block.position[2] = half_height * pl_cosine(angle);
    block.orientation[0] = pl_cosine(angle / 2);
    block.orientation[2] = pl_sine(angle / 2);
    pl_build_rest(&builder, pl_build_body(&builder, &block, "block"));
    pl_build_judge(&builder, pl_scenario_slope_tip.primary_error, 0.1);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_slope_tip = {
    .name = "slope-tip",
    .title = "Tall block on a slope",
    .description = "A block twice as tall as wide on a slope a little below the angle at which it "
                   "tips over; with less friction than that takes, it slides instead. Figure 3 of "
                   "the source paper, " PL_SOURCE_PAPER ".",
    .reference = "it holds iff tan(angle) < min(friction, half width / half height); it tips first "
                 "iff friction > half width / half height",
    .expected = "ok: at rest where it began, below the critical angle; collapsed above: it tips or "
                "slides off",
    .source = "statics: moments about the lower edge, and Coulomb's law",
    .primary_error = "rest_position_error",
    .validity = "tan(angle) < min(friction, half width / half height)",
    .threshold = &threshold,
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
