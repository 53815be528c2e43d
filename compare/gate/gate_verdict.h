/* What the gate reports: failures and notices, and the formats they are written in. */
#ifndef PLUMB_GATE_VERDICT_H
#define PLUMB_GATE_VERDICT_H

#include "base/text_buffer.h"
#include "gate_rows.h"

/* A failure or a notice. */
typedef struct pl_gate_entry {
    bool is_failure;        /* else a notice */
    const pl_gate_row *row; /* NULL: of no single row */
    const char *metric;     /* "outcome", "time_per_step" ...; borrowed */
    char before[96], after[96];
    char allowed[128]; /* the tolerance, or the rule; "" where there is none */
    char what[256];    /* in words, such as "worse by 1 %" */
    int row_count;     /* of a notice of several rows, else 0 */
} pl_gate_entry;

/* Everything that the gate reports. */
typedef struct pl_gate_verdict {
    const pl_gate_rows *before; /* NULL: no baseline */
    const pl_gate_rows *now;
    pl_gate_entry *items; /* in the order of the rows, then rules, then notices of several rows */
    int count;
    int failures, notices;
    int comparisons; /* values compared with a baseline or a rule */
} pl_gate_verdict;

/* Adds an entry to fill in, valid until the next one is added. */
pl_gate_entry *pl_gate_verdict_add(pl_gate_verdict *verdict, bool is_failure,
                                   const pl_gate_row *row, const char *metric);

/* Adds one row to a notice. Notices of equal metric and words become one. */
void pl_gate_verdict_note(pl_gate_verdict *verdict, const char *metric, const char *what);

/* Sorts the entries: failures, notices of one row, notices of several rows. The sort is stable. */
void pl_gate_verdict_order(pl_gate_verdict *verdict);

/* Writes both values with as few digits as distinguish them, and their unit ("": none). */
void pl_gate_entry_numbers(pl_gate_entry *entry, double before, double after, const char *unit);

/* Writes "gate passed: 120 comparisons of 8 rows, 2 notices" into a buffer of `size`. */
void pl_gate_verdict_summary(const pl_gate_verdict *verdict, char *text, size_t size);

/* Frees the entries. */
void pl_gate_verdict_free(pl_gate_verdict *verdict);

/* The formats of a verdict. */
typedef enum pl_gate_format {
    PL_GATE_TEXT,  /* one line an entry, then the summary */
    PL_GATE_JUNIT, /* a test case for each run, and one for rules that judged nothing and notices */
    PL_GATE_GITHUB, /* workflow commands of GitHub Actions, and the summary in plain text */
    PL_GATE_JSON,   /* plumb.gate/1 (SCHEMA.md) */
    PL_GATE_FORMAT_COUNT
} pl_gate_format;

/* "text", "junit", "github", "json". */
extern const char *const pl_gate_format_names[PL_GATE_FORMAT_COUNT];

/* Appends the verdict in a format. */
void pl_gate_write(pl_gate_format format, const pl_gate_verdict *verdict, pl_text_buffer *out);

/* Appends the summary page of a job of GitHub Actions. */
void pl_gate_write_markdown(const pl_gate_verdict *verdict, pl_text_buffer *out);

#endif
