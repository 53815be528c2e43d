/* The modules of the referee. Each measures something of a run: it keeps a state of its own, sees every
 * frame, and sets its metrics at the end. The view of the run has the data that several of them need. */
#ifndef PLUMB_MODULES_H
#define PLUMB_MODULES_H

#include "mechanics.h"
#include "touching.h"

/* The data of a run that modules use. Pointers are borrowed until the call returns. */
typedef struct pl_run_view {
    const pl_scene *scene;
    pl_scale scale;
    pl_touching *touching;       /* has seen the frame */
    pl_mechanics *mechanics;     /* has seen the step */
    pl_step step;                /* the last one; number 0 and before NULL: the start */
    const pl_step_stats *stats;  /* NULL: the engine reports none */
    double cpu_time;             /* of the step, s */
    const char *residual_unit;   /* at the end; NULL: the engine never reports a residual */
    pl_position_rule integrator; /* at the end */
    const pl_body_state *last;   /* at the end, (scene->body_count): the last valid frame */
} pl_run_view;

/* A module. `state` is what its create returned. */
typedef struct pl_module {
    /* Makes the state, in memory of the arena. The scene outlives the state. A
     * module without a state has NULL here. */
    void *(*create)(const pl_scene *scene, pl_arena *arena);
    /* Takes the start, and the frame after each step. A module that reads the end alone has NULL here. */
    void (*see)(void *state, const pl_run_view *view);
    /* Sets the module's metrics in item (PL_METRIC_COUNT). A metric that does not apply stays
     * PL_METRIC_ABSENT. */
    void (*collect)(void *state, const pl_run_view *view, pl_metric *item);
    bool needs_no_motion; /* it also collects in a scene without dynamic bodies */
} pl_module;

/* The modules, one a line: pl_NAME_module is in NAME.c. */
#define PL_MODULES(MODULE)                                                                         \
    MODULE(step_stats)                                                                             \
    MODULE(balance)                                                                                \
    MODULE(contact_force)                                                                          \
    MODULE(touching)                                                                               \
    MODULE(motion)                                                                                 \
    MODULE(unexplained_motion)

#define PL_DECLARE_MODULE(name) extern const pl_module pl_##name##_module;
PL_MODULES(PL_DECLARE_MODULE)
#undef PL_DECLARE_MODULE

#endif
