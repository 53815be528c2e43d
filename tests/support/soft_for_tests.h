/* Steps of a world by sub-stepped soft contact alone, whatever its profile. */
#ifndef PLUMB_TEST_SOFT_H
#define PLUMB_TEST_SOFT_H

#include "solver/soft.h"

/* One step of all islands, contacts included. Bodies in no island stand still. `settings` NULL: the
 * defaults. */
pe_soft_report soft_step(pe_world *world, double dt, const pe_soft_settings *settings);

/* The first half of that: the contacts and islands at the present poses, and all of them chosen. */
typedef struct soft_case {
    pe_islands islands;
    bool *chosen;          /* (islands.count) */
    pe_chosen_islands all; /* of these two */
} soft_case;

pe_status soft_prepare(pe_world *world, double dt, soft_case *made);

/* A wall of bricks on the plane z = 0, and a heavy ball that flies into it. */
enum { WALL_ROWS = 6, WALL_COLUMNS = 8, WALL_BODIES = WALL_ROWS * WALL_COLUMNS + 1 };

void add_wall_and_ball(pe_world *world, pe_body_id ids[WALL_BODIES]);

/* Kinetic energy and potential energy in the gravity of the world. */
double energy_of(const pe_world *world, pe_body_id body);

#endif
