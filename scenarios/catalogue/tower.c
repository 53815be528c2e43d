/* A tower of n unit cubes.
 *
 * Cube k = 1 .. n of side 1 stands with its centre at z = k - 1/2, exactly on the one below. Its
 * mass is m_k = rising_mass^((k - 1) / (n - 1)) kg, times top_mass for k = n, so that cube 1 of
 * several weighs 1 kg. With `offset`, each is moved in x and y by a uniform random part of up to
 * offset * side. No cube is then more than 2 * 0.2 sides off any other, so the centre of mass of
 * all cubes above a joint, a mean of theirs whatever their masses, lies within half a side of the
 * centres of both cubes at the joint: it stands by statics, and nothing moves. */
#include "base/random.h"
#include "catalogue.h"
#include "scene_builder.h"

enum { COUNT, FRICTION, OFFSET, TOP_MASS, RISING_MASS, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = PL_PARAM_CUBES,
    [FRICTION] = PL_PARAM_FRICTION,
    [OFFSET] = {.name = "offset",
                .value = 0,
                .min = 0,
                .max = 0.2,
                .unit = "1",
                .help = "largest random displacement in x and in y, in sides of a cube"},
    [TOP_MASS] = {.name = "top_mass",
                  .value = 1,
                  .min = 1,
                  .max = 1e6,
                  .unit = "1",
                  .help = "how many times heavier the top cube is"},
    [RISING_MASS] = {.name = "rising_mass",
                     .value = 1,
                     .min = 1,
                     .max = 1e6,
                     .unit = "1",
                     .help = "mass of the top over the bottom, in equal ratios from cube to cube "
                             "(before top_mass)"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static const double side = 1;

static double displacement(pl_random *random, double offset)
{
    /* Not 0 times something negative, which would be -0. */
    return offset > 0 ? offset * side * (2 * pl_random_unit(random) - 1) : 0;
}

/* The n-th root of ratio >= 1, from below, by bisection down to neighbouring numbers: the same bits
 * on every machine, which pow does not give. */
static double root(double ratio, int n)
{
    double low = 1, high = ratio;
    for (;;) {
        double middle = low + (high - low) / 2, power = 1;
        if (middle <= low || middle >= high) {
            return low;
        }
        for (int i = 0; i < n && power <= ratio; i++) {
            power *= middle;
        }
        *(power <= ratio ? &low : &high) = middle;
    }
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    pl_random random = {.state = seed};
    pl_builder builder = pl_build_begin(scene, pl_scenario_tower.name, values[DT], values[DURATION],
                                        values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    const int count = (int)values[COUNT];
    const double growth = count > 1 ? root(values[RISING_MASS], count - 1) : 1;
    double mass = 1;
    for (int k = 1; k <= count; k++, mass *= growth) {
        pl_body cube = pl_body_default();
        cube.mass = k == count ? mass * values[TOP_MASS] : mass;
        cube.shape = pl_shape_box(side / 2, side / 2, side / 2);
        cube.position[0] = displacement(&random, values[OFFSET]);
        cube.position[1] = displacement(&random, values[OFFSET]);
        cube.position[2] = (k - 0.5) * side;
        pl_build_rest(&builder, pl_build_body(&builder, &cube, "cube %d", k));
    }
    pl_build_judge(&builder, pl_scenario_tower.primary_error, side / 2);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_tower = {
    .name = "tower",
    .title = "Tower of cubes",
    .description =
        "n unit cubes of 1 kg stacked exactly, at rest: whether a solver carries the weight "
        "of the whole tower through every contact, and for how long. The cubes may be displaced, "
        "or grow heavier upwards.",
    .reference = "every cube stays where it is: z_k = k - 1/2 m, for any masses and "
                 "offsets",
    .expected = "ok: every cube at rest where it began, for any number, masses and offsets",
    .source = "statics",
    .primary_error = "rest_position_error",
    .provokes = "a weight that must pass through every contact: a solver of few iterations lets "
                "the tower sink, sway and fall; a right engine holds any number of cubes still",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
