/* The frame of a plot: where a number stands, the lines of its decades, and its legend. */
#ifndef PLUMB_REPORT_SWEEP_AXES_H
#define PLUMB_REPORT_SWEEP_AXES_H

#include "base/text_buffer.h"

enum { PL_SWEEP_COLOURS = 6 };

/* Pixels of the plotted field, y downwards, and the range of numbers. */
typedef struct pl_sweep_axes {
    double left, right, top, bottom;
    double x_low, x_high, y_low, y_high; /* both ends of whole decades where logarithmic */
    bool log_y;                          /* x always is */
} pl_sweep_axes;

double pl_sweep_x(const pl_sweep_axes *axes, double value);
double pl_sweep_y(const pl_sweep_axes *axes, double value);

/* Opens the picture, `title` its alternative text, and draws grid, numbers and the names of both
 * axes. */
void pl_sweep_axes_open(const pl_sweep_axes *axes, const char *title, const char *x_name,
                        const char *y_name, pl_text_buffer *out);

/* The marker of colour 0 .. PL_SWEEP_COLOURS - 1, each of a shape of its own, of half-width r, px.
 */
void pl_sweep_marker(const char *classes, int colour, double x, double y, double r,
                     pl_text_buffer *out);

/* A line of the legend, from 0. */
void pl_sweep_legend(const pl_sweep_axes *axes, int line, int colour, const char *name,
                     const char *note, pl_text_buffer *out);

#endif
