/* What `plumb list engines` knows of engines, as JSON and as text. */
#ifndef PLUMB_ENGINE_LIST_H
#define PLUMB_ENGINE_LIST_H

#include "command.h"

/* An array of the engines of this build, or of those of the SPECs after the first of `names`: a new reference. An
 * engine that could not be asked has the key "fault". Ends the program where a SPEC or a file of profiles is wrong. */
json_t *pl_engine_list(const pl_call *call, const pl_texts *names);

/* Prints an item of that array: what the engine is, its profiles with the values that differ from
 * the first one's and where they come from, its tuned profiles, and its options. */
void pl_engine_list_print(const json_t *item, FILE *out);

/* Prints a parameter of a scenario or an option of an engine: its help, unit, default and range, and `more`. */
void pl_list_print_number(const json_t *item, const char *more, FILE *out);

#endif
