#include "score.h"

#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_REPEATS = 64 };

double pl_score_ratio(const pl_reading *reading, const pl_reading *other, int first, int repeats)
{
    double ratios[MOST_REPEATS];
    int count = 0;
    for (int i = first; i < repeats && count < MOST_REPEATS; ++i) {
        const double ratio = reading->seconds[i] / (other == NULL ? 1 : other->seconds[i]);
        if (isfinite(ratio)) {
            ratios[count++] = ratio;
        }
    }
    return pl_median(ratios, count);
}

double pl_score_mean_ratio(const pl_reading *readings, const pl_reading *others, int problem_count,
                           int repeats, bool by_instructions)
{
    double sum = 0;
    for (int p = 0; p < problem_count; ++p) {
        sum += log(by_instructions ? readings[p].instructions[0] / others[p].instructions[0]
                                   : pl_score_ratio(&readings[p], &others[p], 0, repeats));
    }
    return exp(sum / problem_count);
}

pl_tune_score pl_score_of(const pl_reading *reading, const pl_reading *shipped, int repeats)
{
    pl_tune_score score = {.seconds = pl_score_ratio(reading, NULL, 0, repeats),
                           .shipped_seconds = pl_score_ratio(shipped, NULL, 0, repeats),
                           .ratio = pl_score_ratio(reading, shipped, 0, repeats),
                           .target = reading->target,
                           .shipped_target = shipped->target};
    memcpy(score.outcome, reading->outcome, sizeof score.outcome);
    memcpy(score.shipped_outcome, shipped->outcome, sizeof score.shipped_outcome);
    return score;
}

void pl_spread_add(pl_spread *spread, double excess)
{
    const double much = -3; /* ln(1 / 20) */
    const double value = fmax(excess, much);
    spread->count += 1;
    spread->sum += value;
    spread->squares += value * value;
}

double pl_spread_likely(const pl_spread *spread)
{
    const double mean = spread->sum / spread->count;
    const double variance = spread->squares / spread->count - mean * mean;
    const double unbiased =
        spread->count > 1 ? variance * spread->count / (spread->count - 1.0) : 0;
    return mean + 2 * sqrt(fmax(unbiased, 0));
}
