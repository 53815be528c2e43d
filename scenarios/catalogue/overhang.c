/* A harmonic stack: n equal blocks, each as far out over the one below as balance allows, times a
 * factor.
 *
 * Block k, from the top, is out over the next, and the lowest over the table, by factor L / (2 k).
 * The centre of mass of the top k blocks is then factor L / 2 out from the centre of the next: let
 * it be so for k - 1, and take moments,
 *     (k - 1) / k factor L / 2 + factor L / (2 k) = factor L / 2.
 * So all joints are at balance together at factor 1: the stack stands below and every joint opens
 * above. There the whole weight rests on the edge of each block.
 *
 * The top block alone, beyond by d in factor, turns about the edge by an angle that grows as
 * d cosh(k t), k^2 = g h / (2 I), with its height h = 1/4 m and its moment of inertia about the
 * edge for 1 kg, I = 0.104 m^2: k = 3.4 / s, so d = 1e-6 is a fall within 5 s. */
#include "catalogue.h"
#include "scene_builder.h"

enum { COUNT, FACTOR, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 5,
               .min = 1,
               .max = 50,
               .integer = true,
               .unit = "1",
               .help = "number of blocks"},
    [FACTOR] = {.name = "factor",
                .value = 0.98,
                .min = 0,
                .max = 1.5,
                .unit = "1",
                .help = "overhang of every block over the largest that balances"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static double critical(const double *values)
{
    (void)values;
    return 1;
}

static const pl_threshold threshold = {.param = "factor",
                                       .low = 0.5,
                                       .high = 1.3,
                                       .holds_below = true,
                                       .tolerance = 1e-5,
                                       .critical = critical,
                                       .formula = "1"};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half_length = 0.5, half_width = 0.25, half_height = 0.125;
    const int count = (int)values[COUNT];
    pl_builder builder = pl_build_begin(scene, pl_scenario_overhang.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    /* The table's edge is x = 0, its top z = 0. */
    pl_body block = pl_body_default();
    block.shape = pl_shape_box(half_length, half_width, half_height);
    pl_body table = block;
    table.is_static = true;
    table.position[0] = -half_length;
    table.position[2] = -half_height;
    pl_build_body(&builder, &table, "table");
    double x = -half_length;
    for (int k = count; k >= 1; k--) {
        x += values[FACTOR] * half_length / k;
        block.position[0] = x;
        block.position[2] = (2 * (count - k) + 1) * half_height;
        pl_build_rest(&builder, pl_build_body(&builder, &block, "block %d", count - k + 1));
    }
    pl_build_judge(&builder, pl_scenario_overhang.primary_error, half_height);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_overhang = {
    .name = "overhang",
    .title = "Blocks over the table's edge",
    .description =
        "A stack of blocks that leans out as far as balance allows, times a factor: at 1 "
        "every joint is at its limit at once.",
    .reference = "it stands iff factor <= 1: the top is out by L/2 (1 + 1/2 + ... + 1/n)",
    .expected = "ok: every block at rest where it began, at factors below 1; collapsed above: the "
                "stack tips",
    .source = "statics, as in Hall 2005, Fun with stacking blocks; more than one block to a level "
              "would reach farther: Paterson and Zwick 2009, Overhang",
    .primary_error = "rest_position_error",
    .validity = "factor < 1",
    .provokes =
        "each block rests on an edge, so that a contact that gives way a little tips all above it; "
        "a right engine stands at 0.999 and falls at 1.001",
    .threshold = &threshold,
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
