/* The cost of a run over that of the reference engine on the same case: a ratio that depends less
 * on the machine than a time does. */
#ifndef PLUMB_GATE_RATIO_H
#define PLUMB_GATE_RATIO_H

#include "gate_rows.h"

/* The fewest repeats from which noise can be known. */
enum { PL_GATE_FEWEST_REPEATS = 5 };

/* A ratio of costs over the repeats. */
typedef struct pl_gate_ratio {
    int repeats;      /* 0: there is no ratio */
    double value;     /* the median over repeats */
    double low, high; /* bounds of the median */
} pl_gate_ratio;

/* Returns the pl_metric_id of the cost whose metric or ratio has that name; -1: none. */
int pl_gate_cost_of(const char *name);

/* Returns the cell of the reference engine on the case of `row`, a row of results: of the engine `label`, or where
 * that is NULL, of the first of bullet:si and ode:quick that was run. NULL: none, or that of `row` itself. */
const pl_result_cell *pl_gate_reference_of(const pl_gate_rows *rows, const pl_gate_row *row,
                                           const char *label);

/* The label of a cell's engine. */
const char *pl_gate_label_of(const pl_gate_rows *rows, const pl_result_cell *cell);

/* The ratio of a metric of two cells of one case: each repeat of `cell` over the same repeat of `reference` in the
 * same file. */
pl_gate_ratio pl_gate_ratio_measure(const pl_result_cell *cell, const pl_result_cell *reference,
                                    const char *metric);

/* Adds the ratios of all rows to their objects, as a baseline keeps them. */
void pl_gate_ratios_add(pl_gate_rows *rows, const char *label);

/* Reads such an object, {reference, value, low, high, repeats}; 0 repeats where it is none. */
pl_gate_ratio pl_gate_ratio_of_json(const json_t *json);

/* How a ratio differs from that of the baseline. */
typedef enum pl_gate_trend {
    PL_GATE_STEADY,
    PL_GATE_SLOWER, /* by more than the limit and the noise together */
    PL_GATE_FASTER,
    PL_GATE_FEW,  /* too few repeats to know the noise */
    PL_GATE_NOISY /* noise hides a change of the size of the limit */
} pl_gate_trend;

/* Compares two ratios. *growth: now / before - 1. *noise: half the width of its bounds. */
pl_gate_trend pl_gate_ratio_trend(const pl_gate_ratio *before, const pl_gate_ratio *now,
                                  double limit, double *growth, double *noise);

#endif
