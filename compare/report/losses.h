/* Losses: where the home engine is worse than another. A report for a home engine begins with them. */
#ifndef PLUMB_LOSSES_H
#define PLUMB_LOSSES_H

#include "base/document.h"
#include "queries.h"

/* The kinds of loss. */
typedef enum pl_loss_kind {
    PL_LOSS_OUTCOME,  /* the home engine failed, another did not */
    PL_LOSS_NO_VALUE, /* the home engine has no value, another has one */
    PL_LOSS_VALUE     /* that of the home engine is larger */
} pl_loss_kind;

/* One loss. */
typedef struct pl_loss {
    pl_loss_kind kind;
    const pl_result_cell *home,
        *best;    /* of one case; best: of the other engines whose outcome is ok */
    int metric;   /* of the two kinds that have one */
    double ratio; /* home / the larger of best and the metric's floor; INFINITY for other kinds */
    bool near_rounding; /* PL_LOSS_VALUE: neither value is large enough to matter */
} pl_loss;

/* All losses of a report. */
typedef struct pl_losses {
    const pl_result_table *results; /* borrowed */
    pl_loss *items; /* failures; the primary error and the time of a step; other metrics; values
                       near rounding; in each a missing value first, then by falling ratio */
    int count;
    int comparisons; /* pairs of its run and a metric that were compared with another engine */
    int cases;       /* with both a run of it and an ok run of another engine */
} pl_losses;

/* Finds the losses in results, which must outlive *losses. The caller frees *losses. */
void pl_losses_find(const pl_result_table *results, pl_losses *losses);

/* Frees the losses. */
void pl_losses_free(pl_losses *losses);

/* Adds where the home engine loses: how many losses in how many comparisons, a table of them, in which `shown` rows are
 * shown at first, and unless `is_short` which metrics count, and which differences do not. Nothing without a home
 * engine. */
void pl_losses_describe(const pl_losses *losses, int shown, bool is_short, pl_document *document);

#endif
