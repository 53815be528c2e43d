/* Results against a baseline, and against rules. */
#ifndef PLUMB_GATE_JUDGE_H
#define PLUMB_GATE_JUDGE_H

#include "gate_report.h"
#include "limits.h"
#include "rule.h"

typedef struct pl_gate_case {
    const pl_gate_rows *before; /* the baseline; NULL: rules alone */
    const pl_gate_rows *now;
    const pl_gate_limits *limits;
    const pl_gate_rule *rules; /* (rule_count) */
    int rule_count;
    const char *reference; /* the engine that times are held against; NULL: that of the baseline */
} pl_gate_case;

/* Fills *report, which borrows from the rows and rules, and which the caller frees, also on
 * failure. PL_NO_MEMORY. */
pl_status pl_gate_judge(const pl_gate_case *c, pl_gate_report *report, pl_error *error);

/* The parts of it, each in its file. */
void pl_gate_judge_metrics(const pl_gate_case *c, const pl_gate_row *before, const pl_gate_row *now,
                           pl_gate_report *report);
pl_status pl_gate_judge_costs(const pl_gate_case *c, const pl_gate_row *before,
                              const pl_gate_row *now, pl_gate_report *report, pl_error *error);
pl_status pl_gate_judge_rules(const pl_gate_case *c, pl_gate_report *report, pl_error *error);

/* A metric's unit; "" where it is not known, and of a plain number. */
const char *pl_gate_unit(const char *metric);

#endif
