/* What an engine's own rule of motion makes of the exact forces at the scene's step: an error
 * against it is not the step's, but of the contacts. */
#ifndef PLUMB_DISCRETE_ANSWER_H
#define PLUMB_DISCRETE_ANSWER_H

#include "integrator.h"

/* m, along the travel; NAN where it is not known. */
double pl_discrete_travel(const pl_scene *scene, const pl_expect_travel *travel,
                          pl_integrator integrator);

/* In the value's unit; NAN where it is not known. */
double pl_discrete_value(const pl_scene *scene, const pl_expect_value *value,
                         pl_integrator integrator);

#endif
