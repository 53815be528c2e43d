#include "soft_for_tests.h"

#include "check.h"
#include "contact/contact.h"
#include "world_for_tests.h"

pe_status soft_prepare(pe_world *world, double dt, soft_case *made)
{
    pe_contact_rules rules = pe_contact_rules_exact();
    pe_arena_reset(&world->arena, &world->allocator);
    pe_status status = pe_contacts_update(world, &rules, NULL, dt, NULL);
    if (status == PE_OK) {
        pe_contacts_scale_impulses(world, dt);
        status = pe_islands_find(world, &made->islands, NULL);
    }
    if (status == PE_OK) {
        made->chosen = pe_scratch(world, (size_t)made->islands.count + 1, sizeof *made->chosen);
        status = made->chosen != NULL ? PE_OK : PE_NO_MEMORY;
    }
    for (int k = 0; status == PE_OK && k < made->islands.count; ++k) {
        made->chosen[k] = true;
    }
    made->all = (pe_chosen_islands){&made->islands, made->chosen};
    return status;
}

pe_soft_report soft_step(pe_world *world, double dt, const pe_soft_settings *settings)
{
    pe_soft_report report;
    pe_error error = {0};
    soft_case now;
    assert_int_equal(soft_prepare(world, dt, &now), PE_OK);
    pe_status status = pe_soft_step(world, &now.all, dt, settings, &report, &error);
    if (status != PE_OK) {
        fail_msg("engine: %s", error.message);
    }
    world->applied_force_count = 0;
    world->previous_dt = dt;
    return report;
}

void add_wall_and_ball(pe_world *world, pe_body_id ids[WALL_BODIES])
{
    pe_material_id material = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), material);
    for (int i = 0; i < WALL_ROWS * WALL_COLUMNS; ++i) {
        int row = i / WALL_COLUMNS, column = i % WALL_COLUMNS;
        pe_body_def brick =
            box_def(0.5, 0.25, 0.25, pe_v3(column + 0.5 * (row % 2), 0, 0.25 + 0.5 * row));
        brick.material = material;
        ids[i] = add_body(world, &brick);
    }
    pe_body_def ball = pe_body_def_default();
    ball.mass = 20;
    ball.position = pe_v3(4, -0.8, 1.2);
    ball.velocity = pe_v3(0, 15, 0);
    ball.material = material;
    ids[WALL_BODIES - 1] = add_body(world, &ball);
}

double energy_of(const pe_world *world, pe_body_id body)
{
    pe_body_state s = state_of(world, body);
    double mass;
    pe_vec3 inertia;
    pe_body_get_mass(world, body, &mass, &inertia, NULL);
    pe_mat3 rotation = pe_matrix_of(s.orientation);
    pe_vec3 w = pe_unrotate(&rotation, s.angular_velocity);
    return 0.5 * mass * pe_dot(s.velocity, s.velocity) + 0.5 * pe_dot(w, pe_mul(inertia, w)) -
           mass * pe_dot(world->def.gravity, s.position);
}
