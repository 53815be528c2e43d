/* Losses: where the home engine is worse than another. A report for a home engine begins with them. */
#ifndef PLUMB_LOSSES_H
#define PLUMB_LOSSES_H

#include "base/text_buffer.h"
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
    const pl_result_case *test_case;
    const pl_result_configuration *home, *best; /* best: of the other engines whose outcome is ok */
    const pl_result_cell *home_cell, *best_cell; /* of `home` and `best` on the case */
    int metric;                                  /* of the two kinds that have one */
    double ratio; /* home / the larger of best and the metric's floor; INFINITY for other kinds */
    bool near_rounding; /* PL_LOSS_VALUE: neither value is large enough to matter */
} pl_loss;

/* All losses of a report. */
typedef struct pl_losses {
    pl_loss *items; /* failures; the primary error and the time of a step; other metrics; values
                       near rounding; in each a missing value first, then by falling ratio */
    int count;
    int comparisons; /* pairs of its run and a metric that were compared with another engine */
    int cases;       /* with both a run of it and an ok run of another engine */
    bool others_present;
    pl_text_buffer statement; /* in words: how many losses in how many comparisons */
    pl_text_buffer rule;      /* in words: which metrics count, and which differences do not */
} pl_losses;

/* Finds the losses in results, which must outlive *losses. The caller frees *losses. */
void pl_losses_find(const pl_result_table *results, pl_losses *losses);

/* Frees the losses. */
void pl_losses_free(pl_losses *losses);

/* The size of each text of a loss, in bytes. */
enum { PL_LOSS_TEXT_SIZE = 192 };

/* Writes the texts of a loss, the same in every format. The other engine's value says so where its
 * run is inaccurate. */
void pl_loss_texts(const pl_loss *loss, char metric[PL_LOSS_TEXT_SIZE],
                   char home[PL_LOSS_TEXT_SIZE], char best[PL_LOSS_TEXT_SIZE],
                   char ratio[PL_LOSS_TEXT_SIZE]);

#endif
