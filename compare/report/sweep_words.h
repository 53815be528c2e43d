/* How numbers of a sweep are written. */
#ifndef PLUMB_REPORT_SWEEP_WORDS_H
#define PLUMB_REPORT_SWEEP_WORDS_H

#include "studies/sweep/analysis.h"

enum { PL_SWEEP_TEXT_SIZE = 256 };

/* "×2.50 (2.31 to 2.74)"; "–" where there is no ratio. */
void pl_sweep_ratio_text(const pl_sweep_ratio *ratio, char text[PL_SWEEP_TEXT_SIZE]);

/* A power of ten or the like: "1e-3". */
void pl_sweep_power_text(double value, char text[PL_SWEEP_TEXT_SIZE]);

/* An error with its unit; at the floor "≤ 1e-9 m". */
void pl_sweep_error_text(double error, const char *unit, char text[PL_SWEEP_TEXT_SIZE]);

/* A time step as it is given to engines: "1/240 s" where it is one over a whole number. */
void pl_sweep_step_text(double dt, char text[PL_SWEEP_TEXT_SIZE]);

/* A cost, CPU time for a simulated second: "12.0 ms". */
void pl_sweep_cost_text(double cost, char text[PL_SWEEP_TEXT_SIZE]);

#endif
