/* The key and the name of a case: the same for results and for rows of a baseline. Parameters at their defaults do not
 * count, so that one that a scenario gets later makes no old row another case. */
#ifndef PLUMB_CASE_NAME_H
#define PLUMB_CASE_NAME_H

#include "plumb/scenario.h"

#include <jansson.h>
#include <stdbool.h>

enum { PL_CASE_NAME_SIZE = 256 };

/* A case, by the values that identify it. Everything is borrowed. */
typedef struct pl_case_identity {
    const char *scenario;
    const pl_scenario *catalogue; /* NULL: a scene file, or unknown here */
    const json_t *params;         /* name -> number; NULL: none */
    double dt;                    /* s; NAN: any, and then the parameter dt does not count */
    double duration;              /* s */
    json_int_t seed;
    int member; /* -1: of no ensemble */
} pl_case_identity;

/* Returns "scenario\x01 a=1 b=2\x01dt\x01duration\x01seed\x01member\x01", parameters by name. The caller frees. */
char *pl_case_key(const pl_case_identity *identity);

/* Writes the scenario with the parameters that are off their defaults (of a scene file, whose defaults are not known
 * here, all), a seed other than 0, and the member: "slope angle=0.5 rad seed=3". */
void pl_case_name(const pl_case_identity *identity, char name[PL_CASE_NAME_SIZE]);

/* Appends formatted text to a name, as much as it has room for. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_case_name_add(char name[PL_CASE_NAME_SIZE], const char *format, ...);

/* The parameters that count, off their defaults: a new object. */
json_t *pl_case_params(const pl_case_identity *identity);

#endif
