/* The fast profile: loads are carried, walls stand, penetration falls with the step, and
 * overlap is lifted by no more energy than that costs. */
#include "base/vec3.h"
#include "check.h"
#include "soft_for_tests.h"
#include "world_for_tests.h"

#include <stdlib.h>
#include <string.h>

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

enum { ROWS = 20, COLUMNS = 8, BRICKS = ROWS * COLUMNS + ROWS / 2 };

/* Rows of bricks in running bond, half a brick wide at every second end. Neighbouring rows overlap. */
static pe_world *wall_world(double overlap, pe_body_id ids[BRICKS])
{
    pe_world *world = fast_world();
    pe_material_id material = add_material(world, 0.5, 0);
    int count = 0;
    add_plane(world, pe_v3(0, 0, 1), material);
    for (int row = 0; row < ROWS; ++row) {
        for (int i = 0; i < COLUMNS + row % 2; ++i) {
            const bool half = row % 2 && (i == 0 || i == COLUMNS);
            const double x = !(row % 2) ? i : i == 0 ? -0.25 : i == COLUMNS ? i - 0.75 : i - 0.5;
            pe_body_def def =
                box_def(half ? 0.25 : 0.5, 0.25, 0.25, pe_v3(x, 0, 0.25 + (0.5 - overlap) * row));
            def.mass = half ? 0.5 : 1;
            def.material = material;
            ids[count++] = add_body(world, &def);
        }
    }
    return world;
}

static void test_high_wall_does_not_sag(void **state)
{
    (void)state;
    pe_body_id ids[BRICKS];
    pe_world *world = wall_world(0, ids);
    const double height = state_of(world, ids[BRICKS - 1]).position.z;
    for (int s = 0; s < 120; ++s) {
        step(world, 1.0 / 60);
    }
    assert_close(state_of(world, ids[BRICKS - 1]).position.z, height, 1e-3, 0);
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

/* A point of the body's axes, before and after a step, and how far it went along `normal`. */
static double way_along(pe_vec3 normal, pe_vec3 anchor, const pe_pose *before, const pe_pose *after)
{
    pe_vec3 from = pe_add(before->position, pe_rotate(&before->rotation, anchor));
    pe_vec3 to = pe_add(after->position, pe_rotate(&after->rotation, anchor));
    return pe_dot(normal, pe_sub(to, from));
}

/* The sum over the contacts of the last step of normal force x depth that was removed, in J. */
static double cost_of_lifting(const pe_world *world, const pe_pose *before, double dt)
{
    pe_point_walk at = pe_walk_points(&world->solved);
    const pe_pose *now = pe_poses(world);
    double sum = 0;
    while (pe_next_point(&at)) {
        const pe_manifold *m = at.manifold;
        const double force = pe_dot(m->normal, at.point->impulse) / dt;
        const double way = way_along(m->normal, at.point->anchor_b, &before[m->b], &now[m->b]) -
                           way_along(m->normal, at.point->anchor_a, &before[m->a], &now[m->a]);
        sum += pe_max(force, 0) * pe_max(0, pe_min(way, -at.point->separation));
    }
    return sum;
}

static void test_overlapping_wall_rises_to_rest(void **state)
{
    (void)state;
    const double dt = 1.0 / 60;
    pe_body_id ids[BRICKS];
    pe_world *world = wall_world(1e-3, ids);
    pe_pose before[BRICKS + 2];
    double energy = 0, last = 0, size = 0;
    for (int s = 0; s <= 120; ++s) {
        last = energy;
        energy = size = 0;
        for (int i = 0; i < BRICKS; ++i) {
            energy += energy_of(world, ids[i]);
            size += fabs(energy_of(world, ids[i]));
        }
        if (s > 0) {
            assert_at_most(energy, last + cost_of_lifting(world, before, dt) + 1e-9 * size);
        }
        memcpy(before, pe_poses(world), sizeof before);
        step(world, dt);
    }
    assert_close(energy, last, 1e-12 * size, 0);
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_heavy_load_does_not_sink),
        cmocka_unit_test(test_high_wall_does_not_sag),
        cmocka_unit_test(test_penetration_falls_with_the_step),
        cmocka_unit_test(test_overlapping_wall_rises_to_rest),
    };
    return cmocka_run_group_tests_name("engine_fast", tests, NULL, NULL);
}
