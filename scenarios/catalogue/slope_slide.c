/* A block on a slope above the friction threshold: it slides without tipping.
 *
 * From rest, with a = g (sin(angle) - friction cos(angle)) and t = n h after n steps of h:
 *   continuous:           s = a t^2 / 2
 *   semi-implicit Euler:  v_k = k a h, s_n = sum of h v_k = a h^2 n (n + 1) / 2.
 * It stays flat while friction < half width / half height: the pressure then shifts
 * uphill-to-downhill by friction * half height, still inside the base. */
#include "catalogue.h"
#include "slope.h"

#include <math.h>

enum { FRICTION, ANGLE, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [FRICTION] = PL_PARAM_SLOPE_FRICTION,
    [ANGLE] = {.name = "angle",
               .value = 0.6,
               .min = 0,
               .max = 1.5,
               .unit = "rad",
               .help = "of the slope, above atan(friction)"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

static pl_expect_travel expected_travel(const pl_scene *scene, const pl_slope *slope, int block)
{
    double acceleration = -scene->gravity[2] * (slope->sine - slope->friction * slope->cosine);
    double steps = (double)pl_scene_steps(scene);
    double time = steps * scene->dt;
    return (pl_expect_travel){.body = block,
                              .direction = {slope->cosine, 0, -slope->sine},
                              .distance = acceleration * time * time / 2,
                              .discrete =
                                  acceleration * scene->dt * scene->dt * steps * (steps + 1) / 2};
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double at_rest[3] = {0, 0, 0};
    const pl_slope slope = pl_slope_of(values[ANGLE], values[FRICTION]);
    *scene = pl_scene_default();
    if (!(slope.sine > slope.friction * slope.cosine)) {
        return pl_fail(
            error, PL_BAD_INPUT,
            "slope-slide: expected an angle above atan(friction) = %g rad, where the block "
            "slides, found %g; use slope-stick for flatter ones",
            atan(values[FRICTION]), values[ANGLE]);
    }
    pl_builder builder = pl_build_begin(scene, pl_scenario_slope_slide.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    int block = pl_build_slope(&builder, &slope, at_rest);
    const pl_expect_travel travel = expected_travel(scene, &slope, block);
    pl_build_travel(&builder, &travel);
    pl_build_judge(&builder, pl_scenario_slope_slide.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_slope_slide = {
    .name = "slope-slide",
    .title = "Block that slides down",
    .description =
        "A block on a slope above the angle at which it slides, released at rest: whether "
        "friction brakes it as Coulomb's law says.",
    .reference =
        "s = g (sin(angle) - friction cos(angle)) t^2 / 2 along the slope; of semi-implicit Euler "
        "a h^2 n (n + 1) / 2",
    .expected = "ok: the block slides straight down, flat, by the distance of the reference",
    .source = "Coulomb's law and uniform acceleration; the discrete sum is arithmetic",
    .primary_error = "travel_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
