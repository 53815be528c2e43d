/* A thin C interface over Bullet's public C++ classes. It knows no scene, and converts conventions
 * to those of plumb/engine_abi.h: quaternions (w, x, y, z), normals from A to B,
 * impulses on B. No C++ exception passes through it. Bodies are numbered from 0 in the order of
 * their adding. */
#ifndef PLUMB_BULLET_C_H
#define PLUMB_BULLET_C_H

#include "plumb/engine_abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The solvers of Bullet. */
typedef enum pl_bullet_solver {
    PL_BULLET_SI,      /* btSequentialImpulseConstraintSolver */
    PL_BULLET_NNCG,    /* btNNCGConstraintSolver */
    PL_BULLET_DANTZIG, /* btMLCPSolver with btDantzigSolver */
    PL_BULLET_LEMKE    /* btMLCPSolver with btLemkeSolver */
} pl_bullet_solver;

/* Settings with defaults of Bullet's, which a world may change. */
typedef struct pl_bullet_settings {
    int iterations;               /* largest number of sweeps a step */
    bool split_impulse;           /* deep penetration is undone without adding to the velocity */
    double split_threshold;       /* m, negative: the separation below which it is split */
    double erp, erp2;             /* share of error undone a step: joints, contacts */
    double restitution_threshold; /* m/s: slower impacts do not bounce */
    double margin;                /* m: of a box or a cylinder, inside its half extents */
    double solid_margin;          /* m: of a hull or a moving mesh, around it */
    /* Further support points sought each step where a convex shape meets a plane with fewer points
     * than that; 0: one point a step, gathered over the steps. */
    int plane_multipoint;
    int convex_multipoint;   /* the same of two convex shapes that have no collider of their own */
    int friction_directions; /* rows of friction a contact point, 1 or 2 */
    double warm_start;       /* share of a point's last normal impulse that a solve begins with */
    bool random_order;       /* sweeps visit the rows in a new order each */
    double slop;             /* m: penetration that is not undone */
    /* Share of the smaller shape's reach beyond which a kept contact point is dropped. */
    double contact_breaking;
} pl_bullet_settings;

/* The settings that Bullet's own constructors make. */
pl_bullet_settings pl_bullet_defaults(void);

/* Friction and restitution of a contact between two bodies. */
typedef void (*pl_bullet_pair)(const void *context, int body_a, int body_b, double *friction,
                               double *restitution);

/* What a world is made of. */
typedef struct pl_bullet_world_def {
    pl_bullet_solver solver;
    pl_bullet_settings settings;
    double gravity[3];   /* m/s^2 */
    double matrix_limit; /* bytes that a dense solver may take */
    pl_bullet_pair pair; /* asked whenever a contact point is made */
    const void *context; /* of `pair`; outlives the world */
} pl_bullet_world_def;

/* A world of Bullet. */
typedef struct pl_bullet_world pl_bullet_world;

/* Makes a world; NULL when Bullet is not built in double precision or memory runs out. */
pl_bullet_world *pl_bullet_world_create(const pl_bullet_world_def *def);

/* Destroys a world; NULL is allowed. */
void pl_bullet_world_destroy(pl_bullet_world *world);

/* Adds a body with the scene's shape, velocities, mass and inertia, never to sleep; its position
 * and orientation are those of its principal frame (plumb/adapter_helpers.h), here and when read
 * back. A hull or mesh outlives the world.
 * PL_UNSUPPORTED for a shape that this interface does not know, PL_NO_MEMORY. */
pl_status pl_bullet_add_body(pl_bullet_world *world, const pl_body *body);

/* Applies a force (N, world frame) at an offset from the centre of mass (m, world frame) for the
 * next step only. */
void pl_bullet_add_force(pl_bullet_world *world, int body, const double force[3],
                         const double offset[3]);

/* One step of exactly dt. Fills what Bullet reports of stats. PL_UNSUPPORTED, before solving, when
 * a dense solver needs more than matrix_limit: then *rows and *bytes say what it needs. PL_FAILED
 * when Bullet threw. */
pl_status pl_bullet_step(pl_bullet_world *world, double dt, pl_step_stats *stats, double *rows,
                         double *bytes);

/* The number of islands that a dense solver gave up and left to sequential impulse so far. */
int pl_bullet_fallbacks(const pl_bullet_world *world);

/* The state of a body, of its principal frame. */
void pl_bullet_read_body(const pl_bullet_world *world, int body, pl_body_state *state);

/* The mass (kg) and the principal inertia (kg m^2) of a body; 0 for a static one. */
void pl_bullet_read_mass(const pl_bullet_world *world, int body, double *mass, double inertia[3]);

/* The gravity of the world, m/s^2. */
void pl_bullet_read_gravity(const pl_bullet_world *world, double gravity[3]);

/* The friction and restitution of a contact between two bodies. */
void pl_bullet_read_pair(const pl_bullet_world *world, int body_a, int body_b, double *friction,
                         double *restitution);

/* As read_contacts of pl_engine. */
int pl_bullet_read_contacts(const pl_bullet_world *world, pl_contact *contacts, int capacity);

#ifdef __cplusplus
}
#endif
#endif
