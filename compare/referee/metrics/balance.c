/* energy_gain, energy_step_gain, momentum_error and energy_lost: the balance of energy and momentum, by
 * mechanics.c.
 *
 * The engine's integrator is detected only when something has accelerated. So each integrator has its
 * own series, and that of the detected one is chosen at the end. */
#include "modules.h"
#include "series.h"

typedef struct balance {
    pl_series energy[PL_POSITION_RULE_COUNT], step_gain[PL_POSITION_RULE_COUNT],
        momentum[PL_POSITION_RULE_COUNT];
} balance;

static void *create(const pl_scene *scene, pl_arena *arena)
{
    (void)scene;
    balance *b = pl_arena_take(arena, 1, sizeof *b);
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        pl_series_init(&b->energy[k], arena);
        pl_series_init(&b->step_gain[k], arena);
        pl_series_init(&b->momentum[k], arena);
    }
    return b;
}

static void see(void *state, const pl_run_view *view)
{
    balance *b = state;
    const pl_mechanics *mechanics = view->mechanics;
    const pl_scale *scale = &view->scale;
    const long step = view->step.number;
    for (pl_position_rule k = 0; step > 0 && k < PL_POSITION_RULE_COUNT; ++k) {
        const double gain = pl_mechanics_energy_gain(mechanics, scale, k) -
                            pl_mechanics_energy_rounding(mechanics) / scale->energy;
        const double error = pl_mechanics_momentum_error(mechanics, scale, k);
        const double growth =
            pl_touching_island_max(view->touching, pl_mechanics_growth(mechanics, k));
        pl_series_add(&b->energy[k], fmax(pl_or_infinity(gain), 0), step);
        pl_series_add(&b->momentum[k], pl_or_infinity(error), step);
        pl_series_add(&b->step_gain[k], fmax(growth / scale->energy, 0), step);
    }
}

static pl_metric maximum(const pl_series *series)
{
    return pl_series_metric(series, series->max);
}

static void collect(void *state, const pl_run_view *view, pl_metric *item)
{
    const balance *b = state;
    const pl_position_rule k = view->integrator;
    const double gain = pl_mechanics_energy_gain(view->mechanics, &view->scale, k);
    item[PL_METRIC_ENERGY_GAIN] = maximum(&b->energy[k]);
    item[PL_METRIC_ENERGY_STEP_GAIN] = maximum(&b->step_gain[k]);
    item[PL_METRIC_MOMENTUM_ERROR] = maximum(&b->momentum[k]);
    item[PL_METRIC_ENERGY_LOST] = pl_metric_value(-gain * view->scale.energy);
}

const pl_module pl_balance_module = {create, see, collect, .needs_no_motion = false};
