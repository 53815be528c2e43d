/* The list of contacts of a world as a step finds it, and a wall to find it in. */
#ifndef PLUMB_TEST_CONTACT_WORLD_H
#define PLUMB_TEST_CONTACT_WORLD_H

#include "check.h"
#include "contact/contact.h"
#include "world_for_tests.h"

static const double CONTACT_STEP = 1.0 / 60; /* s */

/* Contacts at the poses now, as a step finds them. */
void find_contacts_by(pe_world *world, double reuse_tolerance, int most_points);
void find_contacts(pe_world *world, double reuse_tolerance);

/* The same again for the pairs with a body that moved, by slot. */
void find_contacts_again(pe_world *world, const bool *moved, double tolerance);

/* Of two slots; NULL: none. */
const pe_manifold *manifold_of(const pe_contacts *contacts, int a, int b);

/* At rest; the orientation need not be unit. */
void place_body(pe_world *world, pe_body_id id, pe_vec3 position, pe_quat orientation);

/* The rotation by a small vector. */
pe_quat turned_by(pe_quat q, pe_vec3 r);

/* A wall of bricks on a plane with balls on top. */
enum {
    BRICK_ROWS = 5,
    BRICK_COLUMNS = 6,
    BRICK_BALLS = 4,
    BRICK_BODIES = BRICK_ROWS * BRICK_COLUMNS + BRICK_BALLS
};

/* NULL: a default world. */
pe_world *make_brick_wall(const pe_world_def *def, pe_body_id ids[BRICK_BODIES]);

/* Moves and turns a body by up to `reach` along each axis. The rotation is drawn first. */
void shake_body(pe_world *world, pe_body_id id, check_random *random, double reach);

/* Moves and turns by up to `reach` along each axis the bodies that `moved` names by their slots;
 * NULL: all. */
void shake_wall(pe_world *world, const pe_body_id ids[BRICK_BODIES], check_random *random,
                const bool *moved, double reach);

/* Pushes that tell every point from all others. */
void mark_impulses(pe_contacts *contacts);

/* Of a manifold of each list, to the bit. */
void assert_same_points(const pe_contacts *p, const pe_manifold *m, const pe_contacts *q,
                        const pe_manifold *n);

#endif
