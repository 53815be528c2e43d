/* What a person sees while runs go on: on a terminal one line that is drawn again (count, bar,
 * current run, time left), otherwise a line a run. */
#ifndef PLUMB_PROGRESS_H
#define PLUMB_PROGRESS_H

#include <stdbool.h>
#include <stdio.h>

typedef struct pl_progress {
    FILE *out;
    bool terminal, colour;
    int width; /* columns of the terminal */
    long total, done;
    double started; /* s, monotonic, of the first run */
} pl_progress;

/* Looks at `out` and at NO_COLOR (no-color.org). */
pl_progress pl_progress_begin(FILE *out, long total, double now);

/* Draws the line for `running`, with the part of the current runs that is done, in runs. */
void pl_progress_draw(const pl_progress *progress, const char *running, double part, double now);

/* A run has ended: its row, and on a terminal only when the outcome is not "ok". */
void pl_progress_run_ended(pl_progress *progress, const char *scenario, const char *label,
                           const char *outcome, const char *reason, double seconds);

/* Leaves the terminal's line clean. */
void pl_progress_end(const pl_progress *progress);

#endif
