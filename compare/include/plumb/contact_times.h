/* An extension of the engine ABI (pl_engine.extension): when, within a step, contact impulses acted.
 *
 * An engine that takes impacts at their own time, or lets contacts act at the middle of a step, can
 * say so. Its contacts are then judged by the velocities that they left, which follow from the state
 * before the step and from the impulses up to then, and not by those at the end of the step. It may
 * list a contact point several times in a step, once for each interval and each impact. Without
 * this table every contact is one over the whole step. */
#ifndef PLUMB_CONTACT_TIMES_H
#define PLUMB_CONTACT_TIMES_H

#include "engine_abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The name of the table below. */
#define PL_CONTACT_TIMES "plumb.contact_times/1"

/* Where a contact is, seen from its bodies: world axes. */
typedef struct pl_contact_place {
    double arm_a[3];  /* m, from the centre of mass of A to the point */
    double arm_b[3];  /* m, from the centre of mass of B to the point */
    double normal[3]; /* unit, from A to B */
} pl_contact_place;

/* When and where a contact of read_contacts acted. If it acted over a part of the step, its
 * separation is that at `begin`, and its point is where it was when its impulse acted. */
typedef struct pl_contact_time {
    double begin;           /* s since the start of the step */
    double end;             /* s, from begin to dt; equal to begin: an impact, in an instant */
    int order;              /* of the solves within the step */
    pl_contact_place acts;  /* where the impulse acted */
    pl_contact_place holds; /* where the contact law holds for the velocities at `end`; the same
                               place, or where the contact is at `end` */
} pl_contact_time;

/* The table of that name. */
typedef struct pl_contact_times {
    /* Fills `times` for the first `count` contacts of read_contacts, in its order. The contacts of
     * each body are listed in the order in which they acted; those of one solve, and no others
     * next to them, have the same `order`. */
    void (*read)(const pl_engine_instance *instance, pl_contact_time *times, int count);
} pl_contact_times;

#ifdef __cplusplus
}
#endif
#endif
