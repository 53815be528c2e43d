/* Islands at rest: bodies that a step would leave as they are, with their contacts. They are kept apart
 * from the lists that a step walks, so that they cost it next to nothing.
 *
 * An island at rest has velocities of zero, and only static bodies and its own touch it. It wakes, which
 * means that its contacts go back to world->contacts, when an active body gets a contact with it, when a
 * force is applied to it, and when bodies or materials are changed. */
#ifndef PE_REST_H
#define PE_REST_H

#include "island.h"

/* One island at rest. */
typedef struct pe_resting_island {
    int first_body, body_count;         /* of body_array; no bodies: the island is gone */
    int first_manifold, manifold_count; /* of contacts */
    int first_point, point_count;       /* of contacts: room for the points of the manifolds */
    double speed, since; /* asleep: m/s, of its fastest point when it fell asleep, and s, when */
    bool sleeps;         /* it was put to sleep while it moved */
    bool is_new;         /* it came to rest at the end of the last step, in which it was solved */
    bool wakes;          /* it is to be woken, or has been since the last step began */
} pe_resting_island;

/* What the islands at rest count for. */
typedef struct pe_rest_totals {
    int islands, bodies, manifolds, points;
    int sleeping;       /* bodies */
    double residual;    /* m/s, largest, of their last solves */
    double squares;     /* (m/s)^2: rms residual squared times points, summed */
    double penetration; /* m, deepest */
} pe_rest_totals;

/* All islands at rest. All zero is none. */
typedef struct pe_rest {
    pe_array island_array; /* (island_count) pe_resting_island */
    pe_array body_array;   /* (body_count) slots, by island */
    pe_contacts contacts;  /* by island, and sorted by (a, b) in each */
    int island_count, body_count;
    pe_array of_body_array; /* (slot_count) 1 + index of the body's island; 0: it is active */
    int slot_count;
    pe_array woken_array; /* (woken_count) slots that were woken since the step began */
    int woken_count;
    bool changed; /* islands were added or marked since pe_rest_begin */
    double time;  /* s, of all steps */
    double
        sleep_drift; /* m, of the bodies that were woken since the step began: see pe_step_stats */
    pe_rest_totals totals; /* of islands that do not wake */
    pe_array awake_array; /* (awake_count) slots in use of bodies that are not at rest, ascending */
    int awake_count, movable_count; /* of the latter, those that are not static */
    bool awake_stale; /* bodies were created or destroyed, came to rest or were woken since */
} pe_rest;

/* The bodies that are not at rest, static ones among them: ascending slots. A loop over them costs nothing
 * for the others. pe_rest_list_awake must have been called since bodies were created or destroyed. */
static inline const int *pe_awake(const pe_world *world)
{
    return world->rest->awake_array.items;
}

/* How many there are. */
static inline int pe_awake_count(const pe_world *world)
{
    return world->rest->awake_count;
}

/* Lists them again if others have come or gone. */
pe_status pe_rest_list_awake(pe_world *world, pe_error *error);

/* Of each slot: 0 where the body is active or static. NULL: all are. */
static inline const int *pe_resting_of(const pe_world *world)
{
    return world->rest->totals.islands > 0 ? world->rest->of_body_array.items : NULL;
}

/* Whether the body is at rest, by what pe_resting_of returned. */
static inline bool pe_rests(const int *resting, int slot)
{
    return resting != NULL && resting[slot] != 0;
}

/* Begins a step of dt, in s, or of 0: makes room for all slots, lists the bodies that are awake, and forgets
 * the islands that have been woken, and that others are new. */
pe_status pe_rest_begin(pe_world *world, double dt, pe_error *error);

/* What becomes of an island at the end of a step. */
typedef struct pe_rest_choice {
    bool rests;   /* it is put at rest */
    bool sleeps;  /* although it moves */
    double speed; /* m/s, of its fastest point at most; where it sleeps */
} pe_rest_choice;

/* Puts the islands at rest for which this is the choice (islands->count). Their manifolds leave
 * world->contacts. The caller sets velocities to zero. On failure nothing has changed. */
pe_status pe_rest_add(pe_world *world, const pe_islands *islands, const pe_rest_choice *choices,
                      pe_error *error);

/* Has the island of the body, if it rests, woken by the next call of pe_rest_wake. */
void pe_rest_mark(pe_world *world, int slot);

/* The same of all islands. */
void pe_rest_mark_all(pe_world *world);

/* Wakes the marked islands: their manifolds join world->contacts, and their bodies woken_array. On
 * failure nothing has changed. */
pe_status pe_rest_wake(pe_world *world, pe_error *error);

/* Wakes the islands that have a manifold in world->contacts. */
pe_status pe_rest_wake_touched(pe_world *world, pe_error *error);

/* Forgets a body that is destroyed, with its contacts. All islands must be woken then before the next
 * step. */
void pe_rest_forget(pe_world *world, int slot);

/* Releases the memory. */
void pe_rest_free(pe_rest *rest, const pe_allocator *allocator);

#endif
