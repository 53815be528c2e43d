/* Short forms for building worlds in tests of the engine; a failure fails the test. */
#ifndef PLUMB_TEST_WORLD_H
#define PLUMB_TEST_WORLD_H

#include "counting_allocator.h"
#include "plumb/engine.h"

pe_world *make_world(const pe_world_def *def); /* NULL: the default */
pe_material_id add_material(pe_world *world, double friction, double restitution);
pe_body_id add_plane(pe_world *world, pe_vec3 normal, pe_material_id material);
pe_body_id add_body(pe_world *world, const pe_body_def *def);
pe_body_def box_def(double hx, double hy, double hz, pe_vec3 position);
pe_body_state state_of(const pe_world *world, pe_body_id body);
pe_step_stats step(pe_world *world, double dt);

/* A task system that runs each task within the call that submits it: the same thread always does the same
 * work. Counts the tasks in *runs, which may be NULL. */
pe_task_system tasks_at_once(int *runs);

/* Makes some steps, and checks that `steps` more allocate nothing. Destroys the world, whose
 * allocator counts in *c, and checks that all memory is given back. */
void check_allocates_nothing(pe_world *world, const counter *c, int warm_up, int steps);

/* Has the contacts of islands at rest in world->contacts, as those of the others. */
void wake_all(pe_world *world);

/* Cubes of side 1 and 1 kg, exactly stacked on the plane z = 0; ids (n). */
void add_tower(pe_world *world, int n, pe_material_id material, pe_body_id *ids);

#endif
