#include "analysis_noise.h"

#include <math.h>

/* Sums over points, of the logarithms of their repeats' costs. */
typedef struct spread {
    double squares; /* of the deviations from the point's mean */
    int freedom;
} spread;

static spread spread_of(const pl_sweep_point *points, int count)
{
    spread all = {0, 0};
    for (int i = 0; i < count; ++i) {
        const pl_sweep_point *point = &points[i];
        double mean = 0;
        for (int k = 0; k < point->sample_count; ++k) {
            mean += log(point->samples[k].cost) / point->sample_count;
        }
        for (int k = 0; k < point->sample_count; ++k) {
            const double off = log(point->samples[k].cost) - mean;
            all.squares += off * off;
        }
        all.freedom += point->sample_count > 1 ? point->sample_count - 1 : 0;
    }
    return all;
}

void pl_sweep_take_noise(pl_sweep_analysis *analysis)
{
    const int enough = 10;
    const spread everywhere = spread_of(analysis->points, analysis->point_count);
    for (int p = 0; p < analysis->scene_count; ++p) {
        pl_sweep_scene *scene = &analysis->scenes[p];
        const spread own = spread_of(analysis->points + scene->first, scene->count);
        const spread *known = own.freedom >= enough ? &own : &everywhere;
        scene->noise = known->freedom > 0 ? sqrt(known->squares / known->freedom) : (double)NAN;
    }
}
