/* A tower of unit cubes, stepped ten times a second: a cube in free fall would drop by 0.1 m in one
 * step. At rest the length of a step changes nothing. */
#include "catalogue.h"
#include "scene_builder.h"

enum { COUNT, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = PL_PARAM_CUBES,
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = {.name = "dt", .value = 0.1, .min = 1e-6, .max = 1, .unit = "s", .help = "time step"},
    [DURATION] = PL_PARAM_DURATION(20),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half = 0.5;
    pl_builder builder = pl_build_begin(scene, pl_scenario_large_step.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    for (int k = 0; k < (int)values[COUNT]; k++) {
        pl_body cube = pl_body_default();
        cube.shape = pl_shape_box(half, half, half);
        cube.position[2] = half + k;
        pl_build_rest(&builder, pl_build_body(&builder, &cube, "cube %d", k + 1));
    }
    pl_build_judge(&builder, pl_scenario_large_step.primary_error, half);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_large_step = {
    .name = "large-step",
    .title = "Tower at ten steps a second",
    .description = "A tower of cubes at rest with a step of 1/10 s: whether what stands depends on "
                   "how often it is looked at.",
    .reference = "every cube stays where it is, at any step",
    .expected = "ok: every cube at rest where it began, as at short steps",
    .source = "statics",
    .primary_error = "rest_position_error",
    .provokes = "what a step does wrong grows with its square: cubes sink into each other, are "
                "pushed out too fast, and the tower jumps or falls; a right engine leaves it alone",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
