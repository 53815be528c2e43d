/* The broad phase: which pairs of bodies are near enough for the narrow phase. */
#ifndef PE_BROAD_PHASE_H
#define PE_BROAD_PHASE_H

#include "aabb_tree.h"
#include "model/world.h"

/* What the broad phase keeps of one slot. */
typedef struct pe_proxy {
    pe_aabb tight;    /* the body and its margin, and a little more */
    pe_vec3 position; /* the body's when `tight` was computed */
    pe_quat orientation;
    double margin;       /* m, by which `tight` is wider than the body was on every side */
    double radius;       /* m, bounding, of the body */
    uint32_t generation; /* of the body */
    bool alive, is_static;
    bool bounded; /* in the tree of its kind, with its fat AABB; else a plane, or no body */
} pe_proxy;

/* The state that is kept from step to step: see broad_phase.c. All zero to begin with. */
typedef struct pe_broad {
    pe_array proxy_array; /* (proxy_count) one a slot */
    pe_array
        moved_flag; /* (proxy_count) bool: the fat AABB is new or gone since pairs were found */
    pe_array moved_list;  /* (moved_count) slots of the moved proxies */
    pe_array plane_array; /* (plane_count) slots */
    int proxy_count, moved_count, plane_count;
    pe_tree dynamics, statics; /* of bounded bodies, by fat AABBs */
    pe_array fat_array;        /* (fat_count) pairs of fat AABBs that overlap, sorted */
    pe_array tight_array;      /* (tight_count) those whose tight AABBs overlap, sorted */
    int fat_count, tight_count;
    bool planes_changed; /* since pairs were found */
    bool tight_changed;  /* a tight AABB is new since then */
} pe_broad;

/* How far, in m, the surfaces of two bodies can come towards each other within a step of dt, and
 * the contact margin: pairs with a smaller gap need contacts now. Bound: relative velocity, each
 * body's rotation at its bounding radius, and one step of gravity. */
double pe_pair_margin(const pe_world *world, int a, int b, double dt);

/* The speed, in m/s, that rotation gives the outermost point of a body. pe_pair_margin is dt times
 * the sum of the relative speed and both bodies' spin speeds, plus the slack. */
double pe_spin_speed(const pe_world *world, int slot);

/* The slack of pe_pair_margin, in m: the contact margin plus dt^2 times gravity. */
double pe_margin_slack(const pe_world *world, double dt);

/* All pairs with an active body whose gap may be below their margin, and few others, sorted by (a, b), valid
 * until the next call, and not to be added to. With `moved` (slot_count) not NULL only the pairs with a body flagged there. Pairs are
 * kept from call to call, so that bodies at rest cost next to nothing. After PE_NO_MEMORY the next
 * call finds what this one did not. */
pe_status pe_broad_phase(pe_world *world, double dt, const bool *moved, pe_pair_list *pairs,
                         pe_error *error);

/* Releases what the broad phase keeps. */
void pe_broad_free(pe_broad *broad, const pe_allocator *allocator);

#endif
