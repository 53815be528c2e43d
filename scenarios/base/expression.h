/* Arithmetic expressions in the place of numbers, such as "v*v/(2*mu*9.81)": the same bits on every
 * machine.
 *
 *   sum     = product { ("+" | "-") product }
 *   product = factor { ("*" | "/") factor }
 *   factor  = "-" factor | number | "pi" | name | ("sqrt" | "sin" | "cos" | "tan") "(" sum ")" | "(" sum ")"
 *
 * Numbers are decimal, such as 12.5e-3. Angles are in rad, up to 1e6. Blanks do not count. */
#ifndef PLUMB_EXPRESSION_H
#define PLUMB_EXPRESSION_H

#include "diagnostic.h"

/* A number that expressions use by its name. */
typedef struct pl_named_number {
    const char *name; /* borrowed */
    double value;
    bool used; /* set by pl_expression_value */
} pl_named_number;

/* Whether an expression may use `name` for a number: a letter or '_', then letters, digits and '_',
 * and no word of the grammar. */
bool pl_expression_may_name(const char *name);

/* The value of an expression, a finite number, in *value. Marks the `numbers` that it uses. False with
 * a diagnostic at the current path, which says at which character of the text, from 1, the fault is:
 * something else was expected, a name is unknown (the nearest is suggested), an operation has no finite
 * result, or more than 32 parts are nested. */
bool pl_expression_value(const char *text, pl_named_number *numbers, int count, double *value,
                         pl_diagnostic *diagnostic);

#endif
