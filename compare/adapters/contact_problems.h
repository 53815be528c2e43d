/* An extension of the engine ABI (pl_engine.extension): an engine that can export the contact
 * problems of a step as data of plumb/contact_problem.h, for `plumb run --capture`. */
#ifndef PLUMB_CONTACT_PROBLEMS_H
#define PLUMB_CONTACT_PROBLEMS_H

#include "plumb/engine_abi.h"

struct pe_contact_problem; /* plumb/contact_problem.h */

#define PL_CONTACT_PROBLEMS "plumb.contact_problems/1"

/* The table of that name. */
typedef struct pl_contact_problems {
    /* The contact problems that step(dt) would solve next, one for each island with a contact, warm
     * starts included: *problems is an array of *count, to be released by
     * pe_contact_problems_destroy. The call does not change the steps that follow. */
    pl_status (*capture)(pl_engine_instance *instance, double dt,
                         struct pe_contact_problem ***problems, int *count, pl_error *error);
} pl_contact_problems;

/* The engine's table; NULL when it does not export its contact problems. */
static inline const pl_contact_problems *pl_contact_problems_of(const pl_engine *engine)
{
    return engine->extension == NULL
               ? NULL
               : (const pl_contact_problems *)engine->extension(PL_CONTACT_PROBLEMS);
}

#endif
