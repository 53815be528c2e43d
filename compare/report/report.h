/* The report: from results (compare/results/SCHEMA.md) to pages for people and tables for programs.
 */
#ifndef PLUMB_REPORT_H
#define PLUMB_REPORT_H

#include "plumb/base.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

/* Writes results.csv (one row a run and metric), summary.md (GitHub tables) and index.html (one
 * self-contained page) into `directory`, which must exist. `results` is an array of plumb.result/1
 * objects, in any order, several repeats of a run among them; it is borrowed and not changed.
 *
 * All three are written under temporary names first and renamed when all are complete, so that no
 * file is ever half-written: on failure what stood there before stands there still. PL_BAD_INPUT: a
 * row that is not a plumb.result/1 object, named by its index. PL_IO: the directory cannot be
 * written, or the disk is full; the message names the file. PL_NO_MEMORY. */
pl_status pl_report_write(const char *directory, json_t *results, pl_error *error);

/* Prints the same results as a UTF-8 table that fits `width` columns (at least 40 are taken): first
 * where plumb loses, then a block a scenario with a line an engine, then where other engines err
 * and why. `colour` allows ANSI colours. Control characters in texts are shown as '?', so that
 * nothing an engine wrote can drive the terminal. */
void pl_report_print_table(FILE *out, const json_t *results, bool colour, int width);

#endif
