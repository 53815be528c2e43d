/* Four equal spheres: three on the floor, which touch, and one upon them.
 *
 * The upper centre is at the top of a regular tetrahedron: lines to the lower ones lean by a from
 * the vertical, cos a = sqrt(2/3), sin a = 1/sqrt(3). As for three cylinders (cylinder_pyramid.c),
 * T / N = sin a / (1 + cos a) = sqrt(3) - sqrt(2). The upper one: 3 (N cos a + T sin a) = W, so
 * N = W / 3; the floor carries 4/3 W under each lower one, and F / that = (sqrt(3) - sqrt(2)) / 4.
 * They stand iff friction >= sqrt(3) - sqrt(2) = 0.31784, floor_friction >= (sqrt(3) - sqrt(2)) / 4
 * = 0.07946.
 *
 * The growth beyond is that of the cylinders. */
#include "catalogue.h"
#include "round_pyramid.h"
#include "scene_builder.h"

#include <math.h>

enum { FRICTION, FLOOR_FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [FRICTION] = PL_PARAM_ROUND_FRICTION(0.33),
    [FLOOR_FRICTION] = PL_PARAM_ROUND_FLOOR_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static double critical(const double *values)
{
    const double tangent = sqrt(3) - sqrt(2);
    return values[FLOOR_FRICTION] > tangent / 4 ? tangent : (double)NAN;
}

static const pl_threshold threshold = {.param = "friction",
                                       .low = 0,
                                       .high = 1,
                                       .holds_below = false,
                                       .tolerance = 1e-5,
                                       .critical = critical,
                                       .formula = "sqrt(3) - sqrt(2)"};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double radius = 0.5, out = 2 * radius / sqrt(3);
    const double lower[3][2] = {{out, 0}, {-out / 2, radius}, {-out / 2, -radius}};
    pl_builder builder =
        pl_build_round_pyramid(scene, pl_scenario_sphere_pyramid.name, values[DT], values[DURATION],
                               values[FRICTION], values[FLOOR_FRICTION], error);
    pl_body sphere = pl_body_default();
    sphere.shape = pl_shape_sphere(radius);
    sphere.position[2] = radius;
    for (int i = 0; i < 3; i++) {
        sphere.position[0] = lower[i][0];
        sphere.position[1] = lower[i][1];
        pl_build_rest(&builder, pl_build_body(&builder, &sphere, "lower %d", i + 1));
    }
    sphere.position[0] = sphere.position[1] = 0;
    sphere.position[2] = radius + 2 * radius * sqrt(2.0 / 3);
    pl_build_rest(&builder, pl_build_body(&builder, &sphere, "upper"));
    pl_build_judge(&builder, pl_scenario_sphere_pyramid.primary_error, PL_ROUND_COLLAPSE);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_sphere_pyramid = {
    .name = "sphere-pyramid",
    .title = "Four spheres",
    .description = "A sphere on three others that only friction keeps from rolling apart, with a "
                   "little more of it than that takes.",
    .reference = "they stand iff friction >= sqrt(3) - sqrt(2) = 0.31784 between them, and >= a "
                 "quarter of that, 0.07946, on the floor",
    .expected = "ok: all at rest where they began, above both critical frictions; collapsed below: "
                "they roll apart",
    .source = "statics of each sphere",
    .primary_error = "rest_position_error",
    .validity = "friction > 0.31784, floor_friction > 0.07946",
    .provokes =
        "friction in directions along no axis, at every contact near its cone: a pyramid in "
        "place of the cone holds too much or too little, and creep lets the spheres roll "
        "apart; a right engine holds them",
    .threshold = &threshold,
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
