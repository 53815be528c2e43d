/* Where our engine is worse than another: what every report says first. */
#ifndef PLUMB_LOSSES_H
#define PLUMB_LOSSES_H

#include "report/cells.h"
#include "report/sheet.h"

/* SI: two numbers below it are equal. */
#define PL_LOSS_ROUNDING 1e-12

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
    double ratio; /* ours / best; INFINITY when best is 0, or for the two other kinds */
} pl_loss;

typedef struct pl_losses {
    pl_loss *items; /* failures, then missing values, then by falling ratio */
    int count;
    int comparisons; /* pairs of our run and a metric that were held against another engine */
    int problems;    /* blocks with both a run of ours and a good run of another engine */
    bool ours_present, others_present;
} pl_losses;

/* `cells` must outlive *losses, which the caller frees. */
pl_status pl_losses_find(const pl_cells *cells, pl_losses *losses, pl_error *error);
void pl_losses_free(pl_losses *losses);

/* In words: how many there are, or that there are none, and what was compared. Plain text. */
void pl_losses_statement(const pl_losses *losses, const pl_cells *cells, pl_sheet *sheet);

/* Which metrics count and which differences do not: plain text for below the table. */
void pl_losses_rule(pl_sheet *sheet);

/* The texts of a loss, the same in every format. */
enum { PL_LOSS_TEXT_SIZE = 192 };
void pl_loss_texts(const pl_loss *loss, char metric[PL_LOSS_TEXT_SIZE],
                   char ours[PL_LOSS_TEXT_SIZE], char best[PL_LOSS_TEXT_SIZE],
                   char ratio[PL_LOSS_TEXT_SIZE]);

#endif
