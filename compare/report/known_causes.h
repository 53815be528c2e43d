/* What in another engine causes its error in a scenario, and the evidence: the statements of
 * known_causes.json. */
#ifndef PLUMB_KNOWN_CAUSES_H
#define PLUMB_KNOWN_CAUSES_H

#include "plumb/base.h"

#include <jansson.h>

/* One statement. */
typedef struct pl_known_cause {
    const char *id;               /* names it in the file of its experiments */
    const char *engine, *profile; /* profile NULL: those in `profiles` */
    const json_t *profiles;       /* names; NULL: any */
    const char *outcome;          /* NULL: any except crashed and timeout */
    const char *oldest, *newest;  /* versions of the engine, both included */
    const json_t *scenarios;      /* name -> parameter -> [least, largest] */
    const char *cause;            /* in a line; NULL: not known */
    const char *evidence;         /* what was varied, and what changed */
} pl_known_cause;

/* All texts are borrowed from `json`. */
typedef struct pl_known_causes {
    json_t *json;
    pl_known_cause *items; /* (count) */
    int count;
    const char *found_with; /* the engines of the experiments, in words */
} pl_known_causes;

/* Reads the text of such a file (NULL: that of known_causes.json, which is part of the program).
 * PL_BAD_INPUT: LABEL:LINE:COLUMN: field: what was expected, what was found. The caller frees, also
 * on failure. */
pl_status pl_known_causes_read(const char *text, const char *label, pl_known_causes *causes,
                               pl_error *error);

/* Frees the statements. */
void pl_known_causes_free(pl_known_causes *causes);

/* Returns the first statement that is about a plumb.result/1; NULL where there is none. Engine,
 * version, profile, outcome and scenario must be those of the statement; each parameter must lie in
 * its range, and a parameter without a range must have its default. No statement is about a run
 * with options other than its profile's. */
const pl_known_cause *pl_known_cause_find(const pl_known_causes *causes, const json_t *result);

#endif
