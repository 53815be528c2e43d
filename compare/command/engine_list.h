/* What `plumb list engines` knows of engines, as JSON and as text. */
#ifndef PLUMB_ENGINE_LIST_H
#define PLUMB_ENGINE_LIST_H

#include "engines/registry.h"

#include <jansson.h>
#include <stdio.h>

/* An array of the engines of this build, or of those of the SPECs in `asked` (count), which the
 * caller releases, also after a failure. An engine that could not be asked has the key "fault".
 * Failures are those of pl_engine_choose and pl_tuned_profiles. */
pl_status pl_engine_list(const char *const *asked, int count, json_t **list, pl_error *error);

/* Prints an item of that array: what the engine is, its profiles with the values that differ from
 * the first one's and where they come from, its tuned profiles, and its options. */
void pl_engine_list_print(const json_t *item, FILE *out);

#endif
