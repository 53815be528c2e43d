/* Which scenes a command was asked for: names, scene files, --set, --dt, --duration, --seed; and
 * the limits of a run. */
#ifndef PLUMB_SELECTION_H
#define PLUMB_SELECTION_H

#include "command.h"
#include "runner/plan.h"
#include "runner/process.h"

/* Texts in the order given. */
typedef struct pl_texts {
    const char **items;
    int count;
} pl_texts;

/* Ends the program when out of memory. */
void pl_texts_add(pl_texts *texts, const char *item);

typedef struct pl_selection {
    pl_texts settings; /* --set NAME=VALUE */
    pl_texts others;   /* settings that come after them, of the option `others_option` */
    const char *others_option;
    double dt, duration; /* s; NAN: the scenario's own */
    uint64_t seed;
} pl_selection;

pl_selection pl_selection_default(void);

/* `others` is the caller's, and stays. */
void pl_selection_free(pl_selection *selection);

/* Options --set, --dt, --duration, --seed; the input is a pl_selection. */
extern const struct argp pl_selection_argp;

pl_limits pl_limits_default(void);

/* The children of a command that makes runs: pl_selection_argp, and --timeout and --memory, whose
 * input is a pl_limits. Ends with a zero. */
extern const struct argp_child pl_run_children[];

/* What is asked for by name: a name with a '/' or that ends in ".json", and "-", are scene files,
 * others are of the catalogue. `setting` is "NAME=VALUE", or NULL; it has no meaning for a file. */
typedef struct pl_asked {
    const char *name, *setting;
} pl_asked;

/* Adds `count` problems to the plan. Each has its own setting first, then the selection's, of which
 * each goes to every catalogue scenario that has the parameter, those of `others` last;
 * PL_BAD_INPUT when none of them has it. */
pl_status pl_selection_add(const pl_selection *selection, const pl_asked *asked, int count,
                           pl_plan *plan, pl_error *error);

#endif
