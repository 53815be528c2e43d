/* The outcome of an ensemble for people: Markdown whose tables are aligned, to be read as it is. */
#ifndef PLUMB_SUMMARY_H
#define PLUMB_SUMMARY_H

#include "verdict.h"

/* malloc'd; NULL when out of memory. */
char *pl_ensemble_summary(const pl_plan *plan, const pl_ensembles *ensembles,
                          const pl_ensemble_view *views, const pl_verdicts *verdicts);

#endif
