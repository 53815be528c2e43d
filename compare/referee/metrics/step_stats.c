/* The iterations, residuals, contacts and times that an engine reports of its steps. */
#include "modules.h"

static void see(void *state, const pl_run_view *view)
{
    (void)state;
    pl_see_value(view, PL_METRIC_TIME_PER_STEP, view->step.cpu_time);
    if (view->step.stats != NULL) {
        pl_see_value(view, PL_METRIC_ITERATIONS_MEAN, view->step.stats->iterations);
        pl_see_value(view, PL_METRIC_ITERATIONS_MAX, view->step.stats->iterations);
        pl_see_value(view, PL_METRIC_RESIDUAL_MAX, view->step.stats->residual);
        pl_see_value(view, PL_METRIC_RESIDUAL_RMS, view->step.stats->residual);
        pl_see_value(view, PL_METRIC_CONTACTS_MEAN, view->step.stats->contacts);
    }
}

static void collect(void *state, const pl_run_view *view, pl_metric *item)
{
    (void)state;
    static const pl_metric_id reported[] = {PL_METRIC_TIME_PER_STEP,  PL_METRIC_ITERATIONS_MEAN,
                                            PL_METRIC_ITERATIONS_MAX, PL_METRIC_CONTACTS_MEAN,
                                            PL_METRIC_RESIDUAL_MAX,   PL_METRIC_RESIDUAL_RMS};
    for (size_t i = 0; i < sizeof reported / sizeof *reported; ++i) {
        pl_metric *metric = &item[reported[i]];
        if (metric->state == PL_METRIC_ABSENT) {
            *metric = pl_metric_failed("the engine reports none");
        }
        if (pl_metric_is((int)reported[i], PL_TRAIT_OWN_UNIT)) {
            metric->unit = view->residual_unit;
        }
        if (pl_metric_is((int)reported[i], PL_TRAIT_OWN_UNIT) && view->residual_unit == NULL) {
            *metric = (pl_metric){0};
        }
    }
}

const pl_module pl_step_stats_module = {.see = see, .collect = collect, .needs_no_motion = true};
