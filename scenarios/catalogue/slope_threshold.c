/* A block on a slope, at the angle where it begins to slide.
 *
 * Coulomb: it holds iff tan(angle) < friction. At d beyond the critical angle it slides with a =
 * g (sin - friction cos) = g d / cos(critical) to first order, so in 30 s by 4415 m d / cos. It has
 * fallen at 0.1 m: beyond 2.3e-5 rad times the cosine, 5e-5 of the critical angle for friction 0.5.
 * An engine in which the block creeps by less than 3 mm/s is still measured. */
#include "catalogue.h"
#include "degree.h"
#include "slope.h"

#include <math.h>

enum { FRICTION, ANGLE, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [FRICTION] = PL_PARAM_SLOPE_FRICTION,
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
    return atan(values[FRICTION]) / PL_RADIANS_PER_DEGREE;
}

static const pl_threshold threshold = {.param = "angle",
                                       .low = 0,
                                       .high = 80,
                                       .holds_below = true,
                                       .tolerance = 2e-4,
                                       .critical = critical,
                                       .formula = "atan(friction)"};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double at_rest[3] = {0, 0, 0};
    const pl_slope slope = pl_slope_of(PL_RADIANS_PER_DEGREE * values[ANGLE], values[FRICTION]);
    pl_builder builder = pl_build_begin(scene, pl_scenario_slope_threshold.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_rest(&builder, pl_build_slope(&builder, &slope, at_rest));
    pl_build_judge(&builder, pl_scenario_slope_threshold.primary_error, 0.1);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_slope_threshold = {
    .name = "slope-threshold",
    .title = "Slope at which a block slides",
    .description = "A block on a slope a little below the angle at which it slides; bisected, it "
                   "gives the friction that an engine really has.",
    .reference = "it holds iff angle < atan(friction)",
    .expected = "ok: at rest where it began, below atan(friction); collapsed above: it slides off",
    .source = "Coulomb's law of friction (Coulomb 1785) and statics",
    .primary_error = "rest_position_error",
    .validity = "angle < atan(friction); friction < 2, where the block would tip",
    .threshold = &threshold,
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
