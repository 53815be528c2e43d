/* One setting that is tuned: its range and scale, and its values as numbers from 0 to 1. */
#ifndef PLUMB_TUNE_AXIS_H
#define PLUMB_TUNE_AXIS_H

#include "plumb/engine_abi.h"

/* Every option of an engine, and the time step. */
enum { PL_TUNE_MAX_PARAMETERS = PL_ENGINE_MAX_OPTIONS + 1, PL_TUNE_RATE = -1 };

typedef struct pl_tune_parameter {
    char name[PL_NAME_SIZE];
    int option;       /* index in the engine's table; PL_TUNE_RATE: steps a second, of "dt" */
    double low, high; /* low < high; of a logarithmic parameter low > 0 */
    bool logarithmic, integer;
    bool spends;  /* more of it takes more time: steps a second, iterations */
    double start; /* where the search begins: what the engine ships, moved into the range */
} pl_tune_parameter;

/* The value at `unit`, 0 .. 1 (cut to that), of three significant digits, so that settings are
 * short to write; of a whole parameter a whole number. */
double pl_tune_value(const pl_tune_parameter *parameter, double unit);

/* Where on the parameter a value is, 0 .. 1. */
double pl_tune_unit(const pl_tune_parameter *parameter, double value);

/* The value moved by 10 %, at least by one where whole, down (direction < 0) or up; of 0 by 1 % of
 * the range. Not beyond the range: there it is the value itself. */
double pl_tune_neighbour(const pl_tune_parameter *parameter, double value, int direction);

#endif
