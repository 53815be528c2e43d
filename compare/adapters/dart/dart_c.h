/* A thin C interface over DART's public C++ classes. It converts conventions to those of
 * plumb/engine_abi.h: quaternions (w, x, y, z), normals from A to B, impulses on B. No C++
 * exception passes through it. Bodies have the numbers of the scene. */
#ifndef PLUMB_DART_C_H
#define PLUMB_DART_C_H

#include "plumb/engine_abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* DART's collision detectors, but for Bullet's. */
typedef enum pl_dart_detector {
    PL_DART_FCL, /* FCLCollisionDetector, DART's default */
    PL_DART_ODE, /* OdeCollisionDetector */
    PL_DART_OWN  /* DARTCollisionDetector */
} pl_dart_detector;

/* Settings with defaults of DART's, which a world may change. */
typedef struct pl_dart_settings {
    int iterations;          /* largest number of sweeps of PGS */
    double delta_x;          /* N s: a first sweep that changes no impulse by more ends PGS */
    double relative_delta_x; /* a sweep that changes no impulse by a larger share of it ends PGS */
    bool random_order;       /* every eighth sweep of PGS draws a new order of the rows */
    int max_contacts;        /* contact points of a step; those found later are dropped */
    double cfm;              /* constraint force mixing: share added to the diagonal */
    double erp;              /* error reduction parameter: share of penetration undone a step */
    double error_allowance;  /* m: penetration that is not undone */
    double max_erv;          /* m/s: the fastest that penetration is undone */
    bool fcl_primitives;     /* FCL's own shapes in place of triangles */
} pl_dart_settings;

/* The settings that DART itself has. */
pl_dart_settings pl_dart_defaults(void);

/* What a world is made of, besides the scene. */
typedef struct pl_dart_world_def {
    pl_dart_detector detector;
    bool pgs; /* PGS alone; else Dantzig, and PGS where Dantzig fails */
    pl_dart_settings settings;
    double matrix_limit; /* bytes that the dense matrices of a group may take */
} pl_dart_world_def;

/* A world of DART. */
typedef struct pl_dart_world pl_dart_world;

/* Makes a world with the bodies of the scene; the setup outlives it. Sets
 * *world, to NULL on failure. PL_UNSUPPORTED for a shape that the detector does not have,
 * PL_NO_MEMORY, PL_FAILED. The settings of contacts are DART's global variables: the world that was
 * made last has them. */
pl_status pl_dart_world_create(const pl_dart_world_def *def, const pl_engine_setup *setup,
                               pl_dart_world **world, pl_error *error);

/* Destroys a world; NULL is allowed. */
void pl_dart_world_destroy(pl_dart_world *world);

/* Applies a force (N, world frame) at an offset from the centre of mass (m, world frame) for the
 * next step only. */
void pl_dart_add_force(pl_dart_world *world, int body, const double force[3],
                       const double offset[3]);

/* One step of the setup's dt. Fills what is known of stats. PL_UNSUPPORTED, before solving, when a
 * group needs more than matrix_limit: then *rows and *bytes say what it needs. PL_FAILED when DART
 * threw. */
pl_status pl_dart_step(pl_dart_world *world, pl_step_stats *stats, double *rows, double *bytes);

/* The state of a body, of its principal frame (plumb/adapter_helpers.h); of a plane that of the
 * shape that stands for it. */
void pl_dart_read_body(const pl_dart_world *world, int body, pl_body_state *state);

/* As read_settings of pl_engine. */
void pl_dart_read_settings(const pl_dart_world *world, pl_engine_settings *settings);

/* As read_pair of pl_engine: DART's rule of mixing on what its shapes store; NAN where no shapes of
 * the two bodies are meant to touch. */
void pl_dart_read_pair(const pl_dart_world *world, int body_a, int body_b,
                       pl_pair_coefficients *found);

/* As read_contacts of pl_engine. */
int pl_dart_read_contacts(const pl_dart_world *world, pl_contact *contacts, int capacity);

#ifdef __cplusplus
}
#endif
#endif
