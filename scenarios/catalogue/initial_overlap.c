/* A tower of unit cubes that overlap at the start, each with the next and the lowest with the
 * floor.
 *
 * Cube k = 1 .. n starts at z = k - 1/2 - k overlap and belongs at k - 1/2: to part them lifts cube
 * k by k overlap, and takes m g overlap n (n + 1) / 2 of energy, no more. */
#include "catalogue.h"
#include "scene_builder.h"

enum { COUNT, OVERLAP, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 5,
               .min = 1,
               .max = 100,
               .integer = true,
               .unit = "1",
               .help = "number of cubes"},
    [OVERLAP] = {.name = "overlap",
                 .value = 0.01,
                 .min = 0,
                 .max = 0.2,
                 .unit = "1",
                 .help = "of two neighbours at the start, over their side"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half = 0.5;
    pl_builder builder = pl_build_begin(scene, pl_scenario_initial_overlap.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    for (int k = 1; k <= (int)values[COUNT]; k++) {
        pl_body cube = pl_body_default();
        cube.shape = pl_shape_box(half, half, half);
        cube.position[2] = k - half;
        int index = pl_build_body(&builder, &cube, "cube %d", k);
        pl_build_rest(&builder, index);
        if (builder.status == PL_OK) {
            scene->bodies[index].position[2] -= k * values[OVERLAP];
        }
    }
    pl_build_judge(&builder, pl_scenario_initial_overlap.primary_error, half);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_initial_overlap = {
    .name = "initial-overlap",
    .title = "Tower that starts overlapping",
    .description = "Cubes that overlap by 1 % at the start: an engine must part them without "
                   "throwing them, as after any mistake of its own or of a user.",
    .reference = "the cubes come to stand on each other, z_k = k - 1/2 m",
    .expected = "ok: the cubes part without a jump and rest on each other",
    .source = "impenetrability and statics",
    .primary_error = "rest_position_error",
    .provokes = "overlap turned into speed: the tower jumps and gains energy, or stays overlapped; "
                "a right engine parts it gently and leaves no more than its slop",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
