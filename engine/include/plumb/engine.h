/* Plumb's rigid-body engine: the public interface.
 *
 * SI units, right-handed. Quaternions are (w, x, y, z), unit, body to world. Velocities are those
 * of the centre of mass, angular velocities are in the world frame. Normals point from body A to
 * body B; separation is negative in penetration; impulses are in N s, on B.
 *
 * One world holds everything; there is no other state. Worlds are independent of each other, and
 * one world is used by one caller at a time, whose step may share the work among threads. The same calls give the same bits, over runs,
 * compilers and optimisation levels. Nothing here prints or exits: a function that can fail returns
 * a status and fills the optional pe_error. On failure it has changed nothing, unless noted. How
 * well the solver converged is no error: it is in pe_step_stats.
 *
 * Numbers are at most 1e12 in SI units, masses and forces at most 1e30, inertias at most 1e60; lengths
 * and time steps are at least 1e-12, masses 1e-30, inertias 1e-60. Others are out of range. */
#ifndef PLUMB_ENGINE_H
#define PLUMB_ENGINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A vector; the unit and the frame are those of its use. */
typedef struct pe_vec3 {
    double x; /* along the first axis */
    double y; /* along the second axis */
    double z; /* along the third axis */
} pe_vec3;

/* A unit quaternion: the rotation from the body's to the world frame. */
typedef struct pe_quat {
    double w; /* the real part */
    double x; /* along i */
    double y; /* along j */
    double z; /* along k */
} pe_quat;

/* The result of a function that can fail. */
typedef enum pe_status {
    PE_OK = 0,
    PE_BAD_ARGUMENT, /* a number is out of range, or an id is not of a living object */
    PE_NO_MEMORY,    /* the allocator returned NULL */
    PE_NOT_FINITE    /* a step would have left a state that is not finite, or absurd */
} pe_status;

/* What went wrong. Every function that takes one accepts NULL, and fills it only on failure. */
typedef struct pe_error {
    pe_status status;  /* the status that the function returned */
    char message[256]; /* the argument, the number found, and what was expected */
} pe_error;

/* Where a world gets its memory. */
typedef struct pe_allocator {
    void *(*allocate)(void *context, size_t size); /* `size` bytes aligned to 64, or NULL */
    void (*release)(void *context, void *memory);  /* NULL is not passed */
    void *context;                                 /* passed to both */
} pe_allocator;

/* ---- World ---- */

/* Bodies, materials and geometries, with their contacts. */
typedef struct pe_world pe_world;

/* How contacts are solved. */
typedef enum pe_profile {
    /* A solver for each contact island by predicted cost: islands that stand or slide are solved
     * directly, to the tolerance. Where that would cost more, or has failed lately, they are swept:
     * with momentum, at most 30 times in a step, to a residual of 2e-4 m/s, or up to 0.02 m/s in
     * islands of more than 1250 points. An island that meets this settles over the steps, by at
     * most 10 sweeps in each. Positions are corrected after the step; those of swept islands in two
     * rounds at most. */
    PE_PROFILE_DEFAULT,
    /* The same choice, with at most 2000 sweeps to a third of the residual. Positions of swept
     * islands are corrected in up to eight rounds, and from half the depth. */
    PE_PROFILE_ACCURATE,
    /* Moving islands use sub-stepped soft contact. Islands at rest that are cheap to factor are
     * solved directly. */
    PE_PROFILE_FAST
} pe_profile;

/* Threads that a world borrows from its caller: the task system of a game or of a simulator. */
typedef struct pe_task_system {
    /* Calls work(argument) once: now, later, or on another thread. Returns what `wait` takes, or NULL
     * if the call has returned already. */
    void *(*run)(void (*work)(void *argument), void *argument, void *context);
    void (*wait)(void *task, void *context); /* returns when that call has returned */
    void *context;                           /* passed to both */
} pe_task_system;

enum { PE_MOST_THREADS = 256 };

/* The settings of a world, which stay as they are. */
typedef struct pe_world_def {
    pe_vec3 gravity;    /* m/s^2 */
    pe_profile profile; /* how contacts are solved */

    /* A contact problem counts as solved when the largest natural-map residual over its contacts is
     * at most this, in m/s. One step of gravity at 60 Hz is 0.16 m/s. Islands that are swept may
     * keep what their profile allows, and islands of one or two bodies that move a hundred times
     * this; pe_step_stats counts both as unconverged. */
    double tolerance;

    /* Bound on the work of sweeping one island in one step, in contact points visited (sweeps x
     * points). A direct solve is weighed against it: a larger bound lets more islands be solved
     * directly. Sweeps are bounded by the profile, too. Every island gets 50 of them, or what the
     * profile has, if it needs them; so only the accurate profile sweeps less for a smaller
     * bound. */
    double max_contact_updates;

    /* Bound on the iterations of one island in one step: Newton steps and sweeps together. A
     * smaller bound saves time where it leaves an error. */
    int max_iterations;

    /* Approach slower than this, in m/s, does not bounce. 0: restitution holds at every speed. */
    double restitution_threshold;

    /* An island of this many bodies or fewer takes its impacts at their own time within the step,
     * one after the other; in the fast profile where soft contact does not take it. An island with
     * restitution is first divided where its contacts do not act; and the bound is eight times this
     * for parts in which nothing but impacts pushes. Elsewhere, and everywhere at 0, an impact acts
     * at the step's start, over the gap. A step with impacts costs up to 8 sub-steps, or two for each body, each with up to 8
     * passes of solver and narrow phase over the pairs. With F triangles in its meshes that are not
     * collided as hulls, the narrow phase passes over them at most max(2, 2000/F) times, and the
     * rest of the step is an ordinary one. */
    int impact_bodies;

    /* Gap, in m, below which two bodies at rest relative to each other get a contact. Motion within
     * the step is added to it, so that fast bodies do not pass through others. */
    double contact_margin;

    /* Penetration, in m, that is left alone in an island that is swept. Where it is deeper than six
     * times this, in the accurate profile three times, bodies are moved after the step, without a
     * change of momentum, until it is less than one and a half times this or the sweeps of the
     * correction are used up. Islands that are solved directly keep at most 1e-8 m, except where
     * to remove it would give them energy. */
    double penetration_slop;

    /* Whether an island falls asleep in which no point has been faster than 0.05 m/s for 0.5 s. It stays
     * where it is, with velocities of zero, and costs as little as one at rest. An active body that
     * touches it wakes it, a force on it, or a change of bodies or materials. What creeps stops then:
     * pe_step_stats says how far it would have moved. Without it an island rests only where a step
     * would leave it as it is, to rounding. */
    bool sleep;

    pe_allocator allocator; /* all NULL: aligned_alloc and free */

    /* Threads that a step uses, the calling one included: 1 to PE_MOST_THREADS. The bits are the same
     * for any number. With more than one the allocator must be safe to call from several threads at
     * once, and more than there are free cores cost time. */
    int threads;

    /* Where the other threads come from. All NULL: the world starts its own, which end with it. A step
     * then calls `run` threads - 1 times, and `wait` for each task, many times; tasks may be run one
     * after the other. */
    pe_task_system tasks;
} pe_world_def;

/* Gravity (0, 0, -9.81), tolerance 1e-8 m/s, bounds fit for metre-sized bodies, and one thread. */
pe_world_def pe_world_def_default(void);

/* Creates an empty world by a copy of *def. The caller owns *world, which is NULL on failure.
 * PE_BAD_ARGUMENT for a setting out of range, PE_NO_MEMORY. */
pe_status pe_world_create(const pe_world_def *def, pe_world **world, pe_error *error);

/* Destroys a world with all that is in it. NULL is allowed. */
void pe_world_destroy(pe_world *world);

/* Reads the gravity that the world was created with, in m/s^2. */
void pe_world_get_gravity(const pe_world *world, pe_vec3 *gravity);

/* ---- Materials ---- */

/* Names a material of one world. */
typedef struct pe_material_id {
    uint32_t index; /* from 1; 0 is null */
} pe_material_id;

/* Creates a material, which lives as long as the world, from its coefficients of friction (Coulomb,
 * >= 0) and restitution (Newton, 0 .. 1) against itself. Against another material they are the
 * geometric mean of the frictions and the larger restitution, until pe_world_set_pair.
 * PE_BAD_ARGUMENT for a coefficient out of range, PE_NO_MEMORY. */
pe_status pe_material_create(pe_world *world, double friction, double restitution,
                             pe_material_id *material, pe_error *error);

/* Sets both coefficients for one unordered pair of materials, which may be equal; also for bodies
 * in contact now. PE_BAD_ARGUMENT for an unknown material or a coefficient out of range. */
pe_status pe_world_set_pair(pe_world *world, pe_material_id a, pe_material_id b, double friction,
                            double restitution, pe_error *error);

/* ---- Bodies ---- */

/* The kinds of shapes. */
typedef enum pe_shape_kind {
    PE_SHAPE_PLANE,    /* the boundary of a solid half-space; static bodies only */
    PE_SHAPE_SPHERE,   /* about its origin */
    PE_SHAPE_BOX,      /* about its origin, along its axes */
    PE_SHAPE_CAPSULE,  /* around the segment from -half_height to half_height on its z axis */
    PE_SHAPE_CYLINDER, /* about its z axis, capped at -half_height and half_height */
    PE_SHAPE_HULL,     /* a convex polyhedron */
    PE_SHAPE_MESH,     /* a solid bounded by triangles, of any form; it may move */
    PE_SHAPE_COUNT     /* how many kinds there are */
} pe_shape_kind;

/* Names a geometry of one world. */
typedef struct pe_geometry_id {
    uint32_t index; /* from 1; 0 is null */
} pe_geometry_id;

/* A shape; only the fields of its kind are read. */
typedef struct pe_shape {
    pe_shape_kind kind;      /* says which of the other fields count */
    pe_vec3 normal;          /* plane: unit, out of the solid half-space {x : n.x <= offset} */
    double offset;           /* plane: m */
    double radius;           /* sphere, capsule, cylinder: m */
    double half_height;      /* capsule, cylinder: m */
    pe_vec3 half_extents;    /* box: m */
    pe_geometry_id geometry; /* hull, mesh: of the same world */
} pe_shape;

/* The solid of a hull or a mesh, as closed surfaces of triangles in a frame of the caller's. */
typedef struct pe_geometry_def {
    const pe_vec3 *vertices;        /* (vertex_count), m */
    const uint32_t (*triangles)[3]; /* (triangle_count): counter-clockwise seen from outside */
    int vertex_count;               /* at least 4 */
    int triangle_count;             /* at least 4 */
    bool convex;                    /* for hulls: the solid must be convex */
} pe_geometry_def;

/* Copies a geometry into the world, where it stays until the world is destroyed; any number of
 * bodies may have it. PE_BAD_ARGUMENT says where a surface is open, inside out, without area or,
 * with `convex`, not convex. Whether surfaces cross each other is not checked. Mass properties are
 * the exact integrals over the polyhedron. */
pe_status pe_geometry_create(pe_world *world, const pe_geometry_def *def, pe_geometry_id *geometry,
                             pe_error *error);

/* The mass properties of a geometry of uniform density. */
typedef struct pe_geometry_frame {
    double volume;       /* m^3 */
    pe_vec3 centre;      /* of mass, in the frame of the vertices */
    pe_quat orientation; /* principal axes to the frame of the vertices */
    pe_vec3 inertia;     /* principal, of 1 kg, about the centre, m^2 */
} pe_geometry_frame;

/* Reads the mass properties of a geometry. PE_BAD_ARGUMENT for an unknown one. */
pe_status pe_geometry_get_frame(const pe_world *world, pe_geometry_id geometry,
                                pe_geometry_frame *frame, pe_error *error);

/* Names a body of one world. */
typedef struct pe_body_id {
    uint32_t index;      /* from 1; 0 is null; that of a destroyed body is used again */
    uint32_t generation; /* differs between bodies that had the same index one after the other */
} pe_body_id;

/* A body to be created. */
typedef struct pe_body_def {
    pe_shape shape;          /* copied */
    bool is_static;          /* never moves; a plane must be static */
    pe_material_id material; /* null: friction 0.5, restitution 0 */
    double mass;             /* kg, > 0 unless static */
    pe_vec3 inertia;         /* kg m^2, principal, in the principal axes; zero: from the shape */

    /* Position and orientation are those of the shape's frame: the frame of the vertices for a hull
     * or mesh, else the centre of mass and the principal axes. They are not used by a plane. */
    pe_vec3 position;         /* m, world */
    pe_quat orientation;      /* shape's frame to world */
    pe_vec3 velocity;         /* m/s, world, of the centre of mass; not of a static body */
    pe_vec3 angular_velocity; /* rad/s, world; not of a static body */
} pe_body_def;

/* A dynamic sphere of radius 0.5 m and 1 kg at the origin, at rest. */
pe_body_def pe_body_def_default(void);

/* Creates a body; *body is null on failure. Bodies that are created in the same order get the same
 * ids and the same results. PE_BAD_ARGUMENT for a number out of range, a quaternion that is not
 * unit within 1e-6, or an unknown material or geometry; PE_NO_MEMORY. */
pe_status pe_body_create(pe_world *world, const pe_body_def *def, pe_body_id *body,
                         pe_error *error);

/* Destroys a body, and its contacts. PE_BAD_ARGUMENT if it is not alive. */
pe_status pe_body_destroy(pe_world *world, pe_body_id body, pe_error *error);

/* Where a body is and how it moves. */
typedef struct pe_body_state {
    pe_vec3 position;         /* m, world, of the shape's frame, as in pe_body_def */
    pe_quat orientation;      /* shape's frame to world */
    pe_vec3 velocity;         /* m/s, world, of the centre of mass */
    pe_vec3 angular_velocity; /* rad/s, world */
} pe_body_state;

/* Reads the state of a body. PE_BAD_ARGUMENT if it is not alive. */
pe_status pe_body_get_state(const pe_world *world, pe_body_id body, pe_body_state *state,
                            pe_error *error);

/* Sets the state of a body; of a static one only position and orientation. The next step finds all
 * contacts again. Where the same features still touch they keep their impulses, from which the
 * solver starts. Forces applied for the next step stay. PE_BAD_ARGUMENT if the body is not alive,
 * a number is not finite or the quaternion is not unit within 1e-6. */
pe_status pe_body_set_state(pe_world *world, pe_body_id body, const pe_body_state *state,
                            pe_error *error);

/* Reads the mass, in kg, and the principal inertia about the centre of mass, in kg m^2, in the
 * body's principal axes. Both are zero for a static body. PE_BAD_ARGUMENT if it is not alive. */
pe_status pe_body_get_mass(const pe_world *world, pe_body_id body, double *mass, pe_vec3 *inertia,
                           pe_error *error);

/* Reads the friction and restitution of a contact between two bodies. PE_BAD_ARGUMENT if one of
 * them is not alive. */
pe_status pe_body_get_pair(const pe_world *world, pe_body_id a, pe_body_id b, double *friction,
                           double *restitution, pe_error *error);

/* The axes that a force is given in. */
typedef enum pe_frame {
    PE_FRAME_WORLD, /* those of the world */
    PE_FRAME_BODY   /* those of the shape's frame, which rotate with the body */
} pe_frame;

/* Adds a force, in N, that acts during the next step only, at an offset from the centre of mass, in
 * m. In the body's frame both rotate with the body during the step; in the world's they stay. It
 * has no effect on a static body. PE_BAD_ARGUMENT if the body is not alive or a number is not
 * finite; PE_NO_MEMORY. */
pe_status pe_body_apply_force(pe_world *world, pe_body_id body, pe_vec3 force, pe_vec3 offset,
                              pe_frame frame, pe_error *error);

/* ---- Step ---- */

/* How an island's contact problem was solved. */
typedef enum pe_path {
    PE_PATH_NONE,   /* there was none */
    PE_PATH_WARM,   /* the last step's impulses were good enough */
    PE_PATH_DIRECT, /* to the tolerance: Newton and interior point iterations, rarely sweeps */
    PE_PATH_SWEEPS, /* above the tolerance: sweeps, or a direct solver that stopped short of it */
    PE_PATH_SOFT,   /* sub-steps of soft contact, which have no residual */
    PE_PATH_COUNT   /* how many paths there are */
} pe_path;

/* Why a solver stopped. */
typedef enum pe_solve_stop {
    PE_STOP_CONVERGED,  /* the residual is within the tolerance */
    PE_STOP_ITERATIONS, /* the bound on iterations was reached */
    PE_STOP_STALLED     /* the residual did not decrease further */
} pe_solve_stop;

enum { PE_HISTORY = 32 }; /* residuals in pe_step_stats */

/* What one step did. Times are wall-clock seconds; impacts within the step count as solving. */
typedef struct pe_step_stats {
    int iterations;  /* factorisations and sweeps, largest over islands; 0 when every warm start was
                        good enough */
    double residual; /* m/s, natural map, largest over the solved contacts */
    double residual_rms;                /* m/s, over the same */
    double factor_flops;                /* of all factorisations */
    int unconverged_islands;            /* whose residual is above the tolerance */
    int islands;                        /* groups of dynamic bodies with contacts */
    int islands_by_path[PE_PATH_COUNT]; /* how many were solved in each way */
    int manifolds;                      /* groups of contact points with one normal */
    int contacts;                       /* points of touching or nearly touching pairs */

    /* Of the island with the largest residual: */
    pe_path path;               /* how it was solved */
    pe_solve_stop stop;         /* why the solver stopped */
    int history_count;          /* of history, PE_HISTORY at most */
    double history[PE_HISTORY]; /* (history_count): m/s, residuals as the solver went */

    int projection_rounds;     /* rounds of position correction */
    int projection_iterations; /* of position correction, largest over islands and rounds */
    double penetration;        /* m, deepest after the bodies have moved */
    double penetration_left;   /* m, deepest after position correction */
    int overlapping; /* bodies that overlap others by more than a twentieth of the smaller one's
                        least extent after the step: a step parts them by a fifth of it at most */
    int unparted;    /* those of them that the last attempt did not part: they stay, and are tried
                        again after 1, 2, 4, up to 64 steps */
    int guarded_islands; /* groups of touching bodies from which energy was taken that they had
                                 gained from numerical errors */
    int sleeping;        /* bodies that are asleep after the step */
    double sleep_drift;  /* m: the farthest that a body which woke in the step would have moved, had
                                 it kept the speed with which it fell asleep */
    double time_broad_phase;  /* s: pairs of bodies that are near each other */
    double time_narrow_phase; /* s: contact points of these pairs */
    double time_contacts;     /* s: impulses taken over from the last step */
    double time_islands;      /* s: islands of the contacts */
    double time_solve;        /* s: contact problems, and the motion of bodies with contacts */
    double time_integrate;    /* s: the motion of bodies without contacts */
    double time_project;      /* s: position correction and energy */
} pe_step_stats;

/* Advances the world by dt, in s: islands, contact problems, motion; then the contacts at the new
 * poses and position correction, so that the state that is read afterwards is the corrected one.
 * `stats` may be NULL. PE_BAD_ARGUMENT for a dt out of range; PE_NO_MEMORY; PE_NOT_FINITE, naming
 * the body and the number, if a state would not stay finite and within 1e15 m, 1e30 m/s and rad/s,
 * which also drops the forces that were applied. Then no body has moved, and the world can be used
 * as before. After some steps of a scene that does not grow no memory is allocated, unless one of several
 * threads gets a larger share of the work than ever before. */
pe_status pe_world_step(pe_world *world, double dt, pe_step_stats *stats, pe_error *error);

/* Where a contact is, seen from its bodies: world axes. */
typedef struct pe_contact_place {
    pe_vec3 arm_a;  /* m, from the centre of mass of A to the point */
    pe_vec3 arm_b;  /* m, from the centre of mass of B to the point */
    pe_vec3 normal; /* unit, from A to B */
} pe_contact_place;

/* One contact point of the last step, over the interval in which its impulse acted. That is the
 * whole step, or a sub-step of an island that took its impacts at their own time. Such a point is
 * listed once for each sub-step in which it could push, and once for each impact. */
typedef struct pe_contact {
    pe_body_id body_a; /* A */
    pe_body_id body_b; /* B */
    pe_vec3 point;     /* m, world, where it was when the impulse acted; if that was over the whole
                          step, where the bodies had it at the start of the step */
    pe_vec3 normal;    /* unit, world, from A to B */
    double separation; /* m, at the start of the interval; negative in penetration */
    pe_vec3 impulse;   /* N s, world, on B, summed over the interval */
    double begin;      /* s since the start of the step */
    double end;        /* s; equal to begin: an impact, in an instant */
    int order; /* of the solves of a body within the step: those of lower order acted before */
    pe_contact_place acts; /* where the impulse acted */

    /* Where the contact law holds for the velocities at the interval's end: the same place, or, if
     * the impulse acted at the middle of the interval, where the contact was at its end. */
    pe_contact_place holds;
} pe_contact;

/* Copies up to `capacity` contact points of the last step, none after a step that failed, and returns
 * how many there are. They are in a fixed order, in which the `order` of the contacts of a dynamic body
 * never decreases. `contacts` may be NULL when the capacity is 0. */
int pe_world_get_contacts(const pe_world *world, pe_contact *contacts, int capacity);

/* The largest number of manifolds that the solver's kernels take at once on this processor: 8 by
 * AVX-512, 4 by AVX2, or 1. The bits are the same for any. */
int pe_kernel_lanes(void);

#ifdef __cplusplus
}
#endif
#endif
