/* What the gate found. */
#ifndef PLUMB_GATE_REPORT_H
#define PLUMB_GATE_REPORT_H

#include "gate_row.h"

typedef struct pl_gate_finding {
    bool is_failure;        /* else a notice */
    const pl_gate_row *row; /* NULL: of no single row */
    const char *metric;     /* "outcome", "time_per_step" ...; borrowed */
    char before[96], after[96];
    char limit[128]; /* what is allowed, or the rule; "" where there is none */
    char what[256];  /* in words, such as "worse by 1 %" */
    int row_count;   /* of a notice of several rows, else 0 */
} pl_gate_finding;

typedef struct pl_gate_report {
    const pl_gate_rows *before; /* NULL: no baseline */
    const pl_gate_rows *now;
    pl_gate_finding *items; /* in the order of the rows, then rules, then notices of several rows */
    int count, capacity;
    int failures, notices;
    int comparisons; /* values held against a baseline or a rule */
    bool failed;     /* out of memory: look once, at the end */
} pl_gate_report;

/* A finding to fill in, valid until the next is added. Without memory, one that is thrown away. */
pl_gate_finding *pl_gate_report_add(pl_gate_report *report, bool is_failure, const pl_gate_row *row,
                                    const char *metric);

/* A notice of one more row. Equal metric and words are one notice. */
void pl_gate_report_count(pl_gate_report *report, const char *metric, const char *what);

/* Notices of several rows to the end. */
void pl_gate_report_order(pl_gate_report *report);

/* Two values as short as they can be told apart, with their unit; "": none. */
void pl_gate_number_texts(pl_gate_finding *finding, double before, double after, const char *unit);

/* "gate passed: 120 comparisons of 8 rows, 2 notices", in a buffer of `size`. */
void pl_gate_report_summary(const pl_gate_report *report, char *text, size_t size);

void pl_gate_report_free(pl_gate_report *report);

#endif
