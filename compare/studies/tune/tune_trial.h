/* One setting tried: what it costs, and whether it meets the targets on all that is tuned on. */
#ifndef PLUMB_TUNE_TRIAL_H
#define PLUMB_TUNE_TRIAL_H

#include "tuner.h"

/* What is shipped, once: whether the engine does the scenarios, and what is counted there.
 * PL_UNSUPPORTED where it does not do one. */
pl_status measure_shipped(pl_tuner *t, pl_error *error);

/* Sets the trial's `excess` and `holds` by the scenarios as asked for, whose readings are given,
 * and as the variants change them, up to the first that is missed. */
pl_status pl_evaluation_judge(pl_tuner *t, const pl_setting *setting, const pl_reading *asked,
                              const pl_variant *variants, int count, pl_evaluation *evaluation,
                              pl_error *error);

/* pl_search_def.measure, of a pl_tuner. */
pl_status pl_evaluation_make(void *user, pl_evaluation *evaluation, bool *stop, pl_error *error);

#endif
