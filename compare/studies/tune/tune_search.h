/* The search for the cheapest point that meets a target, in a mixed space of integer and continuous
 * parameters. The caller defines what the cost and the excess of a point are. */
#ifndef PLUMB_TUNE_SEARCH_H
#define PLUMB_TUNE_SEARCH_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* ---- Parameters ---- */

/* Every option of an engine, and the time step. */
enum { PL_TUNE_MAX_PARAMETERS = PL_ENGINE_MAX_OPTIONS + 1, PL_TUNE_RATE = -1 };

/* A setting that is tuned: its range and its scale. */
typedef struct pl_tune_parameter {
    char name[PL_NAME_SIZE];
    int option;       /* index in the engine's table; PL_TUNE_RATE: steps per second, of "dt" */
    double low, high; /* low < high; low > 0 where logarithmic */
    bool logarithmic, integer;
    bool spends;  /* a larger value takes more time: steps per second, iterations */
    double start; /* where the search begins: the default, moved into the range */
} pl_tune_parameter;

/* The value at `unit`, which is clamped to 0 .. 1, rounded to three significant digits so that
 * settings are short to write; for an integer parameter, to an integer. */
double pl_tune_value(const pl_tune_parameter *parameter, double unit);

/* The position of a value on the parameter's scale, 0 .. 1. */
double pl_tune_unit(const pl_tune_parameter *parameter, double value);

/* The value moved down (direction < 0) or up by 10 %, by at least 1 for an integer, and by 1 % of
 * the range from 0. The result stays in the range, so that at its end it is the value itself. */
double pl_tune_neighbour(const pl_tune_parameter *parameter, double value, int direction);

/* ---- Search ---- */

/* The largest excess. */
#define PL_SEARCH_WORST 30.0

/* A point of the space, its cost and its excess. */
typedef struct pl_evaluation {
    double values[PL_TUNE_MAX_PARAMETERS]; /* (parameter_count) */
    double cost;                           /* > 0; INFINITY: unknown */
    double excess; /* <= 0: the target is met with the required margin; at most PL_SEARCH_WORST */
    bool holds;    /* the target was met, but possibly by less than the required margin */
    int trial;     /* its number in the search, from 0 */
} pl_evaluation;

/* The parameters to be searched and the function to be minimised. */
typedef struct pl_search_def {
    const pl_tune_parameter *parameters; /* (parameter_count) */
    int parameter_count;                 /* 0 .. PL_TUNE_MAX_PARAMETERS */
    int budget;                          /* >= 1: the most points evaluated */
    uint64_t seed;
    void *user;
    /* Fills cost, excess and holds. No point is evaluated twice. False ends the search with the points before
     * this one. */
    bool (*measure)(void *user, pl_evaluation *evaluation);
} pl_search_def;

/* The points that a search evaluated, and the best of them. */
typedef struct pl_search_result {
    pl_evaluation *evaluations; /* (count), in order, the first at the parameters' starts; owned */
    int count;
    int best; /* the cheapest that meets the target, else the one of least excess; -1: none */
    bool met;
    bool stopped; /* by `measure` */
} pl_search_result;

/* Evaluates low-discrepancy points over the space, in half of which a parameter that spends no time
 * stays at its start; then runs NLopt from the best point at which it has not begun yet, until the budget is spent.
 * Equal seeds and equal answers give equal points. The caller frees result->evaluations. */
void pl_search(const pl_search_def *def, pl_search_result *result);

/* Adds an evaluation, for which the result has room. */
void pl_search_add(pl_search_result *result, const pl_evaluation *evaluation);

/* Whether a is better than b: only a meets the target; or both do and a is cheaper; or neither
 * does, and only a holds, or a has the lower excess. */
bool pl_evaluation_is_better(const pl_evaluation *a, const pl_evaluation *b);

#endif
