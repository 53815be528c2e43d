/* The parts of pl_ensemble_study. */
#ifndef PLUMB_ENSEMBLE_REPORT_H
#define PLUMB_ENSEMBLE_REPORT_H

#include "studies/study.h"

/* As pl_study.conclude. */
pl_status pl_ensemble_conclude(const json_t *results, const char *folder, json_t **outcome,
                               pl_error *error);

#endif
