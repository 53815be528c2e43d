/* Sub-stepped soft contact: lanes, order, memory, and the choice of islands. */
#include "base/vec3.h"
#include "check.h"
#include "counting_allocator.h"
#include "soft_for_tests.h"
#include "solver/soft_task.h"
#include "world_for_tests.h"

#include <stdlib.h>
#include <string.h>

static const double H = 1.0 / 60, G = 9.81;

/* Settings for this number of lanes; false if the processor lacks them. */
static bool settings_of(int lanes, pe_soft_settings *settings)
{
    pe_world *world = make_world(NULL);
    *settings = pe_soft_settings_default();
    settings->lanes = lanes;
    bool has = soft_step(world, H, settings).lanes == lanes;
    pe_world_destroy(world);
    if (!has) {
        print_message("    this processor has no %d lanes\n", lanes);
    }
    return has;
}

/* A heavy plate on the plane with `n` x `n` small boxes upon it: more contacts than there are
 * colours. Returns the plate. */
static pe_body_id add_laid_table(pe_world *world, int n, pe_body_id *last)
{
    pe_material_id material = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), material);
    pe_body_def plate = box_def(5, 5, 0.1, pe_v3(0, 0, 0.1));
    plate.mass = 100;
    plate.material = material;
    pe_body_id id = add_body(world, &plate);
    for (int i = 0; i < n * n; ++i) {
        double x = (i % n + 0.5) * 9.0 / n - 4.5, y = (i / n + 0.5) * 9.0 / n - 4.5;
        pe_body_def box = box_def(0.2, 0.2, 0.2, pe_v3(x, y, 0.4));
        box.velocity = pe_v3(0.3, 0.1 * (i % 3), 0);
        box.material = material;
        *last = add_body(world, &box);
    }
    return id;
}

enum { TABLE = 9 };

static void test_every_lane_count_gives_the_same_bits(void **state)
{
    (void)state;
    const int lanes[2] = {4, 8};
    for (int scene = 0; scene < 2; ++scene) {
        for (int k = 0; k < 2; ++k) {
            pe_soft_settings narrow, wide;
            if (!settings_of(1, &narrow) || !settings_of(lanes[k], &wide)) {
                continue;
            }
            pe_world *one = make_world(NULL), *other = make_world(NULL);
            pe_body_id ids[WALL_BODIES];
            if (scene == 0) {
                add_wall_and_ball(one, ids);
                add_wall_and_ball(other, ids);
            } else {
                add_laid_table(one, TABLE, ids);
                add_laid_table(other, TABLE, ids);
            }
            size_t slots = (size_t)one->slot_count;
            for (int i = 0; i < 100; ++i) {
                soft_step(one, H, &narrow);
                pe_soft_report report = soft_step(other, H, &wide);
                assert_int_equal(report.colours == 64, scene == 1);
                assert_memory_equal(pe_poses(one), pe_poses(other), slots * sizeof(pe_pose));
                assert_memory_equal(pe_twists(one), pe_twists(other), slots * sizeof(pe_twist));
                for (int j = 0; j < one->contacts.point_count; ++j) {
                    assert_memory_equal(&pe_manifold_points(&one->contacts)[j].impulse,
                                        &pe_manifold_points(&other->contacts)[j].impulse,
                                        sizeof(pe_vec3));
                }
            }
            pe_world_destroy(one);
            pe_world_destroy(other);
        }
    }
}

static void test_more_contacts_than_colours_are_solved(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id last, plate = add_laid_table(world, TABLE, &last);
    for (int i = 0; i < 240; ++i) {
        soft_step(world, H, NULL);
    }
    const pe_contacts *contacts = &world->contacts;
    double floor_carries = 0;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        for (int j = m->first; m->b == (int)plate.index && j < m->first + m->count; ++j) {
            floor_carries += pe_manifold_points(contacts)[j].impulse.z;
        }
    }
    assert_close(floor_carries, (100 + TABLE * TABLE) * G * H, 0, 1e-6);
    assert_at_most(pe_length(state_of(world, last).velocity), 1e-6);
    pe_world_destroy(world);
}

static void test_colours_share_no_body_points_planned_once(void **state)
{
    (void)state;
    for (int scene = 0; scene < 2; ++scene) {
        pe_world *world = make_world(NULL);
        pe_body_id ids[WALL_BODIES];
        if (scene == 0) {
            add_wall_and_ball(world, ids);
        } else {
            add_laid_table(world, TABLE, ids);
        }
        soft_case now;
        pe_solver_bodies bodies;
        pe_soft_plan plan;
        assert_int_equal(soft_prepare(world, H, &now), PE_OK);
        assert_int_equal(pe_solver_bodies_take(world, &now.all, &bodies, NULL), PE_OK);
        assert_int_equal(pe_soft_plan_make(world, &now.all, &bodies, &plan, NULL), PE_OK);
        int *seen = calloc((size_t)world->contacts.point_count, sizeof *seen);
        int *batch_of = calloc((size_t)bodies.count, sizeof *batch_of);
        int planned = 0, serial = 0;
        for (int q = 0; q < plan.batch_count; ++q) {
            const pe_soft_batch *batch = &plan.batches[q];
            serial += batch->serial;
            for (int i = batch->first; i < batch->first + batch->count; ++i) {
                const pe_soft_contact *contact = &plan.contacts[i];
                assert_int_equal(contact->count, batch->points);
                for (int j = 0; j < contact->count; ++j, ++planned) {
                    assert_int_equal(seen[contact->point[j]]++, 0);
                }
                const int pair[2] = {contact->a, contact->b};
                for (int side = 0; side < 2 && !batch->serial; ++side) {
                    assert_true(pair[side] == 0 || batch_of[pair[side]] != q + 1);
                    batch_of[pair[side]] = q + 1;
                }
            }
        }
        assert_int_equal(planned, world->contacts.point_count);
        assert_int_equal(serial > 0, scene == 1);
        free(seen);
        free(batch_of);
        pe_world_destroy(world);
    }
}

static void test_eight_point_manifold_carries_like_four_points(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    add_tower(world, 2, (pe_material_id){0}, ids);
    pe_body_state rotated = state_of(world, ids[1]);
    rotated.orientation = (pe_quat){cos(0.3927), 0, 0, sin(0.3927)}; /* by 45 degrees */
    pe_body_set_state(world, ids[1], &rotated, NULL);
    for (int i = 0; i < 200; ++i) {
        soft_step(world, H, NULL);
    }
    const pe_manifold *m = &pe_manifolds(&world->contacts)[1];
    assert_int_equal(m->count, 8);
    double sum = 0;
    for (int j = m->first; j < m->first + m->count; ++j) {
        assert_true(pe_manifold_points(&world->contacts)[j].impulse.z >= 0);
        sum += pe_manifold_points(&world->contacts)[j].impulse.z;
    }
    assert_close(sum, G * H, 1e-8, 0);
    pe_world_destroy(world);
}

static void test_substeps_go_by_the_root_of_the_step(void **state)
{
    (void)state;
    const double dt[6] = {1.0 / 1000, 1.0 / 480, 1.0 / 240, 1.0 / 60, 1.0 / 40, 1.0 / 10};
    const int expected[6] = {6, 6, 6, 10, 12, 12};
    pe_world *world = make_world(NULL);
    pe_body_id id;
    add_tower(world, 1, (pe_material_id){0}, &id);
    for (int i = 0; i < 6; ++i) {
        assert_int_equal(soft_step(world, dt[i], NULL).substeps, expected[i]);
    }
    pe_world_destroy(world);
}

static void test_unchosen_island_is_not_touched(void **state)
{
    (void)state;
    pe_world *both = make_world(NULL), *single = make_world(NULL);
    pe_body_id ids[3], other;
    add_tower(both, 3, (pe_material_id){0}, ids);
    add_tower(single, 3, (pe_material_id){0}, ids);
    pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(5, 0, 0.5));
    def.velocity = pe_v3(1, 0, 0);
    other = add_body(both, &def);
    soft_case now;
    assert_int_equal(soft_prepare(both, H, &now), PE_OK);
    assert_int_equal(now.islands.count, 2);
    now.chosen[1] = false;
    pe_body_state before = state_of(both, other);
    pe_soft_report report;
    assert_int_equal(pe_soft_step(both, &now.all, H, NULL, &report, NULL), PE_OK);
    pe_body_state after = state_of(both, other);
    assert_memory_equal(&before, &after, sizeof before);
    assert_int_equal(report.bodies, 3);
    assert_int_equal(report.manifolds, 3);
    const pe_manifold *m = &pe_manifolds(&both->contacts)[now.islands.manifolds[3]];
    assert_close(pe_length(pe_manifold_points(&both->contacts)[m->first].impulse), 0, 0, 0);
    /* The chosen island moves as if there were nothing else. */
    soft_step(single, H, NULL);
    for (int i = 0; i < 3; ++i) {
        pe_body_state a = state_of(both, ids[i]), b = state_of(single, ids[i]);
        assert_memory_equal(&a, &b, sizeof a);
    }
    pe_world_destroy(both);
    pe_world_destroy(single);
}

static void test_precession_and_rotation_keep_kinetic_energy(void **state)
{
    (void)state;
    check_random random = {11};
    for (int i = 0; i < 100; ++i) {
        pe_world *world = make_world(NULL);
        pe_material_id material = add_material(world, 0.5, 0);
        add_plane(world, pe_v3(0, 0, 1), material);
        pe_body_def def = box_def(0.1, 0.3, 0.5, pe_v3(0, 0, 0.5));
        def.angular_velocity = pe_v3(30, -20, 25);
        pe_body_id body = add_body(world, &def);
        soft_case now;
        pe_solver_bodies bodies;
        assert_int_equal(soft_prepare(world, H, &now), PE_OK);
        assert_int_equal(pe_solver_bodies_take(world, &now.all, &bodies, NULL), PE_OK);
        assert_int_equal(bodies.count, 2);
        pe_solver_bodies_fill(world, H, H, &bodies);
        const double *spin = bodies.velocity[1].angular;
        double twice = spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2];
        assert_close(twice / 2, energy_of(world, body) - G * 0.5, 0, 1e-13);
        twice = 0;
        for (int k = 0; k < 3; ++k) {
            double w = check_uniform(&random, -3, 3);
            bodies.velocity[1].linear[k] = 0;
            bodies.velocity[1].angular[k] = w;
            bodies.displacement[1].angular[k] = check_uniform(&random, -0.3, 0.3);
            twice += w * w;
        }
        pe_solver_bodies_apply(world, &bodies);
        double potential = G * state_of(world, body).position.z;
        assert_close(energy_of(world, body), twice / 2 + potential, 1e-12, 0);
        pe_world_destroy(world);
    }
}

static pe_world *counted_world(counter *c)
{
    pe_world_def def = pe_world_def_default();
    def.allocator = (pe_allocator){count_allocate, count_release, c};
    return make_world(&def);
}

static void test_nothing_is_allocated_after_warm_up(void **state)
{
    (void)state;
    counter c = {.fail_at = -1, .lasting = true};
    pe_world *world = counted_world(&c);
    pe_body_id ids[8];
    add_tower(world, 8, (pe_material_id){0}, ids);
    for (int i = 0; i < 300; ++i) {
        soft_step(world, H, NULL); /* while it settles, corners gain and lose points */
    }
    int made = c.calls;
    for (int i = 0; i < 100; ++i) {
        soft_step(world, H, NULL);
    }
    assert_int_equal(c.calls, made);
    pe_world_destroy(world);
    assert_int_equal(c.living, 0);
}

static void test_failed_allocation_changes_nothing(void **state)
{
    (void)state;
    int failed = 0;
    for (int k = 0;; ++k) {
        counter c = {.fail_at = -1, .lasting = true};
        pe_world *world = counted_world(&c);
        pe_body_id ids[WALL_BODIES];
        add_wall_and_ball(world, ids);
        pe_material_id springy = add_material(world, 0.5, 0.5);
        pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(20, 0, 0.5));
        def.material = springy;
        add_body(world, &def);
        soft_case now;
        /* The arena is empty until the first step: each piece of it is an allocation. */
        assert_int_equal(soft_prepare(world, H, &now), PE_OK);
        size_t poses = (size_t)world->slot_count * sizeof(pe_pose);
        size_t twists = (size_t)world->slot_count * sizeof(pe_twist);
        size_t points = (size_t)world->contacts.point_count * sizeof(pe_manifold_point);
        char *before = malloc(poses + twists + points);
        memcpy(before, pe_poses(world), poses);
        memcpy(before + poses, pe_twists(world), twists);
        memcpy(before + poses + twists, pe_manifold_points(&world->contacts), points);
        c.fail_at = c.calls + k;
        pe_error error = {0};
        pe_status status = pe_soft_step(world, &now.all, H, NULL, NULL, &error);
        if (status != PE_OK) {
            failed += 1;
            assert_int_equal(status, PE_NO_MEMORY);
            assert_contains(error.message, "no memory for");
            assert_memory_equal(before, pe_poses(world), poses);
            assert_memory_equal(before + poses, pe_twists(world), twists);
            assert_memory_equal(before + poses + twists, pe_manifold_points(&world->contacts),
                                points);
        }
        free(before);
        pe_world_destroy(world);
        assert_int_equal(c.living, 0);
        if (status == PE_OK) {
            break;
        }
    }
    assert_true(failed >= 15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_lane_count_gives_the_same_bits),
        cmocka_unit_test(test_more_contacts_than_colours_are_solved),
        cmocka_unit_test(test_colours_share_no_body_points_planned_once),
        cmocka_unit_test(test_eight_point_manifold_carries_like_four_points),
        cmocka_unit_test(test_substeps_go_by_the_root_of_the_step),
        cmocka_unit_test(test_unchosen_island_is_not_touched),
        cmocka_unit_test(test_precession_and_rotation_keep_kinetic_energy),
        cmocka_unit_test(test_nothing_is_allocated_after_warm_up),
        cmocka_unit_test(test_failed_allocation_changes_nothing),
    };
    return cmocka_run_group_tests_name("engine_soft_lanes", tests, NULL, NULL);
}
