/* The report: pages for people and tables for programs, made of results (results/SCHEMA.md). */
#ifndef PLUMB_REPORT_H
#define PLUMB_REPORT_H

#include "base/text_buffer.h"
#include "results/result_table.h"

/* What to report. */
typedef struct pl_report_def {
    const char *directory; /* where the files go; it must exist */
    const pl_result_table *results;
    const char *const *folders; /* (folder_count) that may have recordings/RUN.json of the runs */
    int folder_count;
    const char *only; /* the one file to write; NULL: all */
    /* plumb.reference/1 of scenes without an expected result; NULL: none */
    const json_t *reference;
} pl_report_def;

/* Writes results.csv (a row for each run and metric), runs.csv (a row for each run), summary.md
 * (GitHub tables) and index.html (one self-contained page, with at most 8 MiB of recordings).
 *
 * All files are written under temporary names first and renamed when all are complete, so that no
 * file is ever half-written: on failure the old files stay. PL_IO: the directory cannot be written, or the disk is
 * full; the message names the file. */
pl_status pl_report_write(const pl_report_def *def, pl_error *error);

/* Adds results as CSV (RFC 4180) for a spreadsheet: a row for each run, with a column for each
 * metric. Numbers have full precision; null and absent values are empty fields. */
void pl_report_runs_csv(const pl_result_table *results, pl_text_buffer *out);

/* Adds results as CSV (RFC 4180) with a header and CRLF: a row for each run and metric, with the
 * keys that identify the run in every row; a run without metrics has one row whose metric is empty.
 * Numbers have full precision; null and absent values are empty fields. A value that is a text is in
 * the last column, value_text, so that the column value has numbers alone. */
void pl_report_csv(const pl_result_table *results, pl_text_buffer *out);

/* Prints the same results as UTF-8 text of `width` columns: where the home engine loses, each case with a line for
 * each engine, findings with their causes, and, of more than one case, how many verdicts of each kind every engine has.
 * `colour` allows ANSI colours. Control characters are shown as '?', so that no output of an engine
 * can control the terminal. */
void pl_report_print(FILE *out, const pl_result_table *results, bool colour, int width);

/* Adds the catalogue as one HTML page: each scenario with its scene, right answer, source and
 * parameters. The arrays are those of plumb list --json, borrowed. The error of a scenario that cannot be built. */
pl_status pl_catalogue_page(json_t *scenarios, json_t *suites, pl_text_buffer *out,
                            pl_error *error);

#endif
