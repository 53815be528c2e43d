/* The table is what tests/benchmark/converged_references.py prints of ensembles of 16 members, each
 * displaced by 1e-4 of a body's size and 1e-4 rad, on plumb:accurate, ode:quick with 100
 * iterations and bullet:si with 100 iterations; falling-cubes also on mujoco:recommended. The step
 * is 1/480 s, of wall-collapse, pile, rubble and avalanche 1/240 s. Over each row stand the engines
 * that agree, as that script defines it; the interval holds the converged runs of all engines.
 *
 * No two engines agree on mass_height of falling-cubes, container and rubble, on energy_lost of
 * domino-into-pile, on spread_x of wall-collapse, nor on run_out_p95 of domino-spiral.
 *
 * In container on ode:quick boxes overlap by 0.29 to 0.47 m, and in two of the 16 members a box gets
 * out of the container; that widens the intervals. Of rubble, one run of each engine at 1/480 s lies
 * within the intervals, but for a spread_x 0.3 % below; in it ode:quick and bullet:si lose 2 to 3 J
 * less than at 1/240 s. */
#include "converged.h"

#include <string.h>

/* What converged engines agree on. It holds for the default of every parameter but dt, which may have
 * any value. */
typedef struct converged {
    const char *scenario;
    pl_statistic metric;
    double low, high, scale; /* as in pl_expect_statistic */
} converged;

/* clang-format off */
static const converged table[] = {
    /* plumb:accurate, bullet:si */
    {"wall-collapse", PL_STATISTIC_MASS_HEIGHT, 0.6623, 0.8188, 0.963},
    /* plumb:accurate, ode:quick, bullet:si */
    {"wall-collapse", PL_STATISTIC_RUN_OUT_P95, 24.05, 32.71, 63.3},
    /* plumb:accurate, ode:quick, bullet:si */
    {"wall-collapse", PL_STATISTIC_SPREAD_Y, 10.17, 11.28, 10.7},
    /* plumb:accurate, bullet:si */
    {"wall-collapse", PL_STATISTIC_ENERGY_LOST, 1.284e+04, 1.86e+04, 2.92e+04},
    /* mujoco:recommended, ode:quick */
    {"falling-cubes", PL_STATISTIC_RUN_OUT_P95, 1.649, 3.407, 7.94},
    /* ode:quick, bullet:si */
    {"falling-cubes", PL_STATISTIC_SPREAD_X, 1.608, 2.003, 2.34},
    /* plumb:accurate, bullet:si */
    {"falling-cubes", PL_STATISTIC_SPREAD_Y, 1.73, 2.398, 2.39},
    /* mujoco:recommended, bullet:si */
    {"falling-cubes", PL_STATISTIC_ENERGY_LOST, 663.5, 775.5, 715},
    /* plumb:accurate, ode:quick */
    {"pile", PL_STATISTIC_MASS_HEIGHT, 0.9109, 1.013, 0.973},
    /* plumb:accurate, ode:quick */
    {"pile", PL_STATISTIC_RUN_OUT_P95, 1.66, 2.042, 2.91},
    /* plumb:accurate, ode:quick */
    {"pile", PL_STATISTIC_SPREAD_X, 2.025, 2.173, 2.08},
    /* plumb:accurate, ode:quick, bullet:si */
    {"pile", PL_STATISTIC_SPREAD_Y, 2.036, 2.131, 2.08},
    /* plumb:accurate, ode:quick, bullet:si */
    {"pile", PL_STATISTIC_ENERGY_LOST, 2187, 2232, 2.21e+03},
    /* plumb:accurate, ode:quick, bullet:si */
    {"dominoes", PL_STATISTIC_MASS_HEIGHT, 0.2137, 0.2151, 0.214},
    /* ode:quick, bullet:si */
    {"dominoes", PL_STATISTIC_RUN_OUT_P95, 0.5696, 0.6243, 0.592},
    /* plumb:accurate, ode:quick, bullet:si */
    {"dominoes", PL_STATISTIC_SPREAD_X, 2.894, 2.903, 2.9},
    /* plumb:accurate, ode:quick */
    {"dominoes", PL_STATISTIC_SPREAD_Y, 0.000227, 0.01388, 2.9},
    /* plumb:accurate, ode:quick, bullet:si */
    {"dominoes", PL_STATISTIC_ENERGY_LOST, 55.98, 56.26, 56.2},
    /* plumb:accurate, ode:quick */
    {"domino-into-pile", PL_STATISTIC_MASS_HEIGHT, 0.3473, 0.3554, 0.353},
    /* plumb:accurate, ode:quick, bullet:si */
    {"domino-into-pile", PL_STATISTIC_RUN_OUT_P95, 0.5315, 0.5363, 0.534},
    /* plumb:accurate, ode:quick */
    {"domino-into-pile", PL_STATISTIC_SPREAD_X, 1.458, 1.477, 1.46},
    /* plumb:accurate, ode:quick */
    {"domino-into-pile", PL_STATISTIC_SPREAD_Y, 0.2418, 0.2477, 1.46},
    /* plumb:accurate, bullet:si */
    {"domino-spiral", PL_STATISTIC_MASS_HEIGHT, 0.3743, 0.3862, 0.375},
    /* plumb:accurate, ode:quick, bullet:si */
    {"domino-spiral", PL_STATISTIC_SPREAD_X, 2.769, 2.789, 2.87},
    /* plumb:accurate, ode:quick, bullet:si */
    {"domino-spiral", PL_STATISTIC_SPREAD_Y, 2.869, 2.872, 2.87},
    /* plumb:accurate, bullet:si */
    {"domino-spiral", PL_STATISTIC_ENERGY_LOST, 165.5, 183.2, 181},
    /* plumb:accurate, bullet:si */
    {"medley", PL_STATISTIC_MASS_HEIGHT, 0.3988, 0.4494, 0.422},
    /* plumb:accurate, ode:quick */
    {"medley", PL_STATISTIC_RUN_OUT_P95, 1.442, 1.935, 3.05},
    /* ode:quick, bullet:si */
    {"medley", PL_STATISTIC_SPREAD_X, 1.914, 2.052, 2.03},
    /* plumb:accurate, ode:quick, bullet:si */
    {"medley", PL_STATISTIC_SPREAD_Y, 1.96, 2.067, 2.03},
    /* plumb:accurate, ode:quick, bullet:si */
    {"medley", PL_STATISTIC_ENERGY_LOST, 628.9, 637.2, 633},
    /* plumb:accurate, ode:quick, bullet:si */
    {"container", PL_STATISTIC_RUN_OUT_P95, 1.142, 1.671, 3.23},
    /* plumb:accurate, bullet:si */
    {"container", PL_STATISTIC_SPREAD_X, 0.8483, 1.03, 0.93},
    /* plumb:accurate, bullet:si */
    {"container", PL_STATISTIC_SPREAD_Y, 0.8732, 1.217, 1.38},
    /* plumb:accurate, ode:quick */
    {"container", PL_STATISTIC_ENERGY_LOST, 447, 462.6, 453},
    /* plumb:accurate, ode:quick, bullet:si */
    {"rubble", PL_STATISTIC_RUN_OUT_P95, 1.064, 1.18, 1.11},
    /* plumb:accurate, ode:quick, bullet:si */
    {"rubble", PL_STATISTIC_SPREAD_X, 1.18, 1.207, 1.21},
    /* plumb:accurate, ode:quick, bullet:si */
    {"rubble", PL_STATISTIC_SPREAD_Y, 1.192, 1.224, 1.21},
    /* plumb:accurate, ode:quick */
    {"rubble", PL_STATISTIC_ENERGY_LOST, 640.9, 653.7, 648},
    /* plumb:accurate, ode:quick */
    {"avalanche", PL_STATISTIC_MASS_HEIGHT, 0.379, 0.4531, 0.417},
    /* plumb:accurate, ode:quick */
    {"avalanche", PL_STATISTIC_RUN_OUT_P95, 8.468, 8.874, 8.74},
    /* plumb:accurate, bullet:si */
    {"avalanche", PL_STATISTIC_SPREAD_X, 1.008, 1.21, 3.06},
    /* plumb:accurate, bullet:si */
    {"avalanche", PL_STATISTIC_SPREAD_Y, 2.878, 3.114, 3.06},
    /* plumb:accurate, ode:quick, bullet:si */
    {"avalanche", PL_STATISTIC_ENERGY_LOST, 813.9, 825.8, 820},
};
/* clang-format on */

static bool holds(const converged *row, const pl_scenario *scenario, const double *values)
{
    bool equal = strcmp(row->scenario, scenario->name) == 0;
    for (int i = 0; i < scenario->param_count && equal; ++i) {
        const pl_param *param = &scenario->params[i];
        equal = values[i] == param->value || strcmp(param->name, "dt") == 0;
    }
    return equal;
}

void pl_build_statistics(pl_builder *builder, const pl_scenario *scenario, const double *values,
                         uint64_t seed)
{
    const bool drawn = builder->random.state != seed;
    for (size_t i = 0; i < sizeof table / sizeof *table && (seed == 0 || !drawn); ++i) {
        const converged *row = &table[i];
        const pl_expect_statistic statistic = {
            .metric = row->metric, .low = row->low, .high = row->high, .scale = row->scale};
        if (builder->status == PL_OK && holds(row, scenario, values)) {
            builder->status = pl_scene_add_statistic(builder->scene, &statistic, builder->error);
        }
    }
}
