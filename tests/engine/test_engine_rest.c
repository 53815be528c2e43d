/* Islands at rest: what they report, what wakes them, and that they wake as they were. */
#include "check.h"
#include "model/rest.h"
#include "world_for_tests.h"

static const double H = 1.0 / 60;
enum { CUBES = 3, SETTLING = 20 };

/* A tower, and a ball far from it that never rests. */
typedef struct scene {
    pe_world *world;
    pe_body_id floor, ball, cubes[CUBES];
} scene;

static scene make_scene(pe_profile profile)
{
    pe_world_def def = pe_world_def_default();
    def.profile = profile;
    scene s = {.world = make_world(&def)};
    pe_material_id rough = add_material(s.world, 0.5, 0), smooth = add_material(s.world, 0, 0);
    add_tower(s.world, CUBES, rough, s.cubes);
    s.floor = (pe_body_id){s.cubes[0].index - 1, s.cubes[0].generation};
    pe_body_def ball = pe_body_def_default();
    ball.material = smooth;
    ball.position = pe_v3(-6, 0, 0.5);
    ball.velocity = pe_v3(2, 0, 0);
    s.ball = add_body(s.world, &ball);
    return s;
}

static int resting(const scene *s)
{
    return s->world->rest->totals.bodies;
}

/* The scene when the tower rests, and the ball is still far away. */
static scene make_settled(pe_profile profile)
{
    scene s = make_scene(profile);
    for (int i = 0; i < SETTLING; ++i) {
        step(s.world, H);
    }
    assert_int_equal(resting(&s), CUBES);
    return s;
}

static void test_tower_comes_to_rest_with_velocities_of_zero(void **state)
{
    (void)state;
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_FAST; ++profile) {
        scene s = make_settled((pe_profile)profile);
        for (int i = 0; i < CUBES; ++i) {
            pe_body_state now = state_of(s.world, s.cubes[i]);
            assert_true(pe_length(now.velocity) == 0 && pe_length(now.angular_velocity) == 0);
            assert_close(now.position.z, 0.5 + i, 1e-12, 0);
        }
        pe_world_destroy(s.world);
    }
}

static void test_resting_contacts_are_reported_and_bear_the_weight(void **state)
{
    (void)state;
    scene s = make_settled(PE_PROFILE_DEFAULT);
    pe_step_stats stats = step(s.world, H);
    assert_int_equal(stats.islands, 2);
    assert_int_equal(stats.manifolds, CUBES + 1);
    assert_int_equal(stats.contacts, 4 * CUBES + 1);
    assert_int_equal(stats.islands_by_path[PE_PATH_WARM], 2);
    pe_contact contacts[8 * CUBES];
    int count = pe_world_get_contacts(s.world, contacts, 8 * CUBES), on_first = 0;
    assert_int_equal(count, 4 * CUBES + 1);
    double weight = 0;
    for (int i = 0; i < count; ++i) {
        if (contacts[i].body_a.index == s.floor.index &&
            contacts[i].body_b.index == s.cubes[0].index) {
            weight += contacts[i].impulse.z;
            on_first += 1;
            assert_close(contacts[i].acts.arm_b.z, -0.5, 1e-12, 0);
        }
    }
    assert_int_equal(on_first, 4);
    assert_close(weight, CUBES * 9.81 * H, 1e-11, 0);
    pe_world_destroy(s.world);
}

static void test_a_body_that_arrives_wakes_an_island(void **state)
{
    (void)state;
    scene s = make_settled(PE_PROFILE_DEFAULT);
    int woken_at = -1;
    for (int i = 0; i < 180 && woken_at < 0; ++i) {
        step(s.world, H);
        woken_at = resting(&s) == 0 ? i : -1;
        if (woken_at < 0) { /* until then it is as it was */
            assert_true(pe_length(state_of(s.world, s.cubes[0]).velocity) == 0);
        }
    }
    pe_vec3 ball = state_of(s.world, s.ball).position;
    assert_true(woken_at >= 0);
    assert_true(ball.x > -1.1 && ball.x < -0.9);
    /* Contacts of the step in which it woke are all listed. */
    assert_true(pe_world_get_contacts(s.world, NULL, 0) >= 4 * CUBES + 1);
    double fastest = 0;
    for (int i = 0; i < 3; ++i) {
        step(s.world, H);
        fastest = pe_max(fastest, state_of(s.world, s.cubes[0]).velocity.x);
    }
    assert_true(fastest > 0.1);
    pe_world_destroy(s.world);
}

static void test_an_applied_force_wakes_an_island(void **state)
{
    (void)state;
    scene s = make_settled(PE_PROFILE_DEFAULT);
    const pe_vec3 force = {0, 40, 0}, centre = {0, 0, 0};
    assert_int_equal(pe_body_apply_force(s.world, s.cubes[2], force, centre, PE_FRAME_WORLD, NULL),
                     PE_OK);
    step(s.world, H);
    assert_int_equal(resting(&s), 0);
    /* Friction holds back a half of the weight, 4.9 N, of 40 N. */
    assert_close(state_of(s.world, s.cubes[2]).velocity.y, (40 - 0.5 * 9.81) * H, 1e-6, 0);
    pe_world_destroy(s.world);
}

static void test_changed_bodies_and_materials_wake_all(void **state)
{
    (void)state;
    scene s = make_settled(PE_PROFILE_DEFAULT);
    assert_int_equal(pe_body_destroy(s.world, s.cubes[0], NULL), PE_OK);
    step(s.world, H);
    for (int i = 1; i < CUBES; ++i) {
        assert_close(state_of(s.world, s.cubes[i]).velocity.z, -9.81 * H, 1e-9, 0);
    }
    pe_world_destroy(s.world);

    s = make_settled(PE_PROFILE_DEFAULT);
    pe_body_state tilted = state_of(s.world, s.floor);
    pe_body_state top = state_of(s.world, s.cubes[2]);
    top.position.z += 0.2;
    assert_int_equal(pe_body_set_state(s.world, s.cubes[2], &top, NULL), PE_OK);
    assert_int_equal(pe_body_set_state(s.world, s.floor, &tilted, NULL), PE_OK);
    step(s.world, H);
    assert_close(state_of(s.world, s.cubes[2]).velocity.z, -9.81 * H, 1e-9, 0);
    pe_world_destroy(s.world);
}

/* Waking changes nothing of an island by itself. */
static void test_a_woken_island_rests_again_as_it_was(void **state)
{
    (void)state;
    scene s = make_settled(PE_PROFILE_DEFAULT);
    pe_body_state before[CUBES], after[CUBES];
    for (int i = 0; i < CUBES; ++i) {
        before[i] = state_of(s.world, s.cubes[i]);
    }
    for (int k = 0; k < 5; ++k) {
        wake_all(s.world);
        assert_int_equal(resting(&s), 0);
        step(s.world, H);
        assert_int_equal(resting(&s), CUBES);
        for (int i = 0; i < CUBES; ++i) {
            after[i] = state_of(s.world, s.cubes[i]);
        }
        assert_memory_equal(before, after, sizeof before);
    }
    pe_world_destroy(s.world);
}

/* A cube on ice that is tilted by less than a microradian gets faster by 1.6e-8 m/s a step. */
/* A body that is destroyed before its first step is in no list of resting bodies. */
static void test_new_bodies_can_go_beside_resting_ones(void **state)
{
    (void)state;
    enum { NEW = 1000 };
    scene s = make_settled(PE_PROFILE_DEFAULT);
    pe_body_id ids[NEW];
    pe_body_def def = pe_body_def_default();
    def.position = pe_v3(50, 0, 50);
    for (int i = 0; i < NEW; ++i) {
        ids[i] = add_body(s.world, &def);
    }
    for (int i = 0; i < NEW; ++i) {
        assert_int_equal(pe_body_destroy(s.world, ids[i], NULL), PE_OK);
    }
    assert_int_equal(resting(&s), CUBES);
    step(s.world, H);
    assert_int_equal(resting(&s), CUBES);
    pe_world_destroy(s.world);
}

static void test_what_moves_slowly_does_not_rest(void **state)
{
    (void)state;
    const double tilt = 1e-7;
    pe_world *world = make_world(NULL);
    pe_material_id ice = add_material(world, 0, 0);
    add_plane(world, pe_v3(sin(tilt), 0, cos(tilt)), ice);
    pe_body_def cube = box_def(0.5, 0.5, 0.5, pe_v3(0.5 * sin(tilt), 0, 0.5 * cos(tilt)));
    cube.material = ice;
    cube.orientation = (pe_quat){cos(0.5 * tilt), 0, sin(0.5 * tilt), 0};
    pe_body_id id = add_body(world, &cube);
    for (int i = 0; i < 600; ++i) {
        step(world, H);
    }
    assert_close(state_of(world, id).velocity.x / (10 * 9.81 * sin(tilt)), 1, 1e-6, 0);
    pe_world_destroy(world);
}

/* Many islands that come to rest and wake at different times, until the store is compacted. */
static void test_islands_come_and_go_in_any_order(void **state)
{
    (void)state;
    enum { FIELD = 40, ROUNDS = 60 };
    pe_world *world = make_world(NULL);
    add_plane(world, pe_v3(0, 0, 1), add_material(world, 0.5, 0));
    pe_body_id ids[FIELD];
    for (int i = 0; i < FIELD; ++i) {
        pe_body_def box = box_def(0.5, 0.5, 0.5, pe_v3(2.0 * i, 0, 0.5));
        ids[i] = add_body(world, &box);
    }
    for (int n = 0; n < ROUNDS; ++n) {
        for (int i = n % 7; i < FIELD; i += 7) {
            pe_body_apply_force(world, ids[i], pe_v3(0, 3, 0), pe_v3(0, 0, 0), PE_FRAME_WORLD,
                                NULL);
        }
        pe_step_stats stats = step(world, H);
        assert_int_equal(stats.contacts, 4 * FIELD);
        assert_int_equal(pe_world_get_contacts(world, NULL, 0), 4 * FIELD);
        const pe_rest *rest = world->rest;
        assert_true(rest->contacts.manifold_count <= 3 * FIELD);
        for (int i = 0; i < FIELD; ++i) {
            assert_close(state_of(world, ids[i]).position.z, 0.5, 1e-12, 0);
            assert_true(pe_length(state_of(world, ids[i]).velocity) < 1e-12);
        }
    }
    for (int i = 0; i < 5; ++i) {
        step(world, H);
    }
    assert_int_equal(world->rest->totals.islands, FIELD);
    pe_world_destroy(world);
}

/* ---- Sleep ---- */

/* A ball that rolls at 2 cm/s on a plane. */
static pe_world *make_rolling(bool sleep, pe_body_id *ball)
{
    pe_world_def def = pe_world_def_default();
    def.sleep = sleep;
    pe_world *world = make_world(&def);
    pe_material_id rough = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), rough);
    pe_body_def rolling = pe_body_def_default();
    rolling.material = rough;
    rolling.position.z = 0.5;
    rolling.velocity.x = 0.02;
    rolling.angular_velocity.y = 0.04;
    *ball = add_body(world, &rolling);
    return world;
}

static void test_what_creeps_sleeps_only_if_asked(void **state)
{
    (void)state;
    for (int sleep = 0; sleep < 2; ++sleep) {
        pe_body_id ball;
        pe_world *world = make_rolling(sleep == 1, &ball);
        pe_step_stats stats = {0};
        for (int i = 0; i < 60; ++i) {
            stats = step(world, H);
        }
        assert_int_equal(stats.sleeping, sleep);
        /* It sleeps after a half of the second. */
        assert_close(state_of(world, ball).position.x, sleep ? 0.01 : 0.02, 0.02 * H, 0);
        assert_close(state_of(world, ball).velocity.x, sleep ? 0 : 0.02, 1e-9, 0);
        pe_world_destroy(world);
    }
}

static void test_sleep_says_how_far_a_body_would_have_moved(void **state)
{
    (void)state;
    pe_body_id ball;
    pe_world *world = make_rolling(true, &ball);
    for (int i = 0; i < 90; ++i) {
        assert_true(step(world, H).sleep_drift == 0);
    }
    const pe_vec3 force = {0, 1, 0}, centre = {0, 0, 0};
    pe_body_apply_force(world, ball, force, centre, PE_FRAME_WORLD, NULL);
    pe_step_stats stats = step(world, H);
    assert_int_equal(stats.sleeping, 0);
    /* The fastest point of the ball moves at twice its speed; it slept for a second. */
    assert_close(stats.sleep_drift, 0.04 * 1, 0.04 * 2 * H, 0);
    assert_true(state_of(world, ball).velocity.y > 0.01);
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tower_comes_to_rest_with_velocities_of_zero),
        cmocka_unit_test(test_resting_contacts_are_reported_and_bear_the_weight),
        cmocka_unit_test(test_a_body_that_arrives_wakes_an_island),
        cmocka_unit_test(test_an_applied_force_wakes_an_island),
        cmocka_unit_test(test_changed_bodies_and_materials_wake_all),
        cmocka_unit_test(test_a_woken_island_rests_again_as_it_was),
        cmocka_unit_test(test_what_moves_slowly_does_not_rest),
        cmocka_unit_test(test_islands_come_and_go_in_any_order),
        cmocka_unit_test(test_new_bodies_can_go_beside_resting_ones),
        cmocka_unit_test(test_what_creeps_sleeps_only_if_asked),
        cmocka_unit_test(test_sleep_says_how_far_a_body_would_have_moved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
