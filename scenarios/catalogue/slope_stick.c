/* A block on a slope below the friction threshold: it stays.
 *
 * Coulomb: it holds iff tan(angle) < friction. The primary error is the whole displacement and not
 * the drift after settling, since the law is that it does not move at all. Beyond half a block's
 * height, 0.25 m, it counts as fallen. */
#include "catalogue.h"
#include "slope.h"

#include <math.h>

enum { FRICTION, ANGLE, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [FRICTION] = PL_PARAM_SLOPE_FRICTION,
    [ANGLE] = {.name = "angle",
               .value = 0.44,
               .min = 0,
               .max = 1.2,
               .unit = "rad",
               .help = "of the slope, below atan(friction)"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(60),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double at_rest[3] = {0, 0, 0};
    const pl_slope slope = pl_slope_of(values[ANGLE], values[FRICTION]);
    *scene = pl_scene_default();
    if (!pl_slope_holds(&slope)) {
        return pl_fail(
            error, PL_BAD_INPUT,
            "slope-stick: expected an angle below atan(friction) = %g rad, where the block "
            "holds, found %g; use slope-slide for steeper ones",
            atan(values[FRICTION]), values[ANGLE]);
    }
    pl_builder builder = pl_build_begin(scene, pl_scenario_slope_stick.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_rest(&builder, pl_build_slope(&builder, &slope, at_rest));
    pl_build_judge(&builder, pl_scenario_slope_stick.primary_error, 0.25);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_slope_stick = {
    .name = "slope-stick",
    .title = "Block held by friction",
    .description =
        "A block on a slope a little below the angle at which it slides, for a minute: whether "
        "friction holds it, or lets it creep.",
    .reference = "no motion, since tan(angle) < friction",
    .expected = "ok: the block at rest where it began",
    .source = "Coulomb's law of friction (Coulomb 1785) and statics",
    .primary_error = "rest_position_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
