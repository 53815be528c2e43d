/* Performance profiles (Dolan and More 2002). */
#ifndef PLUMB_SWEEP_ANALYSIS_PROFILE_H
#define PLUMB_SWEEP_ANALYSIS_PROFILE_H

#include "analysis.h"

/* From curves to the profile of each level, of whole engines and of profiles. */
pl_status pl_profiles_find(pl_sweep_analysis *analysis, pl_error *error);

#endif
