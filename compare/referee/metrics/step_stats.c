/* The iterations, residuals, contacts and times that an engine reports of its steps. */
#include "modules.h"
#include "series.h"

typedef enum series_id { OF_ITERATIONS, OF_RESIDUAL, OF_CONTACTS, OF_TIME, SERIES_COUNT } series_id;

typedef struct step_stats {
    pl_series series[SERIES_COUNT];
} step_stats;

static void *create(const pl_scene *scene, pl_arena *arena)
{
    (void)scene;
    step_stats *s = pl_arena_take(arena, 1, sizeof *s);
    for (int i = 0; i < SERIES_COUNT; ++i) {
        pl_series_init(&s->series[i], arena);
    }
    return s;
}

static void see(void *state, const pl_run_view *view)
{
    pl_series *series = ((step_stats *)state)->series;
    const long step = view->step.number;
    if (step == 0) {
        return;
    }
    pl_series_add(&series[OF_TIME], view->cpu_time, step);
    if (view->stats != NULL) {
        pl_series_add(&series[OF_ITERATIONS], view->stats->iterations, step);
        pl_series_add(&series[OF_RESIDUAL], view->stats->residual, step);
        pl_series_add(&series[OF_CONTACTS], view->stats->contacts, step);
    }
}

static pl_metric reported(const pl_series *series, double value)
{
    return series->count > 0 ? pl_series_metric(series, value)
                             : pl_metric_failed("the engine reports none");
}

static void collect(void *state, const pl_run_view *view, pl_metric *item)
{
    const pl_series *s = ((const step_stats *)state)->series, *residual = &s[OF_RESIDUAL];
    item[PL_METRIC_ITERATIONS_MEAN] =
        reported(&s[OF_ITERATIONS], pl_series_mean(&s[OF_ITERATIONS]));
    item[PL_METRIC_ITERATIONS_MAX] = reported(&s[OF_ITERATIONS], s[OF_ITERATIONS].max);
    item[PL_METRIC_CONTACTS_MEAN] = reported(&s[OF_CONTACTS], pl_series_mean(&s[OF_CONTACTS]));
    item[PL_METRIC_TIME_PER_STEP] = reported(&s[OF_TIME], pl_series_mean(&s[OF_TIME]));
    if (view->residual_unit != NULL) {
        item[PL_METRIC_RESIDUAL_MAX] = reported(residual, residual->max);
        item[PL_METRIC_RESIDUAL_RMS] = reported(residual, pl_series_rms(residual));
        item[PL_METRIC_RESIDUAL_MAX].unit = item[PL_METRIC_RESIDUAL_RMS].unit = view->residual_unit;
    }
}

const pl_module pl_step_stats_module = {create, see, collect, .needs_no_motion = true};
