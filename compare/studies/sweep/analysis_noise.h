/* How much times scatter from repeat to repeat. */
#ifndef PLUMB_SWEEP_ANALYSIS_NOISE_H
#define PLUMB_SWEEP_ANALYSIS_NOISE_H

#include "analysis.h"

/* Sets the noise of every scene from its points that were repeated, or, where these are few, from
 * those of all scenes: the machine makes the noise, not the engine. */
void pl_sweep_take_noise(pl_sweep_analysis *analysis);

#endif
