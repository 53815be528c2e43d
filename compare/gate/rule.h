/* Rules of --fail-if: [SCENARIO[/ENGINE]:] METRIC OP VALUE. */
#ifndef PLUMB_GATE_RULE_H
#define PLUMB_GATE_RULE_H

#include "gate_row.h"

typedef enum pl_gate_operator {
    PL_GATE_ABOVE,    /* > */
    PL_GATE_AT_LEAST, /* >= */
    PL_GATE_BELOW,    /* < */
    PL_GATE_AT_MOST,  /* <= */
    PL_GATE_EQUAL,    /* == */
    PL_GATE_OTHER     /* != */
} pl_gate_operator;

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

/* PL_BAD_INPUT says the column, from 1, what was expected and what was found, and for a metric that
 * there is not the nearest one. */
pl_status pl_gate_rule_parse(const char *text, pl_gate_rule *rule, pl_error *error);

/* A scenario by its name or by the row's, with parameters; an engine by its label, or all of its
 * profiles by its name. */
bool pl_gate_rule_selects(const pl_gate_rule *rule, const pl_gate_row *row);

/* Whether the rule's condition holds, so that the gate fails. */
bool pl_gate_rule_holds(const pl_gate_rule *rule, double value);

/* Holds of `now` against `before`, and by more than `least`. */
bool pl_gate_rule_holds_relative(const pl_gate_rule *rule, double before, double now, double least);

/* It judges a ratio to the reference engine: relative, of a time or of instructions. */
bool pl_gate_rule_is_cost(const pl_gate_rule *rule);

#endif
