/* Cubes side by side on the floor, none touching another: what the source paper's Table 1 times. */
#include "catalogue.h"
#include "solids.h"

enum { COUNT, MESH, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 200,
               .min = 1,
               .max = 90000,
               .integer = true,
               .unit = "1",
               .help = "number of cubes"},
    [MESH] = {.name = "mesh",
              .value = 1,
              .min = 0,
              .max = 1,
              .integer = true,
              .unit = "1",
              .help = "0: boxes; 1: meshes of 12 triangles, as in the source paper"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

static const double half = 0.5, spacing = 1.5; /* m */

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_blocks.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body cube = pl_body_default();
    cube.shape = pl_shape_box(half, half, half);
    if (values[MESH] != 0) {
        pl_solid solid = pl_solid_box(half, half, half);
        const pl_polyhedron *mesh = pl_build_solid(&builder, &solid, false, "cube");
        cube.shape = mesh != NULL ? pl_shape_of(mesh) : cube.shape;
    }
    const int count = (int)values[COUNT];
    int columns = 1;
    while (columns * columns < count) {
        columns++;
    }
    for (int i = 0; i < count; i++) {
        cube.position[0] = spacing * (i % columns);
        cube.position[1] = spacing * (i / columns);
        cube.position[2] = half;
        pl_build_rest(&builder, pl_build_body(&builder, &cube, "cube %d", i + 1));
    }
    pl_build_judge(&builder, pl_scenario_blocks.primary_error, half);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_blocks = {
    .name = "blocks",
    .title = "Cubes on the floor",
    .description =
        "Cubes that lie on the floor apart from each other: no stack, so the time is all "
        "collision detection and many small contact problems.",
    .reference = "every cube stays where it is",
    .expected = "ok: every cube at rest where it began",
    .source = "statics",
    .primary_error = "rest_position_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_MESH,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
