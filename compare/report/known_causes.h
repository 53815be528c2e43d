/* What in another engine causes its error in a scenario, and the evidence: the statements of
 * known_causes.json. */
#ifndef PLUMB_KNOWN_CAUSES_H
#define PLUMB_KNOWN_CAUSES_H

#include <jansson.h>

/* The file of known causes, which is part of the program: a new reference. */
json_t *pl_known_causes(void);

/* Returns the first statement of such a file that is about a plumb.result/1, borrowed; NULL where there is none.
 * Engine, version, profile, outcome and scenario must be those of the statement; each parameter must lie in
 * its range, and a parameter without a range must have its default. No statement is about a run
 * with options other than its profile's. */
const json_t *pl_known_cause_find(const json_t *causes, const json_t *result);

#endif
