/* The fast profile: loads are carried, walls stand, penetration falls with the step, and no step adds
 * more energy than it costs to lift loads out of their depth. */
#include "base/vec3.h"
#include "check.h"
#include "soft_for_tests.h"
#include "world_for_tests.h"

#include <stdlib.h>

static pe_world *fast_world(void)
{
    pe_world_def def = pe_world_def_default();
    def.profile = PE_PROFILE_FAST;
    return make_world(&def);
}

/* A cube of side 1 with this centre and mass. */
static pe_body_id add_cube(pe_world *world, pe_material_id material, pe_vec3 at, double mass)
{
    pe_body_def def = box_def(0.5, 0.5, 0.5, at);
    def.mass = mass;
    def.material = material;
    return add_body(world, &def);
}

/* The deepest contact now, in m. */
static double deepest(const pe_world *world)
{
    double most = 0;
    for (int i = 0; i < world->contacts.manifold_count; ++i) {
        most = pe_max(most, -pe_manifolds(&world->contacts)[i].least_separation);
    }
    return most;
}

/* A cube falls by 10 cm onto two layers of n x n cubes of 1 kg that touch. */
static void test_heavy_load_does_not_sink(void **state)
{
    (void)state;
    const int sides[3] = {1, 3, 6};
    for (int k = 0; k < 6; ++k) {
        const int n = sides[k / 2];
        const double mass = k % 2 ? 1000 : 30;
        pe_world *world = fast_world();
        pe_material_id material = add_material(world, 0.5, 0);
        add_plane(world, pe_v3(0, 0, 1), material);
        for (int i = 0; i < 2 * n * n; ++i) {
            const int x = i / 2 % n, y = i / 2 / n;
            add_cube(world, material, pe_v3(x - 0.5 * n, y - 0.5 * n, 0.5 + i % 2), 1);
        }
        pe_body_id load = add_cube(world, material, pe_v3(-0.3, -0.4, 2.6), mass);
        double worst = 0;
        for (int s = 0; s < 120; ++s) {
            step(world, 1.0 / 60);
            worst = pe_max(worst, deepest(world));
        }
        assert_at_most(worst, 2e-2);
        assert_at_most(deepest(world), 1e-3);
        assert_close(state_of(world, load).position.z, 2.5, 2e-3, 0);
        pe_world_destroy(world);
    }
}

/* Rows of bricks in running bond, half a brick wide at every second end. */
static void test_high_wall_does_not_sag(void **state)
{
    (void)state;
    enum { ROWS = 20, COLUMNS = 8 };
    pe_world *world = fast_world();
    pe_material_id material = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), material);
    pe_body_id top = {0};
    for (int row = 0; row < ROWS; ++row) {
        for (int i = 0; i < COLUMNS + row % 2; ++i) {
            const bool half = row % 2 && (i == 0 || i == COLUMNS);
            const double x = !(row % 2) ? i : i == 0 ? -0.25 : i == COLUMNS ? i - 0.75 : i - 0.5;
            pe_body_def def = box_def(half ? 0.25 : 0.5, 0.25, 0.25, pe_v3(x, 0, 0.25 + 0.5 * row));
            def.mass = half ? 0.5 : 1;
            def.material = material;
            top = add_body(world, &def);
        }
    }
    const double height = state_of(world, top).position.z;
    for (int s = 0; s < 120; ++s) {
        step(world, 1.0 / 60);
    }
    assert_close(state_of(world, top).position.z, height, 1e-3, 0);
    pe_world_destroy(world);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* What the deepest contact of a small collapse does not exceed in 95 % of the steps. */
static double collapse_depth(int rate)
{
    enum { SECONDS = 2, MOST = 240 * SECONDS };
    double depth[MOST];
    pe_world *world = fast_world();
    pe_body_id ids[WALL_BODIES];
    add_wall_and_ball(world, ids);
    for (int s = 0; s < SECONDS * rate; ++s) {
        step(world, 1.0 / rate);
        depth[s] = deepest(world);
    }
    pe_world_destroy(world);
    qsort(depth, (size_t)(SECONDS * rate), sizeof *depth, ascending);
    return depth[SECONDS * rate * 95 / 100];
}

static void test_penetration_falls_with_the_step(void **state)
{
    (void)state;
    assert_at_most(collapse_depth(240), 0.5 * collapse_depth(60));
}

/* The sum over the contacts of the last step of force x depth at its start, in J. */
static double cost_of_lifting(const pe_world *world, double dt)
{
    pe_contact contacts[4096];
    const int count = pe_world_get_contacts(world, contacts, 4096);
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double force = pe_dot(contacts[i].impulse, contacts[i].normal) / dt;
        sum += pe_max(force, 0) * pe_max(-contacts[i].separation, 0);
    }
    return sum;
}

static void test_step_adds_no_more_than_lifting_costs(void **state)
{
    (void)state;
    const double dt = 1.0 / 60;
    pe_world *world = fast_world();
    pe_body_id ids[WALL_BODIES];
    add_wall_and_ball(world, ids);
    double before = 0;
    for (int s = 0; s <= 180; ++s) {
        double energy = 0, scale = 0;
        for (int i = 0; i < WALL_BODIES; ++i) {
            energy += energy_of(world, ids[i]);
            scale += fabs(energy_of(world, ids[i]));
        }
        if (s > 0) {
            assert_at_most(energy, before + cost_of_lifting(world, dt) + 1e-6 * scale);
        }
        before = energy;
        step(world, dt);
    }
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_heavy_load_does_not_sink),
        cmocka_unit_test(test_high_wall_does_not_sag),
        cmocka_unit_test(test_penetration_falls_with_the_step),
        cmocka_unit_test(test_step_adds_no_more_than_lifting_costs),
    };
    return cmocka_run_group_tests_name("engine_fast", tests, NULL, NULL);
}
