/* Towers of unit cubes beside each other, k by k of them, 1 m apart: each is a problem of its own,
 * and none may disturb another. */
#include "catalogue.h"
#include "scene_builder.h"

enum { SIDE, COUNT, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [SIDE] = {.name = "k",
              .value = 5,
              .min = 1,
              .max = 30,
              .integer = true,
              .unit = "1",
              .help = "towers along either side of the square"},
    [COUNT] = {.name = "n",
               .value = 25,
               .min = 1,
               .max = 100,
               .integer = true,
               .unit = "1",
               .help = "cubes of a tower"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half = 0.5, spacing = 2;
    const int towers = (int)values[SIDE], count = (int)values[COUNT];
    pl_builder builder = pl_build_begin(scene, pl_scenario_multi_tower.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    for (int tower = 0; tower < towers * towers; tower++) {
        for (int k = 0; k < count; k++) {
            pl_body cube = pl_body_default();
            cube.shape = pl_shape_box(half, half, half);
            cube.position[0] = spacing * (tower % towers);
            cube.position[1] = spacing * (tower / towers);
            cube.position[2] = half + k;
            pl_build_rest(&builder, pl_build_body(&builder, &cube, "cube %d.%d", tower + 1, k + 1));
        }
    }
    pl_build_judge(&builder, pl_scenario_multi_tower.primary_error, half);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_multi_tower = {
    .name = "multi-tower",
    .title = "Field of towers",
    .description =
        "A square of towers of cubes, at rest: many stacks at once, each of them as hard "
        "as if it were alone. Figure 4 of the source paper, " PL_SOURCE_PAPER ".",
    .reference = "every cube stays where it is: z_k = k - 1/2 m",
    .expected = "ok: every cube of every tower at rest where it began",
    .source = "statics",
    .primary_error = "rest_position_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
