/* A heavy cube on a light one.
 *
 * The light cube, of side 1 m and 1 kg, stands on the floor; the heavy one, of the same size and
 * 10^k kg, exactly on it. Statics: nothing moves, and with m = 1 kg and M = 10^k kg the contact
 * between them carries M g, that with the floor (M + m) g. An iteration that passes impulses from
 * contact to contact needs about M / m of them to do so. */
#include "catalogue.h"
#include "scene_builder.h"

enum { EXPONENT, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [EXPONENT] = {.name = "k",
                  .value = 2,
                  .min = 0,
                  .max = 6,
                  .integer = true,
                  .unit = "1",
                  .help = "the upper cube is 10^k times as heavy as the lower"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static const double side = 1;

static void build_cube(pl_builder *builder, const char *name, double mass, double height)
{
    pl_body cube = pl_body_default();
    cube.shape = pl_shape_box(side / 2, side / 2, side / 2);
    cube.mass = mass;
    cube.position[2] = height;
    pl_build_rest(builder, pl_build_body(builder, &cube, "%s", name));
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_mass_ratio.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    double mass = 1;
    for (int i = 0; i < (int)values[EXPONENT]; i++) {
        mass *= 10;
    }
    pl_build_floor(&builder, 0, 0, 1, 0);
    build_cube(&builder, "light", 1, side / 2);
    build_cube(&builder, "heavy", mass, side / 2 + side);
    pl_build_judge(&builder, pl_scenario_mass_ratio.primary_error, side / 2);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_mass_ratio = {
    .name = "mass-ratio",
    .title = "Heavy cube on a light one",
    .description =
        "A cube of 10^k kg at rest on one of 1 kg: whether a solver carries a large weight "
        "through a small mass.",
    .reference = "both cubes stay where they are: z = 1/2 m and 3/2 m; the contacts carry M g and "
                 "(M + m) g",
    .expected = "ok: both cubes at rest where they began, at any ratio",
    .source = "statics",
    .primary_error = "rest_position_error",
    .provokes = "a large weight through a small mass: an iteration passes on a part of it at a "
                "time, so the light cube is squeezed and the heavy one falls; a right engine "
                "holds it still",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
