/* The exact answers of an integrator at the scene's step, with any number of sub-steps, to what the
 * scene expects. */
#ifndef PLUMB_DISCRETE_ANSWER_H
#define PLUMB_DISCRETE_ANSWER_H

#include "integrator.h"

/* The distance of a travel, m; NAN if it is not known. */
double pl_discrete_travel(const pl_scene *scene, const pl_expect_travel *travel,
                          pl_position_rule rule, const pl_referee_engine *engine);

/* An expected value, in its unit; NAN if it is not known. */
double pl_discrete_value(const pl_scene *scene, const pl_expect_value *value, pl_position_rule rule,
                         const pl_referee_engine *engine);

#endif
