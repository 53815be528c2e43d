/* The engine ABI: the table of C functions through which the harness drives an engine, whether it
 * is built in or loaded from a shared object (`--engine ./mine.so:profile`).
 *
 * A shared object exports one symbol, `plumb_engine` (PL_ENGINE_SYMBOL), of type pl_engine_entry.
 * struct_size and abi_version come first in pl_engine, and a field is only ever added at the end of
 * a struct. What not every engine has is asked for by name: see pl_engine.extension.
 *
 * Conventions, to which an adapter converts those of its engine: SI units; quaternions (w, x, y,
 * z), unit, body to world; velocity of the centre of mass and angular velocity in the world frame;
 * normals point from body A to body B; a negative separation is a penetration; impulses in N s, on
 * body B.
 *
 * The harness calls an engine from one thread, in this order: create; read_settings, read_pair,
 * read_frame; then for each step: step, read_frame, read_contacts; at the end destroy. An engine
 * may print: its output is captured. A function that fails writes a message into the caller's
 * pl_error. */
#ifndef PLUMB_ENGINE_ABI_H
#define PLUMB_ENGINE_ABI_H

#include "plumb/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PL_ENGINE_ABI_VERSION = 1,
    PL_ENGINE_MAX_OPTIONS = 24 /* the most options that an engine may have */
};

/* The name of the symbol, of type pl_engine_entry, that a shared object exports. */
#define PL_ENGINE_SYMBOL "plumb_engine"

/* A numeric setting of an engine, given as `name:profile,option=value`. */
typedef struct pl_engine_option {
    const char *name; /* at most PL_NAME_SIZE - 1 bytes */
    double value;     /* default */
    double min;       /* least value allowed */
    double max;       /* largest value allowed */
    bool integer;     /* only whole numbers are allowed */
    const char *unit; /* "1" when dimensionless */
    const char *help; /* one line, for `plumb list engines` */
} pl_engine_option;

/* A solver, or a set of defaults, of an engine. */
typedef struct pl_engine_profile {
    const char *name;           /* at most PL_NAME_SIZE - 1 bytes */
    const char *help;           /* one line, for `plumb list engines` */
    bool in_default_comparison; /* run by `plumb compare` when no --engine is given */
} pl_engine_profile;

/* Statistics of one step. The harness sets struct_size and fills every number with NAN before the
 * call. The engine overwrites the numbers that it has, and leaves the others NAN: it never writes 0
 * for "unknown". */
typedef struct pl_step_stats {
    uint32_t struct_size; /* sizeof(pl_step_stats) of the caller */
    double iterations;    /* of the velocity solver; the largest over the islands */
    double residual;      /* after the last iteration, in pl_engine.residual_unit; the largest */
    double contacts;      /* contact points given to the solver */
    double islands;       /* groups of bodies that are solved apart from each other */
    double time_collide;  /* s, for collision detection */
    double time_solve;    /* s, for the velocity solver */
    double time_other;    /* s, for the rest of the step */
} pl_step_stats;

/* The state of one body. */
typedef struct pl_body_state {
    double position[3];         /* m, of the shape's own frame, as in the scene */
    double orientation[4];      /* w, x, y, z; of the shape's own frame */
    double velocity[3];         /* m/s, of the centre of mass */
    double angular_velocity[3]; /* rad/s, in the world frame */
} pl_body_state;

/* The state of all bodies of the scene, static ones included, in the scene's order. The caller owns
 * it: it sets body_count to the scene's and provides `bodies`. The engine fills the rest. */
typedef struct pl_frame {
    double time;           /* s since the start */
    int body_count;        /* set by the caller */
    pl_body_state *bodies; /* (body_count) */
} pl_frame;

/* One contact point as the solver of the last step left it. */
typedef struct pl_contact {
    int body_a;        /* index in the scene */
    int body_b;        /* index in the scene */
    double point[3];   /* m, in the world */
    double normal[3];  /* unit, from A to B */
    double separation; /* m; negative in penetration */
    double impulse[3]; /* N s, on B over the whole step, in the world frame */
} pl_contact;

/* What the engine really simulates, read from its own objects and not from what the adapter was
 * given. The caller owns the arrays and sets body_count. */
typedef struct pl_engine_settings {
    double gravity[3];    /* m/s^2 */
    double dt;            /* s, the time step that step(dt) will really make */
    double *mass;         /* (body_count) kg; 0 for a static body */
    double (*inertia)[3]; /* (body_count) kg m^2, principal, in any order; 0 for a static body */
    int body_count;       /* set by the caller */
} pl_engine_settings;

/* A scene in an engine. Each engine defines it for itself. */
typedef struct pl_engine_instance pl_engine_instance;

/* An engine: a constant description and its functions. */
typedef struct pl_engine {
    uint32_t struct_size;              /* sizeof(pl_engine) as compiled */
    uint32_t abi_version;              /* PL_ENGINE_ABI_VERSION as compiled */
    const char *name;                  /* such as "ode" */
    const char *version;               /* such as "0.16.2" */
    const char *description;           /* one line, for `plumb list engines` */
    const char *residual_unit;         /* of pl_step_stats.residual; NULL: it never has one */
    uint32_t capabilities;             /* PL_NEEDS_* bits of scenario.h that it supports */
    const pl_engine_profile *profiles; /* (profile_count); the first is the default */
    int profile_count;                 /* at least 1 */
    const pl_engine_option *options;   /* (option_count); NULL: none */
    int option_count;                  /* at most PL_ENGINE_MAX_OPTIONS */

    /* Overwrites values[option_count], which holds the defaults of `options`, with those of a
     * profile. NULL when no profile differs. */
    void (*profile_defaults)(int profile, double *values);

    /* Builds the scene with a profile and values[option_count], complete and in range. The scene
     * outlives the instance. PL_UNSUPPORTED with a reason when the engine cannot simulate it. */
    pl_status (*create)(const pl_scene *scene, int profile, const double *values,
                        pl_engine_instance **instance, pl_error *error);

    /* Frees an instance; NULL is allowed. */
    void (*destroy)(pl_engine_instance *instance);

    /* Advances by dt seconds. PL_UNSUPPORTED or PL_FAILED end the run with that outcome. */
    pl_status (*step)(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error);

    /* Reads the state after the last step, or the initial state. */
    void (*read_frame)(const pl_engine_instance *instance, pl_frame *frame);

    /* Reads back what the engine simulates; dt is the time step that the caller will use. */
    void (*read_settings)(const pl_engine_instance *instance, double dt,
                          pl_engine_settings *settings);

    /* Reads the friction and restitution coefficients of a contact between two bodies. */
    void (*read_pair)(const pl_engine_instance *instance, int body_a, int body_b, double *friction,
                      double *restitution);

    /* Reads the contacts of the last step that carry or may carry force: fills up to `capacity`,
     * and returns how many there are. NULL when the engine does not report contacts. */
    int (*read_contacts)(const pl_engine_instance *instance, pl_contact *contacts, int capacity);

    /* A table of more functions by its name and version, such as "vendor.feature/1"; NULL for a
     * name that the engine does not know. The table is constant, and its type is declared where the
     * name is. NULL when the engine has no extensions. */
    const void *(*extension)(const char *name);
} pl_engine;

/* The type of the symbol that a shared object exports: returns its engine, valid for as long as the
 * object is loaded. */
typedef const pl_engine *(*pl_engine_entry)(void);

#ifdef __cplusplus
}
#endif
#endif
