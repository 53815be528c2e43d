/* A tower of unit cubes far from the origin, along a direction and turned by an angle of its own:
 * numbers near 10 km are 2e-12 m apart, so nothing about it is exact. */
#include "catalogue.h"
#include "degree.h"
#include "scene_builder.h"
#include "trigonometry.h"

enum { COUNT, DISTANCE, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = PL_PARAM_CUBES,
    [DISTANCE] = {.name = "distance",
                  .value = 1e4,
                  .min = 0,
                  .max = 1e7,
                  .unit = "m",
                  .help = "of the tower from the origin, along the floor"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half = 0.5, azimuth = 30 * PL_RADIANS_PER_DEGREE;
    pl_builder builder = pl_build_begin(scene, pl_scenario_far_from_origin.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    for (int k = 0; k < (int)values[COUNT]; k++) {
        pl_body cube = pl_body_default();
        cube.shape = pl_shape_box(half, half, half);
        cube.position[0] = values[DISTANCE] * pl_cosine(azimuth);
        cube.position[1] = values[DISTANCE] * pl_sine(azimuth);
        cube.position[2] = half + k;
        cube.orientation[0] = pl_cosine(azimuth / 2);
        cube.orientation[3] = pl_sine(azimuth / 2);
        pl_build_rest(&builder, pl_build_body(&builder, &cube, "cube %d", k + 1));
    }
    pl_build_judge(&builder, pl_scenario_far_from_origin.primary_error, half);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_far_from_origin = {
    .name = "far-from-origin",
    .title = "Tower 10 km away",
    .description =
        "A tower of cubes 10 km from the origin, turned by 30 degrees: whether an engine "
        "works with differences of positions or with positions.",
    .reference = "every cube stays where it is",
    .expected = "ok: every cube at rest where it began, as at the origin",
    .source = "statics, by the law's indifference to place",
    .primary_error = "rest_position_error",
    .provokes = "digits are lost where moments or planes are taken about the origin, so that "
                "contacts flicker and the tower creeps; a right engine is as good as at the origin "
                "but for the rounding of the positions",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
