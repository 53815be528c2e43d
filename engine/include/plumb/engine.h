/* Plumb's rigid-body engine: the public interface.
 *
 * SI units, right-handed. Quaternions are (w, x, y, z), unit, body to world. Velocities are those
 * of the centre of mass, angular velocities are in the world frame. Normals point from body A to
 * body B; separation is negative in penetration; impulses are in N s, on B.
 *
 * One world holds everything; there is no other state. Worlds are independent of each other, and
 * one world is used by one thread at a time. The same calls give the same bits, over runs,
 * compilers and optimisation levels. Nothing here prints or exits: a function that can fail returns
 * a status and fills the optional pe_error. How well the solver did is no error: it is in
 * pe_step_stats. */
#ifndef PLUMB_ENGINE_H
#define PLUMB_ENGINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pe_vec3 {
    double x, y, z;
} pe_vec3;

typedef struct pe_quat {
    double w, x, y, z;
} pe_quat;

typedef enum pe_status {
    PE_OK = 0,
    PE_BAD_ARGUMENT, /* a number is out of range, or an id is not of a living object */
    PE_NO_MEMORY
} pe_status;

typedef struct pe_error {
    pe_status status;
    char message[256]; /* what, the number found, what was expected */
} pe_error;

/* Where a world gets its memory. `allocate` returns `size` bytes aligned to 64, or NULL. */
typedef struct pe_allocator {
    void *(*allocate)(void *context, size_t size);
    void (*release)(void *context, void *memory); /* NULL is not passed */
    void *context;
} pe_allocator;

/* ---- World
 * ---------------------------------------------------------------------------------------- */

typedef struct pe_world pe_world;

typedef enum pe_profile {
    /* Chooses for each contact island by predicted cost: what stands or slides is solved directly,
     * to the tolerance; what moves so much that this would cost more is swept with momentum.
     * Positions are mended after the step, in two rounds at most. */
    PE_PROFILE_DEFAULT,
    /* The same choice, with twice the sweeps to a quarter of the residual, and up to eight rounds
     * of pushing out penetration. */
    PE_PROFILE_ACCURATE,
    /* Substepped soft contact for what moves; what hardly moves and is cheap to solve directly is.
     */
    PE_PROFILE_FAST
} pe_profile;

typedef struct pe_world_def {
    pe_vec3 gravity; /* m/s^2 */
    pe_profile profile;

    /* A contact problem counts as solved when the largest natural-map residual over its contacts is
     * below this, in m/s. One step of gravity at 60 Hz is 0.16 m/s. */
    double tolerance;

    /* Bound on the work of sweeping one island in one step, in contact points visited (sweeps x
     * points); every island gets 50 sweeps if it needs them. */
    double max_contact_updates;

    /* Bound on the iterations of one island in one step, of whatever solver: Newton steps and
     * sweeps together. A smaller one saves time where it leaves an error. */
    int max_iterations;

    /* Approach slower than this, in m/s, does not bounce. 0: restitution holds at every speed. */
    double restitution_threshold;

    /* An island of this many bodies or fewer takes its impacts at their own time within the step,
     * one after the other, but in the fast profile. In a larger one, and everywhere at 0, an impact
     * acts at the step's start, over the gap. */
    int impact_bodies;

    /* Gap, in m, below which two bodies at rest relative to each other get a contact. Motion within
     * the step is added to it, so that fast bodies meet what they would pass. */
    double contact_margin;

    /* Penetration, in m, that is left alone in an island that is swept. Deeper ones are pushed out
     * after the step by moving bodies, without touching velocities. What is solved directly keeps
     * none. */
    double penetration_slop;

    pe_allocator allocator; /* all NULL: aligned_alloc and free */
} pe_world_def;

/* Gravity (0, 0, -9.81), tolerance 1e-8 m/s, and bounds fit for metre-sized bodies. */
pe_world_def pe_world_def_default(void);

/* The caller destroys *world. */
pe_status pe_world_create(const pe_world_def *def, pe_world **world, pe_error *error);
void pe_world_destroy(pe_world *world); /* NULL allowed */

/* ---- Materials
 * ------------------------------------------------------------------------------------ */

typedef struct pe_material_id {
    uint32_t index; /* from 1; 0 is null */
} pe_material_id;

/* Friction (Coulomb, >= 0) and restitution (Newton, 0 .. 1) of the material against itself. Against
 * another: the geometric mean of the frictions, the larger restitution, until pe_world_set_pair. */
pe_status pe_material_create(pe_world *world, double friction, double restitution,
                             pe_material_id *material, pe_error *error);

/* Sets both for one unordered pair of materials (which may be equal). */
pe_status pe_world_set_pair(pe_world *world, pe_material_id a, pe_material_id b, double friction,
                            double restitution, pe_error *error);

/* ---- Bodies
 * --------------------------------------------------------------------------------------- */

typedef enum pe_shape_kind {
    PE_SHAPE_PLANE,
    PE_SHAPE_SPHERE,
    PE_SHAPE_BOX,
    PE_SHAPE_CAPSULE,  /* around the segment from -half_height to half_height on its z axis */
    PE_SHAPE_CYLINDER, /* about its z axis, capped at -half_height and half_height */
    PE_SHAPE_HULL,     /* a convex polyhedron */
    PE_SHAPE_MESH,     /* a solid bounded by triangles, of any form; it may move */
    PE_SHAPE_COUNT
} pe_shape_kind;

typedef struct pe_geometry_id {
    uint32_t index; /* from 1; 0 is null */
} pe_geometry_id;

typedef struct pe_shape {
    pe_shape_kind kind;
    pe_vec3 normal;          /* plane: unit, out of the solid half-space {x : n.x <= offset} */
    double offset;           /* plane: m */
    double radius;           /* sphere, capsule, cylinder: m */
    double half_height;      /* capsule, cylinder: m */
    pe_vec3 half_extents;    /* box: m */
    pe_geometry_id geometry; /* hull, mesh */
} pe_shape;

/* The solid of a hull or a mesh, as closed surfaces of triangles in a frame of the caller's. */
typedef struct pe_geometry_def {
    const pe_vec3 *vertices;        /* (vertex_count), m */
    const uint32_t (*triangles)[3]; /* (triangle_count): counter-clockwise seen from outside */
    int vertex_count, triangle_count;
    bool convex; /* for hulls: the solid must be convex */
} pe_geometry_def;

/* Copies the geometry into the world, where it stays until the world is destroyed; any number of
 * bodies may have it. PE_BAD_ARGUMENT says where a surface is open, inside out, without area or,
 * if it is to be, not convex. That surfaces do not cross is not checked. Mass properties are the
 * exact integrals over the polyhedron. */
pe_status pe_geometry_create(pe_world *world, const pe_geometry_def *def, pe_geometry_id *geometry,
                             pe_error *error);

typedef struct pe_geometry_frame {
    double volume;       /* m^3 */
    pe_vec3 centre;      /* of mass, in the frame of the vertices */
    pe_quat orientation; /* principal axes to the frame of the vertices */
    pe_vec3 inertia;     /* principal, of 1 kg, about the centre, m^2 */
} pe_geometry_frame;

pe_status pe_geometry_get_frame(const pe_world *world, pe_geometry_id geometry,
                                pe_geometry_frame *frame, pe_error *error);

typedef struct pe_body_id {
    uint32_t index;      /* from 1; 0 is null */
    uint32_t generation; /* tells a reused index from the body that had it before */
} pe_body_id;

typedef struct pe_body_def {
    pe_shape shape;
    bool is_static;          /* never moves; a plane must be static */
    pe_material_id material; /* null: friction 0.5, restitution 0 */
    double mass;             /* kg, > 0 unless static */
    pe_vec3 inertia;         /* kg m^2, principal, in the principal axes; zero: from the shape */
    /* Of the shape's frame: that of a hull's or mesh's vertices; else its centre of mass and its
     * principal axes. Not used by a plane. */
    pe_vec3 position; /* m */
    pe_quat orientation;
    pe_vec3 velocity;
    pe_vec3 angular_velocity;
} pe_body_def;

/* A dynamic sphere of radius 0.5 m and 1 kg at the origin, at rest. */
pe_body_def pe_body_def_default(void);

pe_status pe_body_create(pe_world *world, const pe_body_def *def, pe_body_id *body,
                         pe_error *error);
pe_status pe_body_destroy(pe_world *world, pe_body_id body, pe_error *error);

typedef struct pe_body_state {
    pe_vec3 position; /* of the shape's frame, as in pe_body_def */
    pe_quat orientation;
    pe_vec3 velocity; /* of the centre of mass */
    pe_vec3 angular_velocity;
} pe_body_state;

pe_status pe_body_get_state(const pe_world *world, pe_body_id body, pe_body_state *state,
                            pe_error *error);
pe_status pe_body_set_state(pe_world *world, pe_body_id body, const pe_body_state *state,
                            pe_error *error);

/* Mass in kg and principal inertia in kg m^2, as the engine uses them; zero for a static body. */
pe_status pe_body_get_mass(const pe_world *world, pe_body_id body, double *mass, pe_vec3 *inertia,
                           pe_error *error);

/* Friction and restitution of a contact between these two. */
pe_status pe_body_get_pair(const pe_world *world, pe_body_id a, pe_body_id b, double *friction,
                           double *restitution, pe_error *error);

typedef enum pe_frame { PE_FRAME_WORLD, PE_FRAME_BODY } pe_frame;

/* Adds a force, in N, for the next step only, at an offset from the centre of mass, in m. In the
 * body's frame both are in the axes of the shape's frame and turn with the body during the step; in
 * the world's they stay. No effect on a static body. */
pe_status pe_body_apply_force(pe_world *world, pe_body_id body, pe_vec3 force, pe_vec3 offset,
                              pe_frame frame, pe_error *error);

void pe_world_get_gravity(const pe_world *world, pe_vec3 *gravity);

/* ---- Step
 * ----------------------------------------------------------------------------------------- */

/* How an island's contact problem was solved. */
typedef enum pe_path {
    PE_PATH_NONE,   /* there was none */
    PE_PATH_WARM,   /* the last step's impulses were good enough */
    PE_PATH_DIRECT, /* Newton and interior point iterations on a factor in body space */
    PE_PATH_SWEEPS, /* sweeps with momentum */
    PE_PATH_SOFT,   /* substeps of soft contact: it has no residual */
    PE_PATH_COUNT
} pe_path;

/* Why a solver stopped. */
typedef enum pe_solve_stop {
    PE_STOP_CONVERGED,
    PE_STOP_ITERATIONS, /* the bound was met */
    PE_STOP_STALLED     /* no further decrease */
} pe_solve_stop;

enum { PE_HISTORY = 32 };

/* What one step did. Times are wall-clock seconds by phase. */
typedef struct pe_step_stats {
    int iterations;  /* factorisations or sweeps, largest over islands; 0 when every warm start was
                        good enough */
    double residual; /* m/s, natural map, largest over all contacts that have one */
    double residual_rms;     /* m/s, over the same */
    double factor_flops;     /* of all factorisations */
    int unconverged_islands; /* whose residual is above the tolerance */
    int islands;             /* with at least one contact */
    int islands_by_path[PE_PATH_COUNT];
    int manifolds, contacts; /* touching or nearly touching pairs, and their points */

    /* Of the island with the largest residual: */
    pe_path path;
    pe_solve_stop stop;
    int history_count; /* residuals as the solver went, the first PE_HISTORY at most */
    double history[PE_HISTORY];

    int projection_rounds, projection_iterations; /* iterations: largest over islands and rounds */
    double penetration;                           /* m, deepest after the bodies have moved */
    double penetration_left;                      /* m, deepest after the projection */
    int guarded_islands; /* whose energy would have grown: see the head of energy_guard.h */
    double time_broad_phase, time_narrow_phase, time_contacts, time_islands, time_solve,
        time_integrate, time_project;
} pe_step_stats;

/* Advances by dt seconds: islands, solve, move; then the contacts at the new poses and the
 * projection, so that the frame that is seen is the one that was mended.
 * On failure no body has moved. `stats` may be NULL. After some steps of a scene that does not
 * grow, no memory is allocated. */
pe_status pe_world_step(pe_world *world, double dt, pe_step_stats *stats, pe_error *error);

/* One contact point of the last step. */
typedef struct pe_contact {
    pe_body_id body_a, body_b;
    pe_vec3 point;     /* world, m, at the start of the step */
    pe_vec3 normal;    /* unit, from A to B */
    double separation; /* m, at the start of the step */
    pe_vec3 impulse;   /* on B over the step, world, N s */
} pe_contact;

/* Copies up to `capacity` contacts, in a fixed order, and returns how many there are. */
int pe_world_get_contacts(const pe_world *world, pe_contact *contacts, int capacity);

#ifdef __cplusplus
}
#endif
#endif
