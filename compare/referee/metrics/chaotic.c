/* statistics_error: how far a run ended outside of what converged engines agree on.
 *
 * chaotic_error: the largest violation of what all right motions have in common, each part relative
 * to what can be seen:
 *
 *   penetration_p99    the overlap that 99 % of the touching pairs do not exceed, over L
 *   penetration_max    the deepest overlap, over 10 L: it may be seen for one frame only
 *   free_flight_error  of a body that meets no other
 *   energy_gain        over the energy of the scene
 *   momentum_error     over the momentum of the scene
 *   statistics_error   where the end statistics are known
 *
 * L is the least dimension of the smallest dynamic body: an overlap of L / 2 is a body half inside
 * another, and at L it has passed through. A bounding radius would hide that of thin bodies.
 *
 * The error is never below 1e-3. An overlap of a thousandth of a body is not visible, and below it
 * the error would measure constants that an engine's author chose, such as its slop.
 *
 * The residual of the contact law, natural_map, is no part: it needs impulses, so that engines
 * which report none would be spared. */
#include "expectations.h"

#include "plumb/jitter.h"

#include <math.h>
#include <string.h>

static const double RESOLUTION = 1e-3;
static const double WORST_FRAME = 10; /* how much deeper a single overlap may be */

static const pl_metric_id statistics[PL_STATISTIC_COUNT] = {
    [PL_STATISTIC_MASS_HEIGHT] = PL_METRIC_MASS_HEIGHT,
    [PL_STATISTIC_RUN_OUT_P95] = PL_METRIC_RUN_OUT_P95,
    [PL_STATISTIC_SPREAD_X] = PL_METRIC_SPREAD_X,
    [PL_STATISTIC_SPREAD_Y] = PL_METRIC_SPREAD_Y,
    [PL_STATISTIC_ENERGY_LOST] = PL_METRIC_ENERGY_LOST};

pl_metric_id pl_statistic_metric(pl_statistic statistic)
{
    return statistics[statistic];
}

/* Raises `largest` to `value`, of the part called `name`. */
static void raise_to(pl_metric *largest, const char *name, double value)
{
    if (largest->state != PL_METRIC_VALUE || value > largest->value) {
        *largest = pl_metric_value(value);
        largest->part = name;
    }
}

static pl_metric statistics_error(const pl_scene *scene, const pl_metric *item)
{
    pl_metric largest = {.state = PL_METRIC_ABSENT};
    for (int i = 0; i < scene->statistic_count; ++i) {
        const pl_expect_statistic *expected = &scene->statistics[i];
        const pl_metric_id id = statistics[expected->metric];
        if (item[id].state == PL_METRIC_FAILED) {
            return item[id];
        }
        if (item[id].state != PL_METRIC_VALUE) {
            return pl_metric_failed("the run has no %s", pl_metric_table[id].name);
        }
        const double value = item[id].value;
        const double outside = fmax(fmax(expected->low - value, value - expected->high), 0);
        raise_to(&largest, pl_metric_table[id].name, outside / expected->scale);
    }
    return largest;
}

static pl_metric chaotic_error(double size, const pl_metric *item)
{
    static const pl_metric_id plain[] = {PL_METRIC_FREE_FLIGHT_ERROR, PL_METRIC_ENERGY_GAIN,
                                         PL_METRIC_MOMENTUM_ERROR, PL_METRIC_STATISTICS_ERROR};
    pl_metric largest = pl_metric_failed("no metric that it consists of has a value");
    const pl_metric *penetration = &item[PL_METRIC_PENETRATION_MAX];
    if (penetration->state == PL_METRIC_VALUE) {
        raise_to(&largest, "penetration_p99", penetration->p99 / size);
        raise_to(&largest, "penetration_max", penetration->value / (WORST_FRAME * size));
    }
    for (size_t i = 0; i < sizeof plain / sizeof *plain; ++i) {
        if (item[plain[i]].state == PL_METRIC_VALUE) {
            raise_to(&largest, pl_metric_table[plain[i]].name, item[plain[i]].value);
        }
    }
    if (largest.state == PL_METRIC_VALUE) {
        raise_to(&largest, "resolution", RESOLUTION);
    }
    return largest;
}

void pl_chaotic_metrics(const pl_scene *scene, pl_metric *item)
{
    item[PL_METRIC_STATISTICS_ERROR] = statistics_error(scene, item);
    if (strcmp(scene->primary_error, pl_metric_table[PL_METRIC_CHAOTIC_ERROR].name) == 0) {
        item[PL_METRIC_CHAOTIC_ERROR] = chaotic_error(pl_scene_least_size(scene), item);
    }
}
