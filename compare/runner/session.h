/* An engine at work in this process: every call to an engine goes through here. Each call is timed
 * where that is wanted, and the floating-point environment is restored after it. A session crashes
 * with its engine: isolated_run.c makes a run in a process of its own. */
#ifndef PLUMB_SESSION_H
#define PLUMB_SESSION_H

#include "adapters/process/adapter_process.h"
#include "engines/load_engine.h"
#include "engines/registry.h"
#include "plumb/contact_times.h"
#include "plumb/scenario.h"
#include "referee/metrics/expectations.h"
#include "resource_usage.h"
#include "results/result.h"

#include <stdint.h>

/* The stages of a session. */
typedef enum pl_stage {
    PL_STAGE_PREPARE, /* nothing of the engine was called yet */
    PL_STAGE_LOAD,
    PL_STAGE_CREATE,
    PL_STAGE_SETTINGS,
    PL_STAGE_CAPTURE,
    PL_STAGE_STEP,
    PL_STAGE_READ,  /* the frame and the contacts */
    PL_STAGE_JUDGE, /* the referee's own work */
    PL_STAGE_DESTROY,
    PL_STAGE_UNLOAD,
    PL_STAGE_REPORT /* the engine is gone, and its run is reported */
} pl_stage;

/* The groups of calls that are timed apart. */
typedef enum pl_call_group {
    PL_CALLS_CREATE, /* create alone */
    PL_CALLS_STEP,
    PL_CALLS_READ, /* read_frame, read_contacts */
    PL_CALLS_OTHER /* read_settings, read_pair, destroy */
} pl_call_group;
enum { PL_CALL_GROUP_COUNT = 4 };

/* The first call of an engine that left floating-point modes changed. */
typedef struct pl_mode_change {
    unsigned modes; /* PL_MODE_* bits; 0: no call did */
    pl_stage stage; /* of that call */
} pl_mode_change;

/* A session. Starts as pl_session_begin. */
typedef struct pl_session {
    const pl_engine_choice *choice;
    pl_loaded_engine loaded;
    pl_engine_setup setup;
    pl_pair_coefficients *pairs;
    pl_engine_instance *instance;
    long steps;                       /* of the scene so far */
    pl_stage stage;                   /* of the present call */
    pl_float_environment environment; /* before it, restored after it */
    pl_mode_change mode_change;       /* what the restoring has undone */
    pl_call_timer timer;
    pl_process_engine_time program_time; /* of an engine that is a program, after the last call */
    pl_call_cost cost[PL_CALL_GROUP_COUNT]; /* sums over the calls of each group */
    /* Told at the beginning of each stage; NULL: nobody. */
    void (*enter)(void *user, pl_stage stage);
    void *user;
} pl_session;

/* What the engine does at a stage, as the subject of a message: "step". Static storage. */
const char *pl_stage_name(pl_stage stage);

/* A session with an engine that is not loaded yet. `choice` must outlive it. */
pl_session pl_session_begin(const pl_engine_choice *choice);

/* Loads the engine. PL_FAILED: it cannot be loaded, or is not the engine that was described. */
pl_status pl_session_load(pl_session *session, pl_error *error);

/* Creates the scene, which must outlive the instance, after pl_needs_check. The engine's own
 * status. */
pl_status pl_session_create(pl_session *session, const pl_scene *scene, pl_error *error);

/* One step of the scene's dt. *stats is set to "unknown" before the call, and *cost (NULL allowed)
 * to what the call cost. The engine's own status. */
pl_status pl_session_step(pl_session *session, pl_step_stats *stats, pl_call_cost *cost,
                          pl_error *error);

/* The state of all bodies in `frame`, whose arrays are the caller's. */
void pl_session_read_frame(pl_session *session, pl_frame *frame);

/* The contacts of the last step: *contacts, an array of *capacity that may grow, and their number
 * in *count; -1 when the engine does not report contacts. PL_FAILED: a number that cannot be. */
pl_status pl_session_read_contacts(pl_session *session, pl_contact **contacts, int *capacity,
                                   int *count, pl_error *error);

/* When the contacts of the last pl_session_read_contacts acted: *times, an array of *capacity that
 * may grow. False when the engine does not say, or there are none. */
bool pl_session_read_contact_times(pl_session *session, int count, pl_contact_time **times,
                                   int *capacity);

/* What the engine reads back; `settings` has its arrays and body_count, and is prepared here. */
void pl_session_read_settings(pl_session *session, pl_engine_settings *settings);

/* The coefficients of a pair of bodies as the engine has them; NAN: it does not say. */
pl_pair_coefficients pl_session_read_pair(pl_session *session, int body_a, int body_b);

/* Whether create and the steps have taken more than `cpu_limit` s of CPU time; 0: no limit. Reads serve the harness. */
bool pl_session_is_over_limit(const pl_session *session, double cpu_limit);

/* Destroys the instance, if there is one. Another scene may then be created. */
void pl_session_destroy(pl_session *session);

/* Destroys the instance, if there is one, and unloads the engine. */
void pl_session_end(pl_session *session);

/* Whether the engine has what the scene needs. PL_UNSUPPORTED says what it lacks. */
pl_status pl_needs_check(const pl_scene *scene, const pl_engine_info *engine, pl_error *error);

/* A box that holds all bodies but planes at the start, grown on all sides by 100 m, or by the distance
 * that the fastest of them goes in 10 s; m. It does not depend on the scene's duration. */
void pl_scene_bounds(const pl_scene *scene, double lower[3], double upper[3]);

/* ---- Checks of the values that an engine says (engine_values.c) ---- Before a run: it must simulate the masses,
 * inertias, gravity, time step, friction and restitution of the scene, without damping; they are read back from the
 * engine. In each step: a run in which it reports a value that cannot be ends, with the value, the field and the step
 * as its reason, because every metric of it would be in doubt. */

/* Compares the engine's own masses, principal inertias (in any order), gravity, step, damping, and
 * the friction and restitution of every pair of materials that two bodies can bring together, with
 * the scene's: to 1e-12 relative, or to 16 units in the last place of a float where the engine
 * computes with floats. What the engine does not read back is not compared. *compared has a bit
 * 1 << pl_read_back for each kind of number that was, and *substeps the engine's sub-steps per step.
 * PL_UNSUPPORTED names the first number that differs, with both values. */
pl_status pl_parameter_check(pl_session *session, const pl_scene *scene, unsigned *compared,
                             int *substeps, pl_error *error);

/* Checks the statistics of a step: each is NAN (unknown), or finite and at least 0, and a count
 * at most 1e12. PL_FAILED. */
pl_status pl_check_stats(const pl_step_stats *stats, long step, pl_error *error);

/* Checks `count` contacts of a step, of an engine that reports the PL_CONTACTS_* bits `reported`:
 * two different bodies of the scene, finite numbers, and normals of unit length to 1e-3.
 * PL_FAILED. */
pl_status pl_check_contacts(const pl_contact *contacts, int count, uint32_t reported,
                            int body_count, long step, pl_error *error);

/* PL_FAILED: a time outside the step, or a number that is not finite. `dt`: of the step, s. */
pl_status pl_check_contact_times(const pl_contact_time *times, int count, double dt, long step,
                                 pl_error *error);

/* ---- A second run of a scene in the same process (second_run.c): whether an engine gives the same bits again. State
 * that an engine keeps outside its world, or an order that depends on addresses, shows here. ---- */

/* The hashes of the states of a run. Starts as {0}. */
typedef struct pl_state_hashes {
    uint64_t *step; /* (count), by step; NULL: none are kept. The caller frees */
    long count;     /* steps so far, with the state before the first */
} pl_state_hashes;

/* Makes room for the states of a scene that expects the same bits; keeps none of another. */
void pl_state_hashes_create(const pl_scene *scene, pl_state_hashes *hashes);
/* Adds the next state. */
void pl_state_hashes_add(pl_state_hashes *hashes, const pl_frame *frame);

/* Destroys the session's instance, creates the scene again, and takes as many steps as `first` has. It ends
 * early where create and steps take more than `cpu_limit` s (0: no limit) and leaves the session's costs as
 * they were. `frame` is overwritten. The engine's own status. */
pl_status pl_second_run(pl_session *session, const pl_scene *scene, const pl_state_hashes *first,
                        double cpu_limit, pl_frame *frame, pl_difference *difference,
                        pl_error *error);

#endif
