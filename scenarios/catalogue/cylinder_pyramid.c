/* Three equal cylinders side by side: two on the floor, which touch, and one upon them.
 *
 * Let N and T be the normal and the friction force between the upper and a lower one of weight W,
 * at 30 degrees from the vertical, and F and M those of the floor. Moments about a lower axis: F =
 * T. Along the floor: N sin 30 = T cos 30 + F, so T / N = sin 30 / (1 + cos 30) = tan 15. The upper
 * one: 2 (N cos 30 + T sin 30) = W, so N = W / 2, and with M = 3/2 W, F / M = tan(15) / 3. A push
 * between the lower two would only ask for more. They stand iff friction >= tan 15 = 2 - sqrt(3) =
 * 0.26795, floor_friction >= tan(15) / 3 = 0.08932.
 *
 * With d too little, the lower ones part by an acceleration near g d that grows as the upper one
 * sinks between them: at 1e-4 that is 0.05 m, where they have fallen, within 10 s. */
#include "catalogue.h"
#include "round_pyramid.h"
#include "scene_builder.h"

#include <math.h>

enum { FRICTION, FLOOR_FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [FRICTION] = PL_PARAM_ROUND_FRICTION(0.28),
    [FLOOR_FRICTION] = PL_PARAM_ROUND_FLOOR_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static double critical(const double *values)
{
    const double tangent = 2 - sqrt(3);
    return values[FLOOR_FRICTION] > tangent / 3 ? tangent : (double)NAN;
}

static const pl_threshold threshold = {.param = "friction",
                                       .low = 0,
                                       .high = 1,
                                       .holds_below = false,
                                       .tolerance = 1e-5,
                                       .critical = critical,
                                       .formula = "tan 15 deg = 2 - sqrt(3)"};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double radius = 0.5, half_height = 0.5;
    pl_builder builder =
        pl_build_round_pyramid(scene, pl_scenario_cylinder_pyramid.name, values[DT],
                               values[DURATION], values[FRICTION], values[FLOOR_FRICTION], error);
    pl_body cylinder = pl_body_default();
    cylinder.shape = pl_shape_cylinder(radius, half_height);
    cylinder.orientation[0] = cylinder.orientation[1] = sqrt(0.5); /* its axis along y */
    for (int i = 0; i < 2; i++) {
        cylinder.position[0] = i == 0 ? -radius : radius;
        cylinder.position[2] = radius;
        pl_build_rest(&builder, pl_build_body(&builder, &cylinder, "lower %d", i + 1));
    }
    cylinder.position[0] = 0;
    cylinder.position[2] = radius + sqrt(3) * radius;
    pl_build_rest(&builder, pl_build_body(&builder, &cylinder, "upper"));
    pl_build_judge(&builder, pl_scenario_cylinder_pyramid.primary_error, PL_ROUND_COLLAPSE);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_cylinder_pyramid = {
    .name = "cylinder-pyramid",
    .title = "Three cylinders",
    .description = "A cylinder on two others that only friction keeps from rolling apart, with a "
                   "little more of it than that takes.",
    .reference = "they stand iff friction >= tan 15 deg = 0.26795 between them, and >= tan(15 deg) "
                 "/ 3 = 0.08932 on the floor",
    .expected = "ok: all at rest where they began, above both critical frictions; collapsed below: "
                "they roll apart",
    .source = "statics of each cylinder",
    .primary_error = "rest_position_error",
    .validity = "friction > 0.26795, floor_friction > 0.08932",
    .provokes = "what rolls is held by friction alone, at every contact near its cone: creep, a "
                "cone of too few sides or a cap on the iterations lets it roll apart; a right "
                "engine holds it to the last digit of tan 15 deg",
    .threshold = &threshold,
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_CYLINDER,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
