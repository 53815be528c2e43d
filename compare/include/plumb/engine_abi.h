/* The engine ABI: the one table of C functions through which the harness drives any engine, whether
 * built in or loaded from a shared object (`--engine ./mine.so:profile`).
 *
 * A shared object exports one symbol, `plumb_engine` (PL_ENGINE_SYMBOL), of type pl_engine_entry.
 * Growth: struct_size and abi_version come first; a field is only ever added at an end.
 *
 * Conventions (the adapter undoes its engine's own): SI units; quaternions (w, x, y, z), unit, body
 * to world; velocity of the centre of mass and angular velocity in the world frame; normals point
 * from body A to body B; separation is negative in penetration; impulses in N s, on body B.
 *
 * The harness calls from one thread, in this order: create; read_settings, read_pair, read_frame;
 * then for each step: step, read_frame, read_contacts; last destroy. An engine may print: its
 * output is captured. An error message is written into the caller's pl_error. */
#ifndef PLUMB_ENGINE_ABI_H
#define PLUMB_ENGINE_ABI_H

#include "plumb/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { PL_ENGINE_ABI_VERSION = 1, PL_ENGINE_MAX_OPTIONS = 24 };
#define PL_ENGINE_SYMBOL "plumb_engine"

/* A numeric setting, given as `name:profile,option=value`. */
typedef struct pl_engine_option {
    const char *name;
    double value, min, max; /* default and inclusive range */
    bool integer;
    const char *unit;
    const char *help;
} pl_engine_option;

/* A solver of the engine. Its own defaults: profile_defaults. */
typedef struct pl_engine_profile {
    const char *name;
    const char *help;
    bool in_default_comparison; /* run by `plumb compare` when no --engine is given */
} pl_engine_profile;

/* What one step did. The harness sets struct_size and fills every number with NAN before the call;
 * the engine overwrites what it has, and leaves NAN what it does not have (never 0 for "none"). */
typedef struct pl_step_stats {
    uint32_t struct_size;
    double iterations; /* of the velocity solver, largest over islands */
    double
        residual; /* after the last iteration, in pl_engine.residual_unit, largest over islands */
    double contacts; /* contact points handed to the solver */
    double islands;
    double time_collide, time_solve, time_other; /* s */
} pl_step_stats;

typedef struct pl_body_state {
    double position[3];    /* of the shape's own frame, as in the scene */
    double orientation[4]; /* w, x, y, z */
    double velocity[3];
    double angular_velocity[3];
} pl_body_state;

/* The state of all bodies of the scene, in the scene's order, static ones too. Caller-owned: the
 * caller sets body_count to the scene's and provides bodies; the engine fills time and *bodies. */
typedef struct pl_frame {
    double time; /* s */
    int body_count;
    pl_body_state *bodies; /* (body_count) */
} pl_frame;

/* One contact point as the last step's solver left it. */
typedef struct pl_contact {
    int body_a, body_b; /* scene indices */
    double point[3];    /* world, m */
    double normal[3];   /* unit, from A to B */
    double separation;  /* m */
    double impulse[3];  /* on B over the whole step, world, N s */
} pl_contact;

/* Read back from the engine's own objects, not from what the adapter handed in. Caller-owned
 * arrays, and body_count is the caller's. */
typedef struct pl_engine_settings {
    double gravity[3];
    double dt;            /* the step that step(dt) will really make */
    double *mass;         /* (body_count), static: 0 */
    double (*inertia)[3]; /* (body_count x 3), principal, static: 0 */
    int body_count;
} pl_engine_settings;

struct pe_contact_problem; /* plumb/contact_problem.h, a header of our engine */

typedef struct pl_engine_instance pl_engine_instance; /* opaque, defined by each engine */

typedef struct pl_engine {
    uint32_t struct_size; /* sizeof(pl_engine) as compiled */
    uint32_t abi_version; /* PL_ENGINE_ABI_VERSION as compiled */
    const char *name;     /* "ode" */
    const char *version;  /* "0.16.2" */
    const char *description;
    const char *residual_unit;         /* of pl_step_stats.residual; NULL when it never has one */
    uint32_t capabilities;             /* PL_NEEDS_* bits of scenario.h that it can do */
    const pl_engine_profile *profiles; /* at least one; the first is the default */
    int profile_count;
    const pl_engine_option *options;
    int option_count;

    /* The defaults of `options` as this profile ships them: overwrites values[option_count], which
     * holds the table's own defaults. NULL when no profile differs. */
    void (*profile_defaults)(int profile, double *values);

    /* Builds the scene. values[option_count] is complete and in range. The scene outlives the
     * instance. PL_UNSUPPORTED with a reason when the engine cannot do the scene as it stands. */
    pl_status (*create)(const pl_scene *scene, int profile, const double *values,
                        pl_engine_instance **instance, pl_error *error);
    void (*destroy)(pl_engine_instance *instance); /* NULL allowed */

    /* Advances by dt seconds. PL_UNSUPPORTED or PL_FAILED end the run with that outcome. */
    pl_status (*step)(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error);

    void (*read_frame)(const pl_engine_instance *instance, pl_frame *frame);

    /* dt is the step that the caller means to make. */
    void (*read_settings)(const pl_engine_instance *instance, double dt,
                          pl_engine_settings *settings);

    /* Friction and restitution that a contact between these two bodies gets. */
    void (*read_pair)(const pl_engine_instance *instance, int body_a, int body_b, double *friction,
                      double *restitution);

    /* Contacts of the last step that carry or may carry force: fills up to `capacity`, returns how
     * many there are. NULL when the engine does not report them. */
    int (*read_contacts)(const pl_engine_instance *instance, pl_contact *contacts, int capacity);

    /* The contact problems that step(dt) would solve next, one an island with a contact, warm
     * starts included: *problems is an array of *count, to be released by
     * pe_contact_problems_destroy (plumb/contact_problem.h). What follows is the same as without
     * the call. NULL: this engine does not give them. */
    pl_status (*capture)(pl_engine_instance *instance, double dt,
                         struct pe_contact_problem ***problems, int *count, pl_error *error);
} pl_engine;

typedef const pl_engine *(*pl_engine_entry)(void);

#ifdef __cplusplus
}
#endif
#endif
