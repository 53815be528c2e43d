/* A row of dominoes of which the first is tipped over.
 *
 * It starts upright, turning about its leading lower edge with `push` times the spin that just
 * carries it over: 1/2 I w^2 = m g (R - height / 2), I = 4/3 m R^2, R half the diagonal of its
 * side. All lengths go with `size`, so that all times go with its square root: the wave runs
 * sqrt(s) times as fast in a row s times as large. */
#include "catalogue.h"
#include "domino.h"

#include <math.h>

enum { COUNT, SIZE, SPACING, PUSH, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 20,
               .min = 1,
               .max = 2000,
               .integer = true,
               .unit = "1",
               .help = "dominoes"},
    [SIZE] = {.name = "size",
              .value = 1,
              .min = 0.01,
              .max = 100,
              .unit = "m",
              .help = "height of a domino; it is half as wide and 0.15 as thick"},
    [SPACING] = {.name = "spacing",
                 .value = 0.5,
                 .min = 0.2,
                 .max = 0.9,
                 .unit = "1",
                 .help = "from one to the next, over the height"},
    [PUSH] = {.name = "push",
              .value = 1.2,
              .min = 0,
              .max = 10,
              .unit = "1",
              .help = "spin of the first, over that which just tips it"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(5),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_dominoes.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_build_dominoes(&builder, (int)values[COUNT], values[SIZE], values[SPACING], values[PUSH]);
    pl_build_judge(&builder, pl_scenario_dominoes.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_dominoes = {
    .name = "dominoes",
    .title = "Row of dominoes",
    .description = "A row of dominoes, the first of them tipped over: a wave of impacts that every "
                   "engine must hand on without overlap.",
    .reference = "no closed form for the motion; no overlap at any time: penetration 0; in a row s "
                 "times as large all speeds are sqrt(s) times as high",
    .expected = "ok: the wave runs to the last domino, with push above 1; no two bodies overlap at "
                "any time",
    .source = "impenetrability; dimensional analysis",
    .primary_error = "penetration_max",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
