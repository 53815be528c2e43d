#include "world_for_tests.h"

#include "check.h"
#include "model/rest.h"

static void require(pe_status status, const pe_error *error)
{
    if (status != PE_OK) {
        fail_msg("engine: %s", error->message);
    }
}

pe_world *make_world(const pe_world_def *def)
{
    pe_world_def standard = pe_world_def_default();
    pe_world *world;
    pe_error error;
    require(pe_world_create(def != NULL ? def : &standard, &world, &error), &error);
    return world;
}

pe_material_id add_material(pe_world *world, double friction, double restitution)
{
    pe_material_id id;
    pe_error error;
    require(pe_material_create(world, friction, restitution, &id, &error), &error);
    return id;
}

pe_body_id add_plane(pe_world *world, pe_vec3 normal, pe_material_id material)
{
    pe_body_def def = pe_body_def_default();
    def.is_static = true;
    def.shape = (pe_shape){.kind = PE_SHAPE_PLANE, .normal = normal};
    def.material = material;
    return add_body(world, &def);
}

pe_body_id add_body(pe_world *world, const pe_body_def *def)
{
    pe_body_id id;
    pe_error error;
    require(pe_body_create(world, def, &id, &error), &error);
    return id;
}

pe_body_def box_def(double hx, double hy, double hz, pe_vec3 position)
{
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){.kind = PE_SHAPE_BOX, .half_extents = {hx, hy, hz}};
    def.position = position;
    return def;
}

pe_body_state state_of(const pe_world *world, pe_body_id body)
{
    pe_body_state state;
    pe_error error;
    require(pe_body_get_state(world, body, &state, &error), &error);
    return state;
}

pe_step_stats step(pe_world *world, double dt)
{
    pe_step_stats stats;
    pe_error error;
    require(pe_world_step(world, dt, &stats, &error), &error);
    return stats;
}

void add_tower(pe_world *world, int n, pe_material_id material, pe_body_id *ids)
{
    add_plane(world, (pe_vec3){0, 0, 1}, material);
    for (int i = 0; i < n; ++i) {
        pe_body_def def = box_def(0.5, 0.5, 0.5, (pe_vec3){0, 0, i + 0.5});
        def.material = material;
        ids[i] = add_body(world, &def);
    }
}

void wake_all(pe_world *world)
{
    pe_error error;
    pe_rest_mark_all(world);
    require(pe_rest_wake(world, &error), &error);
}

static void *run_at_once(void (*work)(void *argument), void *argument, void *context)
{
    int *runs = context;
    if (runs != NULL) {
        *runs += 1;
    }
    work(argument);
    return NULL;
}

static void wait_for_nothing(void *task, void *context)
{
    (void)task;
    (void)context;
    fail_msg("a task that has run is waited for");
}

pe_task_system tasks_at_once(int *runs)
{
    return (pe_task_system){.run = run_at_once, .wait = wait_for_nothing, .context = runs};
}

void check_allocates_nothing(pe_world *world, const counter *c, int warm_up, int steps)
{
    for (int i = 0; i < warm_up; ++i) {
        step(world, 1.0 / 60);
    }
    const int made = c->calls;
    for (int i = 0; i < steps; ++i) {
        step(world, 1.0 / 60);
    }
    assert_int_equal(c->calls, made);
    pe_world_destroy(world);
    assert_int_equal(c->living, 0);
}
