/* Judges results against a baseline, and against rules. */
#ifndef PLUMB_GATE_JUDGE_H
#define PLUMB_GATE_JUDGE_H

#include "gate_verdict.h"
#include "rules.h"

/* What is judged, and by what. */
typedef struct pl_gate_inputs {
    const pl_gate_rows *before; /* the baseline; NULL: rules alone */
    const pl_gate_rows *now;
    const pl_gate_tolerances *tolerances;
    const pl_gate_rule *rules; /* (rule_count) */
    int rule_count;
    const char *reference; /* the engine that times are compared with; NULL: that of the baseline */
} pl_gate_inputs;

/* Fills *verdict, which borrows from the rows and rules, and which the caller frees. */
void pl_gate_judge(const pl_gate_inputs *in, pl_gate_verdict *verdict);

#endif
