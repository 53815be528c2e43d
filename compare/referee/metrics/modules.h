/* The modules of the referee. Each measures something of a run: it keeps a state of its own, sees every
 * frame, and sets its metrics at the end. The view of the run has the data that several of them need. */
#ifndef PLUMB_MODULES_H
#define PLUMB_MODULES_H

#include "expectations.h"
#include "mechanics.h"
#include "series.h"
#include "touching.h"

/* The data of a run that modules use. Pointers are borrowed until the call returns. */
typedef struct pl_run_view {
    const pl_scene *scene;
    pl_scale scale;
    /* Of each metric over steps (PL_TRAIT_OVER_STEPS); one for each rule of one by the integrator. */
    pl_series *series[PL_METRIC_COUNT];
    pl_touching *touching;       /* has seen the frame */
    pl_mechanics *mechanics;     /* has seen the step */
    pl_values *values;           /* have seen the frame */
    pl_step step;                /* the last one; number 0 and before NULL: the start */
    const char *residual_unit;   /* at the end; NULL: the engine never reports a residual */
    pl_position_rule integrator; /* at the end */
    const pl_body_state *last;   /* at the end, (scene->body_count): the last valid frame */
} pl_run_view;

/* Makes view->series, in memory of the arena. */
void pl_make_series(pl_run_view *view, pl_arena *arena);

/* Adds the value of a metric over steps in the last step, >= 0; a NaN is not added. */
void pl_see_value(const pl_run_view *view, pl_metric_id id, double value);

/* The same of a metric by the integrator (PL_TRAIT_BY_INTEGRATOR), for one of these. */
void pl_see_value_by(const pl_run_view *view, pl_metric_id id, pl_position_rule rule, double value);

/* Sets the metrics over steps in item (PL_METRIC_COUNT) for which a value was seen, or whose series
 * applies without one. Those of impulses stay absent unless the engine reported all. */
void pl_series_metrics(const pl_run_view *view, bool has_impulses, pl_metric *item);

/* A module. `state` is what its create returned. The referee makes the metrics over steps of the values
 * that modules have added. */
typedef struct pl_module {
    /* Makes the state, in memory of the arena. The scene outlives the state. A module without a state
     * can have NULL here. */
    void *(*create)(const pl_run_view *view, pl_arena *arena);
    /* Takes the frame after each step. A module that reads the end alone has NULL here. */
    void (*see)(void *state, const pl_run_view *view);
    /* Sets the module's other metrics in item (PL_METRIC_COUNT), which has those over steps. A metric
     * that does not apply stays PL_METRIC_ABSENT. NULL: there are none. */
    void (*collect)(void *state, const pl_run_view *view, pl_metric *item);
    bool needs_no_motion; /* it is also used in a scene without dynamic bodies */
    bool needs_no_pairs;  /* it sees a step while the pairs that touch are found */
    bool sees_start;      /* it also sees the start */
} pl_module;

/* The modules, one a line: pl_NAME_module is in NAME.c. */
#define PL_MODULES(MODULE)                                                                         \
    MODULE(step_stats)                                                                             \
    MODULE(mechanics)                                                                              \
    MODULE(contact_force)                                                                          \
    MODULE(touching)                                                                               \
    MODULE(motion)                                                                                 \
    MODULE(unexplained_motion)

#define PL_DECLARE_MODULE(name) extern const pl_module pl_##name##_module;
PL_MODULES(PL_DECLARE_MODULE)
#undef PL_DECLARE_MODULE

/* ---- Whether a step repeats the last one ---- */

/* A copy of the last step. */
typedef struct pl_repeated_steps pl_repeated_steps;

/* `scene` and `arena` must outlive it. Memory of the arena. */
pl_repeated_steps *pl_repeated_steps_create(const pl_scene *scene, pl_arena *arena);

/* Takes a step, whose contacts may be unreported. Returns whether its states, contacts and times are, bit
 * for bit, those of the step taken before it: the referee need not measure such a step again. */
bool pl_repeated_steps_see(pl_repeated_steps *repeats, const pl_step *step);

/* ---- The velocities that contacts leave (contact_motion.c) ---- */

/* Memory for one step of all bodies. */
typedef struct pl_contact_motion pl_contact_motion;

/* `scene` and `arena` must outlive it. Memory of the arena. */
pl_contact_motion *pl_contact_motion_create(const pl_scene *scene, pl_arena *arena);

/* Takes a step whose contacts have times, and follows its bodies. */
void pl_contact_motion_step(pl_contact_motion *motion, const pl_step *step);

/* Velocities of B's point relative to A's, m/s, world. */
typedef struct pl_contact_velocity {
    pl_vec left; /* at the end of the interval, where the contact law holds */
    pl_vec mean; /* of its begin and its end, where the impulse acted */
} pl_contact_velocity;

/* Those of contact i of the step. */
pl_contact_velocity pl_contact_motion_velocity(const pl_contact_motion *motion, const pl_step *step,
                                               int i);

#endif
