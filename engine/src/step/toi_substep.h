/* One island on its way through a step that it takes in parts: its contacts, which of them take
 * part, and what becomes of their impulses. */
#ifndef PE_PART_H
#define PE_PART_H

#include "contact/contact.h"
#include "island_step.h"

/* m: a gap up to this is closed, and what is deeper by no more has not gone too far. */
static const double PE_CLOSED = 1e-8;

typedef struct pe_substep {
    pe_world *world;
    const pe_contact_rules *rules;
    const pe_islands *whole; /* of the step's contacts; this is island k */
    int k;
    pe_islands island; /* the same bodies with the manifolds of the part, all in one */
    pe_pair *pairs;
    int pair_count;
    int *counts;          /* of all points of each manifold of the part */
    pe_free_motion *free; /* (slots) over the part; the bodies' alone are filled */
    pe_pose *poses;       /* (bodies) where the part began */
    pe_twist *motions;    /* (bodies) there */
    pe_twist *ends;       /* (bodies) and without the impact at the end of `left` */
    double dt, left;      /* s */
    double slow;          /* m/s: what closes by less is no impact */
    pe_solve_tally *tally;
    pe_path path;
    pe_error *error;
} pe_substep;

/* Takes the memory of a part whose world, island, dt and so on are set, in the step's arena. */
pe_status pe_substep_begin(pe_substep *part);

static inline int pe_substep_bodies(const pe_substep *part)
{
    return part->island.body_start[1];
}

/* Changes world->contacts and world->previous for the lists of parts, or back. */
void pe_substep_exchange(pe_world *world);

/* Finds the contacts at the poses now. The list before is in world->previous. */
pe_status pe_substep_find(pe_substep *part);

/* Back from what pe_substep_find has found to the list before. */
void pe_substep_unfind(pe_substep *part);

/* Which points take part in a solve. */
typedef enum pe_choice {
    PE_ALL,
    PE_SEPARATING, /* all but those that are about to strike */
    PE_IMPACTING   /* those that strike now, and those that touch */
} pe_choice;

/* Makes part->island that of the chosen points; how many they are. The others lose their impulses.
 */
int pe_substep_choose(pe_substep *part, pe_choice which);

/* Sets the impulses of the step's contacts to 0; they are in world->contacts. */
void pe_substep_clear_impulses(const pe_substep *part);

/* Adds the impulses of a part's list to those of the step, whose points get the place and the
 * normal at which most of theirs acted; their gap stays that of the step's start. A point that is
 * not in the step's list stands for the nearest one of the pair. The lists are exchanged. */
void pe_substep_add_impulses(const pe_substep *part, const pe_contacts *list);

/* What gravity makes in a step is no impact, nor is less than 1e-9, m/s. */
double pe_slow_closing(const pe_world *world, double dt);

/* Speed, in m/s, at which the gap of a point opens, at these motions of its bodies. */
double pe_opening(const pe_world *world, const pe_manifold *m, const pe_manifold_point *point,
                  const pe_twist *of_a, const pe_twist *of_b);
double pe_opening_now(const pe_world *world, const pe_manifold *m, const pe_manifold_point *point);

/* Whether a point that opens at `speed` is an impact at this very time. */
bool pe_strikes_now(const pe_substep *part, const pe_manifold_point *point, double speed);

#endif
