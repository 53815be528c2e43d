/* A world's data: bodies, materials, geometries and contacts. */
#ifndef PE_WORLD_H
#define PE_WORLD_H

#include "base/memory.h"
#include "base/pool.h"
#include "base/vec3.h"
#include "geometry.h"

#include <string.h>

/* Body slots start at 1: slot 0 is a static dummy. So an id's index is its slot, and 0 is null. */

/* Where a body is. The axes are the principal ones through the centre of mass, which for a hull or
 * mesh are not those of its vertices: see geometry.h. */
typedef struct pe_pose {
    pe_vec3 position;    /* m, world, of the centre of mass */
    pe_quat orientation; /* body's axes to world */
    pe_mat3 rotation;    /* of the orientation */
} pe_pose;

/* A pose that is kept for later: the rotation follows from the orientation. */
typedef struct pe_saved_pose {
    pe_vec3 position;
    pe_quat orientation;
} pe_saved_pose;

/* Saves a pose. */
static inline pe_saved_pose pe_pose_save(const pe_pose *pose)
{
    return (pe_saved_pose){pose->position, pose->orientation};
}

/* The pose that was saved, with the same bits. */
static inline pe_pose pe_pose_restore(const pe_saved_pose *saved)
{
    return (pe_pose){saved->position, saved->orientation, pe_matrix_of(saved->orientation)};
}

/* The velocity of a body. */
typedef struct pe_twist {
    pe_vec3 velocity, angular_velocity; /* m/s and rad/s, world, of the centre of mass */
} pe_twist;

/* Mass, in kg, and inertia, in kg m^2. */
typedef struct pe_mass {
    double mass, inverse_mass; /* 0 when static */
    pe_vec3 inertia;           /* principal, in the body's axes; 0 when static */
    bool spherical;            /* equal principal inertia: no gyroscopic torque */
} pe_mass;

/* What does not change while a body lives. */
typedef struct pe_body {
    pe_shape shape;
    const pe_geometry *geometry; /* of a hull or mesh, the world's; else NULL */
    double bounding_radius;      /* about the position; 0 for a plane, which has no bound */
    double size;  /* least half extent or radius: the scale of geometric tolerances */
    int material; /* index of material_pair_array; 0 is the default material */
    uint32_t generation;
    bool alive, is_static;
    int next_free; /* slot of the next free one, 0 ends the list */
} pe_body;

enum { PE_MOST_PAUSE = 64 };

/* Work that failed and is not tried again for a while: for twice as many steps each time, up to
 * PE_MOST_PAUSE. */
typedef struct pe_backoff {
    uint8_t wait;  /* steps left */
    uint8_t pause; /* steps that the last wait took; 0: it did not fail last */
} pe_backoff;

/* Solves in a row that were to make an island stop. */
typedef struct pe_stopping {
    pe_backoff backoff;
    uint8_t tries; /* since it last waited */
} pe_stopping;

/* What earlier steps found out about the island of a body, by which later ones save work. */
typedef struct pe_record {
    double residual, rms;  /* m/s: what the last solve left */
    double slow_time;      /* s: how long the island has been slow enough to sleep */
    pe_backoff correction; /* exact position correction, which was taken back */
    pe_backoff direct;     /* the direct solver */
    pe_backoff settling;   /* sweeps at rest, which gained nothing */
    pe_backoff parting;    /* overlap, which was not parted */
    pe_backoff parts;      /* steps in parts, which had to be joined */
    pe_stopping stopping;  /* to make an island rest that hardly moves */
    bool put_back;         /* the energy guard put the island back, which had been at rest */
} pe_record;

/* Forces, in N, and torques, in N m, that are applied in the next step. */
typedef struct pe_applied_force {
    pe_vec3 force, torque;           /* world, for the next step */
    pe_vec3 body_force, body_torque; /* in the body's axes, rotating with it */
    bool rotates;                    /* the latter are not zero */
    pe_vec3
        acceleration; /* rad/s^2, world, mean of the last step, if forces rotated in it; else 0 */
} pe_applied_force;

/* Coefficients of a contact between two materials. */
typedef struct pe_material_pair {
    double friction, restitution;
} pe_material_pair;

/* The relative pose of a pair when its manifold was built, by which the manifold is kept or not. */
typedef struct pe_built {
    pe_vec3 position;                /* of the smaller body in the axes of the larger one */
    pe_quat orientation;             /* of the smaller body relative to the larger one */
    pe_vec3 normal;                  /* in the axes of the body that it rotates with */
    double least_margin, end_margin; /* m: the same points at every margin in [least, end) */
    bool normal_on_b;                /* that body is b */
} pe_built;

/* A contact manifold: points first .. first + count - 1 of a touching or nearly touching pair,
 * which share a normal. */
typedef struct pe_manifold {
    int a, b;       /* slots, a < b */
    pe_vec3 normal; /* unit, from a to b */
    int first, count;
    double least_separation; /* m, of its points */
    double friction, restitution;
    bool apart; /* its impulses of the step are in world->apart */
    bool kept;  /* its points are those of the list before, transported by the bodies */
    pe_built built;
} pe_manifold;

/* A contact point. */
typedef struct pe_manifold_point {
    pe_vec3 position;           /* m, world, halfway between the two surfaces, when it was found */
    pe_vec3 anchor_a, anchor_b; /* the same point on either surface, in that body's axes */
    double separation;          /* m, when it was found */
    uint64_t feature;           /* id of the features that touch: the same from step to step */
    pe_vec3 impulse;            /* N s, on b, world */
} pe_manifold_point;

enum {
    PE_MAX_POINTS = 8,    /* of a manifold */
    PE_MAX_MANIFOLDS = 16 /* manifolds of a pair */
};

/* The contacts of one step, sorted by (a, b). The points of a pair are contiguous. */
typedef struct pe_contacts {
    pe_array manifold_array, point_array;
    int manifold_count, point_count;
} pe_contacts;

/* Bodies of a piece, in loops over all bodies on the threads of the world (pe_pool_run). */
enum { PE_BODY_GRAIN = 512 };

/* Bodies, geometries and materials, and what the phases keep from step to step. */
struct pe_world {
    pe_world_def def;
    pe_allocator allocator;

    pe_array body_array, pose_array, twist_array, mass_array, applied_force_array, record_array;
    pe_array start_pose_array; /* (slots of then) pe_saved_pose: at the start of the last step */
    int applied_force_count; /* slots that applied_force_array has; nothing is applied to others */
    bool has_applied_forces; /* since the last step */
    int slot_count;          /* slots in use or free, the dummy included */
    int first_free;

    pe_array geometry_array; /* (geometry_count) pointers to pe_geometry */
    int geometry_count;

    pe_array material_pair_array; /* (material_count x material_count), row-major */
    int material_count;

    /* What the phases of the step keep from step to step; pe_world_create makes them. */
    struct pe_broad *broad;
    struct pe_pattern_store *patterns;
    struct pe_rest *rest;
    bool bodies_changed; /* a body was created or destroyed since the broad phase last looked */

    /* `contacts` are those at the poses now, to be solved next, with the impulses of the warm
     * start. `solved` are those of the last step with the impulses that it found. `previous` is the
     * list that was replaced last. */
    pe_contacts contacts, previous, solved;
    /* `contacts` and `previous` of the island that takes sub-steps (impact.c). */
    pe_contacts substep_contacts, substep_previous;
    /* (apart_count) pe_contact: the points of the last step that did not act over the whole step at
     * its start. */
    pe_array apart_array;
    int apart_count;
    double previous_dt;
    bool contacts_stale; /* bodies or materials were changed since `contacts` were found */

    pe_arena arena;
    pe_pool *pool;   /* the threads of a step */
    pe_world *views; /* (threads): see view.h; NULL: one thread */
};

/* The arrays of bodies, by slot. */
static inline pe_body *pe_bodies(const pe_world *world)
{
    return world->body_array.items;
}

static inline pe_pose *pe_poses(const pe_world *world)
{
    return world->pose_array.items;
}

static inline pe_twist *pe_twists(const pe_world *world)
{
    return world->twist_array.items;
}

static inline pe_mass *pe_masses(const pe_world *world)
{
    return world->mass_array.items;
}

/* What is applied to a body. */
static inline const pe_applied_force *pe_applied_force_of(const pe_world *world, int slot)
{
    static const pe_applied_force none = {.rotates = false};
    return slot < world->applied_force_count
               ? (const pe_applied_force *)world->applied_force_array.items + slot
               : &none;
}

static inline pe_record *pe_records(const pe_world *world)
{
    return world->record_array.items;
}

/* Notes that the work failed, after a last pause of `pause` steps, or that it succeeded. */
static inline pe_backoff pe_backoff_after(bool failed, int pause)
{
    int longer = pause == 0 ? 1 : 2 * pause, next = !failed ? 0 : longer;
    next = next < PE_MOST_PAUSE ? next : PE_MOST_PAUSE;
    return (pe_backoff){(uint8_t)next, (uint8_t)next};
}

/* One step less to wait. */
static inline pe_backoff pe_backoff_less(pe_backoff b)
{
    return (pe_backoff){(uint8_t)(b.wait > 0 ? b.wait - 1 : 0), b.pause};
}

/* The longer waits of two. */
static inline pe_backoff pe_backoff_longer(pe_backoff a, pe_backoff b)
{
    return (pe_backoff){a.wait > b.wait ? a.wait : b.wait, a.pause > b.pause ? a.pause : b.pause};
}

/* The manifolds and points of a list. */
static inline pe_manifold *pe_manifolds(const pe_contacts *contacts)
{
    return contacts->manifold_array.items;
}

static inline pe_manifold_point *pe_manifold_points(const pe_contacts *contacts)
{
    return contacts->point_array.items;
}

/* Frees the memory of a list. */
static inline void pe_contacts_free(pe_contacts *contacts, const pe_allocator *allocator)
{
    pe_array_free(&contacts->manifold_array, allocator);
    pe_array_free(&contacts->point_array, allocator);
}

/* Frees a list, the contents of which are of no more use, if it is far longer than `needed` manifolds. */
static inline void pe_contacts_trim(pe_contacts *contacts, int needed,
                                    const pe_allocator *allocator)
{
    enum { SPARE = 4, SHORT = 1024 };
    if (contacts->manifold_array.capacity > SPARE * (size_t)needed + SHORT) {
        pe_contacts_free(contacts, allocator);
        contacts->manifold_count = contacts->point_count = 0;
    }
}

/* Exchanges two lists. */
static inline void pe_contacts_swap(pe_contacts *a, pe_contacts *b)
{
    pe_contacts c = *a;
    *a = *b;
    *b = c;
}

/* A walk over the points of a list of contacts, manifold by manifold. */
typedef struct pe_point_walk {
    const pe_contacts *contacts;
    const int *listed; /* (count): the manifolds to visit; NULL: the first `count` */
    int count;
    int next_manifold, next_point;
    pe_manifold *manifold; /* where the walk is */
    pe_manifold_point *point;
} pe_point_walk;

/* A walk over all points. */
static inline pe_point_walk pe_walk_points(const pe_contacts *contacts)
{
    return (pe_point_walk){.contacts = contacts, .count = contacts->manifold_count};
}

/* Moves on to the next point; false at the end. */
static inline bool pe_next_point(pe_point_walk *walk)
{
    for (; walk->next_manifold < walk->count; ++walk->next_manifold) {
        int i = walk->listed != NULL ? walk->listed[walk->next_manifold] : walk->next_manifold;
        walk->manifold = &pe_manifolds(walk->contacts)[i];
        if (walk->next_point < walk->manifold->count) {
            int j = walk->manifold->first + walk->next_point++;
            walk->point = &pe_manifold_points(walk->contacts)[j];
            return true;
        }
        walk->next_point = 0;
    }
    return false;
}

/* Speed, in m/s, at which the gap of a point opens, at these velocities of its bodies. */
static inline double pe_opening_speed(const pe_world *world, const pe_manifold *m,
                                      const pe_manifold_point *point, const pe_twist *of_a,
                                      const pe_twist *of_b)
{
    pe_vec3 ra = pe_sub(point->position, pe_poses(world)[m->a].position);
    pe_vec3 rb = pe_sub(point->position, pe_poses(world)[m->b].position);
    pe_vec3 va = pe_add(of_a->velocity, pe_cross(of_a->angular_velocity, ra));
    pe_vec3 vb = pe_add(of_b->velocity, pe_cross(of_b->angular_velocity, rb));
    return pe_dot(m->normal, pe_sub(vb, va));
}

/* Whether the body does not move at all. */
static inline bool pe_is_still(const pe_twist *twist)
{
    return pe_dot(twist->velocity, twist->velocity) == 0 &&
           pe_dot(twist->angular_velocity, twist->angular_velocity) == 0;
}

/* Whether a torque acts on the body. */
static inline bool pe_has_torque(const pe_applied_force *applied)
{
    return pe_dot(applied->torque, applied->torque) > 0 ||
           pe_dot(applied->body_torque, applied->body_torque) > 0;
}

/* Friction and restitution of two materials, by index. */
static inline pe_material_pair *pe_material_pair_of(const pe_world *world, int a, int b)
{
    return (pe_material_pair *)world->material_pair_array.items +
           (size_t)a * (size_t)world->material_count + b;
}

/* The step's arena, and the threads of the world, as a workspace. */
static inline pe_workspace pe_step_memory(pe_world *world)
{
    return (pe_workspace){&world->arena, &world->allocator, world->pool};
}

/* Memory from the step's arena, as pe_arena_take. */
static inline void *pe_scratch(pe_world *world, size_t count, size_t stride)
{
    return pe_arena_take(&world->arena, &world->allocator, count, stride);
}

/* The same, filled with zeros. */
static inline void *pe_scratch_zero(pe_world *world, size_t count, size_t stride)
{
    void *memory = pe_scratch(world, count, stride);
    return memory != NULL ? memset(memory, 0, count * stride) : NULL;
}

/* Whether the step's arena has refused a request in this step. */
static inline bool pe_scratch_failed(const pe_world *world)
{
    return world->arena.failed;
}

#endif
