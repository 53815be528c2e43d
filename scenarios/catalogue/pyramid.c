/* A pyramid of unit cubes in a plane: n cubes in the lowest row, one less in each above, each over
 * the gap between two.
 *
 * Cube i of row r, both from 0, has its centre at x = (1 + gap) (i - (n - 1 - r) / 2), z = r + 1/2:
 * rows lie symmetric about x = 0, so that each cube rests on the two below it with the same weight.
 * It stands by statics without any friction. */
#include "catalogue.h"
#include "scene_builder.h"

enum { COUNT, GAP, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 10,
               .min = 1,
               .max = 100,
               .integer = true,
               .unit = "1",
               .help = "cubes in the lowest row"},
    [GAP] = {.name = "gap",
             .value = 0.125,
             .min = 0,
             .max = 0.75,
             .unit = "1",
             .help = "between cubes of a row, over their side; 0: they touch"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half = 0.5, spacing = 1 + values[GAP];
    const int count = (int)values[COUNT];
    pl_builder builder = pl_build_begin(scene, pl_scenario_pyramid.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    for (int row = 0; row < count; row++) {
        for (int i = 0; i < count - row; i++) {
            pl_body cube = pl_body_default();
            cube.shape = pl_shape_box(half, half, half);
            cube.position[0] = spacing * (i - (count - 1 - row) / 2.0);
            cube.position[2] = row + half;
            pl_build_rest(&builder, pl_build_body(&builder, &cube, "cube %d.%d", row + 1, i + 1));
        }
    }
    pl_build_judge(&builder, pl_scenario_pyramid.primary_error, half);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_pyramid = {
    .name = "pyramid",
    .title = "Pyramid of cubes",
    .description = "Cubes in rows, each on the two below it, at rest: the weight spreads over many "
                   "ways to the floor.",
    .reference = "every cube stays where it is: z = row - 1/2 m",
    .expected = "ok: every cube at rest where it began, even without friction",
    .source = "statics",
    .primary_error = "rest_position_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
