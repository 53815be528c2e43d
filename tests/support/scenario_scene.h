/* Scenes of the catalogue for the tests of their references. Whatever fails fails the test. */
#ifndef PLUMB_TEST_SCENARIO_SCENE_H
#define PLUMB_TEST_SCENARIO_SCENE_H

#include "plumb/scenario.h"

/* The scenario with these settings "NAME=VALUE" (NULL-terminated; NULL: none) and seed 0. The
 * caller frees the scene. */
pl_scene scenario_scene(const char *name, const char *const *settings);

/* The same with `count` settings and any seed. The caller frees *scene. */
void build_scenario(const char *name, const char *const *settings, int count, uint64_t seed,
                    pl_scene *scene);

/* The only expectation of this kind. `axis` is the axis of its direction, 0 to 2. */
const pl_expect_value *expected_value(const pl_scene *scene, int body, pl_quantity quantity,
                                      int axis);

/* Checks that it is refused as bad input, with `part` in the message. */
void assert_scenario_refuses(const char *name, const char *const *settings, const char *part);

/* The same of one setting. */
void assert_setting_refused(const char *name, const char *setting, const char *part);

/* Every dynamic body is expected to end as it starts. */
void check_all_rest(const pl_scene *scene);

/* The value of a metric that `plumb run` gives for plumb:accurate at this dt (a text). The outcome
 * must be ok. */
double accurate_metric(const char *name, const char *const *settings, const char *dt,
                       const char *metric_name);

/* Classical Runge-Kutta (Kutta 1901) of y' = f(t, y), y of `size` numbers, at most 8, over `steps`
 * equal steps. */
typedef void (*rate_function)(const void *context, double t, const double *y, double *rate);
void integrate(rate_function rate, const void *context, double from, double until, int steps,
               int size, double *y);

#endif
