/* Where another engine is wrong, and what in it causes that. */
#ifndef PLUMB_FINDINGS_H
#define PLUMB_FINDINGS_H

#include "base/text_buffer.h"
#include "known_causes.h"
#include "result_matrix.h"

/* A run of another engine that failed, or whose primary error is relative and above the limit or
 * without a value. */
typedef struct pl_fault {
    const pl_block *block;
    const pl_column *column;
    const pl_cell *cell;   /* of `column` in `block` */
    const pl_cause *cause; /* NULL: nothing is known */
} pl_fault;

typedef struct pl_faults {
    pl_fault *items; /* problem by problem, in the order of the report */
    int count;
    int runs; /* of other engines, on problems that have a primary error */
    pl_text_buffer
        statement; /* in words: how many of how many, and of how many the cause is known */
    pl_text_buffer innocence; /* in words: why it is not the adapter */
} pl_faults;

/* Above this a relative error is a finding. */
extern const double pl_fault_limit;

/* `cells` must outlive *findings, which the caller frees, also on failure. PL_NO_MEMORY. */
pl_status pl_faults_find(const pl_result_matrix *cells, pl_faults *findings, pl_error *error);
void pl_faults_free(pl_faults *findings);

/* The texts of a finding, the same in every format: "74 % (value_error)" or "collapsed, 0.764 m
 * (rest_position_error)". `cause` and `evidence` are borrowed, never empty. */
enum { PL_FAULT_TEXT_SIZE = 256 };
void pl_fault_texts(const pl_fault *fault, char error[PL_FAULT_TEXT_SIZE], const char **cause,
                    const char **evidence);

/* The section of each page, with its heading. Nothing where no other engine was run. */
void pl_faults_html(const pl_faults *findings, pl_text_buffer *out);
void pl_faults_markdown(const pl_faults *findings, pl_text_buffer *out);

#endif
