/* What the caller asks of results: tolerances of metrics (--tolerance METRIC=REL[,ABS]) and rules
 * (--fail-if [SCENARIO[/ENGINE]:] METRIC OP VALUE). */
#ifndef PLUMB_GATE_RULES_H
#define PLUMB_GATE_RULES_H

#include "gate_rows.h"
#include "referee/metrics/metrics.h"

/* How far a metric may be from its baseline: the larger of `absolute` (in the metric's unit) and
 * `relative` times the baseline's value. */
typedef struct pl_gate_tolerance {
    bool given; /* by the caller */
    bool off;   /* the metric is not compared */
    double relative, absolute;
} pl_gate_tolerance;

/* The tolerances of all metrics. */
typedef struct pl_gate_tolerances {
    pl_gate_tolerance of[PL_METRIC_COUNT];
    double time, instructions; /* growth of a ratio to the reference engine: 0.1 is 10 % */
} pl_gate_tolerances;

/* The tolerances where the caller gives none. */
pl_gate_tolerances pl_gate_tolerances_default(void);

/* Reads "METRIC=RELATIVE[,ABSOLUTE]" or "METRIC=off". PL_BAD_INPUT names the metric (with the
 * nearest one) or the number that is wrong. */
pl_status pl_gate_tolerances_parse(const char *text, pl_gate_tolerances *tolerances,
                                   pl_error *error);

/* Returns the allowed difference from `value`, in the metric's unit. `dt`: the run's step, s. */
double pl_gate_tolerance_at(const pl_gate_tolerance *tolerance, int metric, double value,
                            double dt);

/* The bits say of which of the three results of a comparison the rule holds. */
typedef enum pl_gate_operator {
    PL_GATE_BELOW = 1,                                /* < */
    PL_GATE_EQUAL = 2,                                /* == */
    PL_GATE_ABOVE = 4,                                /* > */
    PL_GATE_AT_MOST = PL_GATE_BELOW | PL_GATE_EQUAL,  /* <= */
    PL_GATE_AT_LEAST = PL_GATE_ABOVE | PL_GATE_EQUAL, /* >= */
    PL_GATE_OTHER = PL_GATE_BELOW | PL_GATE_ABOVE     /* != */
} pl_gate_operator;

/* A rule of --fail-if. */
typedef struct pl_gate_rule {
    const char *text;                /* as given, borrowed */
    char scenario[256], engine[256]; /* shell patterns; "*": any */
    char metric[PL_NAME_SIZE];
    pl_gate_operator op;
    bool is_text, is_relative; /* relative: to the baseline */
    double value;              /* +10 %: 0.1 */
    char word[64];             /* of a text */
    int value_column;          /* from 1 */
} pl_gate_rule;

/* Reads a rule. PL_BAD_INPUT names the column, from 1, what was expected and what was found, and
 * for an unknown metric the nearest one. */
pl_status pl_gate_rule_parse(const char *text, pl_gate_rule *rule, pl_error *error);

/* Whether the rule is about this row. A scenario is selected by its name or by the row's name with
 * parameters; an engine by its label, or all of its profiles by the engine's name. */
bool pl_gate_rule_selects(const pl_gate_rule *rule, const pl_gate_row *row);

/* Whether the rule's condition holds, so that the gate fails. */
bool pl_gate_rule_holds(const pl_gate_rule *rule, double value);

/* Whether a relative rule holds of `now` against `before`, and by more than `least`. */
bool pl_gate_rule_holds_relative(const pl_gate_rule *rule, double before, double now, double least);

/* Whether it judges a ratio to the reference engine: it is relative, of a time or instructions. */
bool pl_gate_rule_is_cost(const pl_gate_rule *rule);

#endif
