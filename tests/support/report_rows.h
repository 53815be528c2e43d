/* Results made by hand, whose answers are known, and what the report says of them. */
#ifndef PLUMB_TEST_REPORT_ROWS_H
#define PLUMB_TEST_REPORT_ROWS_H

#include "report/report_document.h"
#include "result_tables.h"

/* Markup, quotes, separators and letters that are not ASCII. */
extern const char hostile_text[];

/* A metric that has a value alone. */
json_t *metric_value(double value);

/* Sets a metric of a row. Takes `value`. */
void set_metric(json_t *row, const char *metric, json_t *value);

/* Appends a run whose engine is the part of `label` before its colon; its primary error is drift.
 * The row is borrowed from `results`. */
json_t *add_run(json_t *results, const char *scenario, const char *label, const char *outcome);

/* Sets the verdict of a row, NULL for none, with its reason. */
void set_verdict(json_t *row, const char *verdict, const char *reason);

/* Our engine and another one on one case, each with a value of one metric. */
json_t *two_runs(const char *metric, double ours, double theirs);

/* Every outcome, hostile texts, and a null metric. */
json_t *runs_of_every_kind(void);

typedef struct made_report {
    json_t *results;
    pl_result_table *table;
    pl_report report;
    char *data; /* of the page, as JSON text */
    char *markdown;
} made_report;

/* Takes `results`. */
made_report make_report(json_t *results);
void free_report(made_report *made);

/* The terminal's table; the caller frees. */
char *printed_table(const json_t *results, bool colour, int width);

#endif
