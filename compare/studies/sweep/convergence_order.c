/* Observed orders of convergence: least squares of log error over log dt. */
#include "analysis.h"

#include "base/heap.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>

/* The error converges where it falls at least as fast as dt to this power. */
static const double least_slope = 0.25;

/* Neighbouring time steps [first, last]. */
typedef struct segment {
    int first, last;
} segment;

static double slope_after(const double *dt, const double *error, int i)
{
    return log(error[i] / error[i + 1]) / log(dt[i] / dt[i + 1]);
}

static bool converges_after(const double *dt, const double *error, int i)
{
    return error[i] > pl_sweep_error_floor && error[i + 1] > pl_sweep_error_floor &&
           slope_after(dt, error, i) >= least_slope;
}

static segment longest_segment(const double *dt, const double *error, int count)
{
    segment best = {0, 0}, now = {0, 0};
    for (int i = 0; i + 1 < count; ++i) {
        if (!converges_after(dt, error, i)) {
            now.first = i + 1;
        }
        now.last = i + 1;
        if (now.last > now.first && now.last - now.first >= best.last - best.first) {
            best = now;
        }
    }
    return best;
}

/* Cuts off ends that fall less than half as fast as the median; three time steps stay. */
static segment without_slow_ends(const double *dt, const double *error, segment part)
{
    double *scratch = pl_heap_new((size_t)(part.last - part.first), sizeof *scratch);
    for (int i = part.first; i < part.last; ++i) {
        scratch[i - part.first] = slope_after(dt, error, i);
    }
    double bound = 0.5 * pl_median(scratch, part.last - part.first);
    free(scratch);
    while (part.last - part.first > 2 && slope_after(dt, error, part.last - 1) < bound) {
        --part.last;
    }
    while (part.last - part.first > 2 && slope_after(dt, error, part.first) < bound) {
        ++part.first;
    }
    return part;
}

static void fit(const double *dt, const double *error, segment part, pl_sweep_order *order)
{
    const int count = part.last - part.first + 1;
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0, squares = 0;
    for (int i = part.first; i <= part.last; ++i) {
        mean_x += log10(dt[i]) / count;
        mean_y += log10(error[i]) / count;
    }
    for (int i = part.first; i <= part.last; ++i) {
        xx += (log10(dt[i]) - mean_x) * (log10(dt[i]) - mean_x);
        xy += (log10(dt[i]) - mean_x) * (log10(error[i]) - mean_y);
    }
    order->order = xy / xx;
    for (int i = part.first; i <= part.last; ++i) {
        double off = log10(error[i]) - mean_y - order->order * (log10(dt[i]) - mean_x);
        squares += off * off;
    }
    order->deviation = sqrt(squares / count);
    order->dt_high = dt[part.first];
    order->dt_low = dt[part.last];
    order->used = count;
}

pl_sweep_order pl_order_fit(const double *dt, const double *error, int count)
{
    const double none = (double)NAN;
    pl_sweep_order order = {"not converging", none, none, none, none, 0, count};
    int known = 0, at_floor = 0;
    for (int i = 0; i < count; ++i) {
        known += !isnan(error[i]);
        at_floor += error[i] <= pl_sweep_error_floor;
    }
    if (known - at_floor < 3) {
        order.finding = known > 0 && at_floor == known ? "exact" : "too few time steps";
        return order;
    }
    const segment part = longest_segment(dt, error, count);
    if (part.last - part.first >= 2) {
        order.finding = "found";
        fit(dt, error, without_slow_ends(dt, error, part), &order);
    }
    return order;
}

static json_t *order_json(const pl_sweep_analysis *analysis, int first, const pl_sweep_order *order)
{
    const pl_sweep_point *point = &analysis->points[first];
    return json_pack(
        "{s:i, s:i, s:i, s:s, s:o, s:o, s:o, s:o, s:i, s:i}", "scene", point->scene, "engine",
        point->engines[PL_SWEEP_PROFILE], "point", first, "finding", order->finding, "order",
        pl_json_number_or_null(order->order), "deviation", pl_json_number_or_null(order->deviation),
        "dt_low", pl_json_number_or_null(order->dt_low), "dt_high",
        pl_json_number_or_null(order->dt_high), "used", order->used, "total", order->total);
}

json_t *pl_orders_find(const pl_sweep_analysis *analysis)
{
    const int count = analysis->point_count;
    double *dt = pl_heap_new((size_t)count, sizeof *dt);
    double *errors = pl_heap_new((size_t)count, sizeof *errors);
    json_t *orders = json_array();
    for (int first = 0, next; first < count; first = next) {
        const pl_sweep_point *point = &analysis->points[first];
        bool is_known = false;
        for (next = first; next < count && analysis->points[next].scene == point->scene &&
                           analysis->points[next].configuration == point->configuration;
             ++next) {
            dt[next - first] = analysis->points[next].dt;
            errors[next - first] = analysis->points[next].error;
            is_known = is_known || !isnan(errors[next - first]);
        }
        if (next - first > 1 && is_known) {
            const pl_sweep_order order = pl_order_fit(dt, errors, next - first);
            json_array_append_new(orders, order_json(analysis, first, &order));
        }
    }
    free(dt);
    free(errors);
    return orders;
}
