/* Where our engine is worse than another: what every report says first. */
#ifndef PLUMB_LOSSES_H
#define PLUMB_LOSSES_H

#include "base/text_buffer.h"
#include "result_matrix.h"

typedef enum pl_loss_kind {
    PL_LOSS_OUTCOME,  /* ours failed, another did not */
    PL_LOSS_NO_VALUE, /* ours has no value where another has one */
    PL_LOSS_VALUE     /* ours is larger */
} pl_loss_kind;

typedef struct pl_loss {
    pl_loss_kind kind;
    const pl_block *block;
    const pl_column *ours, *best;        /* best: of the other engines whose outcome is ok */
    const pl_cell *our_cell, *best_cell; /* of `ours` and `best` in `block` */
    int metric;                          /* of the two kinds that have one */
    double ratio; /* ours / the larger of best and the metric's floor; INFINITY for other kinds */
} pl_loss;

typedef struct pl_losses {
    pl_loss *items; /* failures, then missing values, then by falling ratio */
    int count;
    int comparisons; /* pairs of our run and a metric that were held against another engine */
    int problems;    /* blocks with both a run of ours and a good run of another engine */
    bool ours_present, others_present;
    pl_text_buffer statement; /* in words: how many there are, or that there are none, of what */
    pl_text_buffer rule;      /* in words: which metrics count, and which differences do not */
} pl_losses;

/* Both values are of the metric `metric` in `block`; whether `value` is worse than `best` by more
 * than noise: above the metric's floor and, where it is measured, outside its spread. */
bool pl_loss_is_worse(const pl_block *block, int metric, double value, double best);

/* The metric is better when lower, and means the same to every engine: an iteration of one solver
 * is not the unit of work of another's, nor is the residual one number. */
bool pl_loss_is_compared(int metric);

/* `cells` must outlive *losses, which the caller frees, also on failure. */
pl_status pl_losses_find(const pl_result_matrix *cells, pl_losses *losses, pl_error *error);
void pl_losses_free(pl_losses *losses);

/* The texts of a loss, the same in every format. */
enum { PL_LOSS_TEXT_SIZE = 192 };
void pl_loss_texts(const pl_loss *loss, char metric[PL_LOSS_TEXT_SIZE],
                   char ours[PL_LOSS_TEXT_SIZE], char best[PL_LOSS_TEXT_SIZE],
                   char ratio[PL_LOSS_TEXT_SIZE]);

#endif
