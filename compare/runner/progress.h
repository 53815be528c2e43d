/* Progress of runs on standard error: on a terminal one line that is drawn again (count, bar,
 * current run, time left), otherwise one line for each run. */
#ifndef PLUMB_PROGRESS_H
#define PLUMB_PROGRESS_H

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

/* Counts a run that has ended, and writes its line; on a terminal only when its outcome is not
 * "ok". */
void pl_progress_run_ended(pl_progress *progress, const char *scenario, const char *label,
                           const char *outcome, const char *reason, double seconds);

/* Clears the line of the terminal. */
void pl_progress_end(const pl_progress *progress);

#endif
