/* What the broad phase knows from step to step: see broad_phase.c. All zero to begin with. */
#ifndef PE_BROAD_PHASE_STATE_H
#define PE_BROAD_PHASE_STATE_H

#include "aabb_tree.h"

/* Of one slot. */
typedef struct pe_proxy {
    pe_box snug;      /* the body and its margin, and a little more */
    pe_vec3 position; /* the body's when `snug` was made */
    pe_quat orientation;
    double room;         /* m, by which `snug` was wider than the body on every side */
    double radius;       /* m, bounding, of the body */
    uint32_t generation; /* of the body */
    bool alive, is_static;
    bool bounded; /* in the tree of its kind, with its fat box; else a plane, or no body */
} pe_proxy;

typedef struct pe_broad {
    pe_array proxy_array;  /* (slots) of the world when it was last looked at */
    pe_array stirred_flag; /* (slots) bool: the fat box is new or gone since pairs were found */
    pe_array stirred_list; /* (stirred_count) their slots */
    pe_array plane_array;  /* (plane_count) slots */
    int proxy_count, stirred_count, plane_count;
    pe_tree dynamics, statics; /* of bounded bodies, by fat boxes */
    pe_array fat_array;        /* (fat_count) pairs of fat boxes, sorted */
    pe_array near_array;       /* (near_count) those of them whose snug boxes meet, sorted */
    int fat_count, near_count;
    bool planes_changed, shifted; /* since pairs were found; a snug box is new since then */
} pe_broad;

#endif
