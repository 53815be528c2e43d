/* A run of the referee on frames that the test defines: the scene, its referee, and the state that
 * the test changes. Every failure fails the test. */
#ifndef PLUMB_TEST_SYNTHETIC_RUN_H
#define PLUMB_TEST_SYNTHETIC_RUN_H

#include "referee/referee.h"

static const double H = 1.0 / 64; /* s, the step: its multiples are exact */

enum { MOST_BODIES = 8 };

typedef struct run {
    pl_scene scene;
    pl_referee *referee;
    pl_body_state state[MOST_BODIES];
    pl_step_stats stats;
    pl_metrics metrics;
    pl_note note;
    pl_error error;
    pl_referee_engine engine; /* {0}, as run_prepare leaves it: one sub-step, doubles */
} run;

/* An empty scene with step H that lasts `duration` seconds, and one material of friction 0.5. */
void run_prepare(run *r, double duration);
/* A body of 2 kg at (x, 0, z), added before run_begin. */
void run_add_body(run *r, const char *name, pl_shape shape, bool is_static, double x, double z);
/* The body is expected to rest at its initial pose. */
void run_expect_rest(run *r, int body);
/* The body is expected to travel along x. */
void run_expect_travel(run *r, int body, double distance, double discrete);
/* A floor (body 0) and a cube of side 1 (body 1) that is expected to rest on it. */
void run_prepare_box_on_floor(run *r, double duration);

/* Starts the referee with the scene's initial state. */
void run_begin(run *r);
/* Gives the referee the current r->state with these contacts (count -1: none reported). */
pl_ending run_step_with(run *r, const pl_contact *contacts, int count);
pl_ending run_step(run *r);
/* `count` steps, of which each must go on. */
void run_step_many(run *r, long count);
pl_ending run_finish(run *r);
void run_end(run *r);
pl_frame run_frame(run *r);

/* Of a finished run; run_value fails the test when there is none. */
const pl_metric *run_metric(const run *r, pl_metric_id id);
double run_value(const run *r, pl_metric_id id);

#endif
