/* A very slender rod that falls flat on the floor.
 *
 * A square rod 1 m long, 1 / slenderness m thick; its moments of inertia are in the ratio
 * (slenderness^2 + 1) / 2, half a million for the default. It is dropped level, so both ends
 * strike at once and it does not turn; without restitution it then lies still. */
#include "catalogue.h"
#include "scene_builder.h"

enum { SLENDERNESS, DROP, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [SLENDERNESS] = {.name = "slenderness",
                     .value = 1000,
                     .min = 1,
                     .max = 1e5,
                     .unit = "1",
                     .help = "length over thickness"},
    [DROP] = {.name = "drop",
              .value = 0.1,
              .min = 0,
              .max = 10,
              .unit = "m",
              .help = "height that it falls"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half_length = 0.5, half_thickness = half_length / values[SLENDERNESS];
    pl_builder builder = pl_build_begin(scene, pl_scenario_thin_rod.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body rod = pl_body_default();
    rod.shape = pl_shape_box(half_length, half_thickness, half_thickness);
    rod.position[2] = half_thickness;
    int index = pl_build_body(&builder, &rod, "rod");
    pl_build_rest(&builder, index);
    if (builder.status == PL_OK) {
        scene->bodies[index].position[2] += values[DROP];
    }
    pl_build_judge(&builder, pl_scenario_thin_rod.primary_error, 0.05);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_thin_rod = {
    .name = "thin-rod",
    .title = "Slender rod that falls flat",
    .description = "A rod of 1 m and 1 mm thickness that falls level: moments of inertia that "
                   "differ by half a million, and a body thinner than it falls in a step.",
    .reference = "it lies where it fell: z = half its thickness, not turned",
    .expected = "ok: the rod lies flat where it fell",
    .source = "by symmetry",
    .primary_error = "rest_position_error",
    .validity = "the run lasts until it lies: duration > sqrt(2 drop / g)",
    .provokes = "the rod passes through the floor, spins up about its long axis, where the least "
                "moment turns it, or never comes to rest; in a right engine it lies down and stays",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
