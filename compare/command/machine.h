/* What `plumb doctor` says of the machine. */
#ifndef PLUMB_MACHINE_H
#define PLUMB_MACHINE_H

#include <jansson.h>
#include <stdio.h>

/* The machine as a JSON object: the processor's features and settings, the clock that times steps, load and
 * memory. What cannot be read is left out. A new reference. It takes about 0.2 s. */
json_t *pl_machine(void);

/* Prints the machine as a table, with the host of a provenance (pl_provenance). */
void pl_machine_print(const json_t *host, const json_t *machine, FILE *out);

#endif
