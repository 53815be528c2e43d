/* Progress of runs on standard error: on a terminal one line that is drawn again (count, bar,
 * current run, time left), otherwise one line for each run. */
#ifndef PLUMB_PROGRESS_H
#define PLUMB_PROGRESS_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

/* A progress display. */
typedef struct pl_progress {
    FILE *out;
    bool terminal, colour;
    int width; /* columns of the terminal */
    long total, done;
    double started; /* s, monotonic, of the first run */
} pl_progress;

/* Begins a display of `total` runs, in the style that `out` and NO_COLOR (no-color.org) allow.
 * `now` is of pl_monotonic_seconds. */
pl_progress pl_progress_begin(FILE *out, long total, double now);

/* Draws the line for `running`, with the part of the current runs that is done, in runs. */
void pl_progress_draw(const pl_progress *progress, const char *running, double part, double now);

/* Counts a run that has ended, and writes its line: `title`, its verdict, or where it has none its
 * outcome, and why. On a terminal it writes only lines of runs that are not accurate, or that have
 * no verdict and are not ok. */
void pl_progress_run_ended(pl_progress *progress, const char *title, const json_t *result,
                           double seconds);

/* Clears the line of the terminal. */
void pl_progress_end(const pl_progress *progress);

#endif
