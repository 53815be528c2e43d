/* Bodies at rest: what a heap costs, and work that is not tried again at once where it failed. */
#include "check.h"
#include "model/world.h"
#include "random_pose.h"
#include "world_for_tests.h"

#include <math.h>

static const double H = 1.0 / 60;

enum { BOXES = 20 };

/* Boxes thrown into a box of four walls, 1.6 m wide. */
static pe_world *make_heap(uint64_t seed, pe_profile profile, pe_body_id *ids)
{
    check_random random = {seed};
    pe_world_def world_def = pe_world_def_default();
    world_def.profile = profile;
    pe_world *world = make_world(&world_def);
    pe_material_id material = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), material);
    for (int k = 0; k < 4; ++k) {
        double x = k < 2 ? 1.3 - 2.6 * k : 0, y = k < 2 ? 0 : 1.3 - 2.6 * (k - 2);
        pe_body_def wall = box_def(k < 2 ? 0.5 : 2, k < 2 ? 2 : 0.5, 5, pe_v3(x, y, 5));
        wall.is_static = true;
        wall.material = material;
        add_body(world, &wall);
    }
    for (int i = 0; i < BOXES; ++i) {
        pe_vec3 e = random_vector_in(&random, 0.12, 0.25);
        const int layer = i / 4;
        pe_vec3 at = pe_v3(i % 2 ? 0.35 : -0.35, i / 2 % 2 ? 0.35 : -0.35, 0.5 + 0.9 * layer);
        pe_body_def def = box_def(e.x, e.y, e.z, at);
        def.mass = 8000 * e.x * e.y * e.z;
        def.orientation = random_turn(&random);
        def.velocity = random_vector(&random, 1);
        def.angular_velocity = random_vector(&random, 1);
        def.material = material;
        ids[i] = add_body(world, &def);
    }
    return world;
}

enum { TO_REST = 600, COUNTED = 100 };

/* A heap after TO_REST steps. Heaps 2k and 2k + 1 begin alike, and differ in their profile. */
static pe_world *heap_at_rest(int heap, pe_body_id *ids)
{
    const int pair = heap / 2;
    const pe_profile profile = heap % 2 ? PE_PROFILE_ACCURATE : PE_PROFILE_DEFAULT;
    pe_world *world = make_heap(1 + (uint64_t)pair, profile, ids);
    for (int n = 0; n < TO_REST; ++n) {
        step(world, H);
    }
    return world;
}

/* What a heap costs in COUNTED steps, and how far a box goes in them. */
typedef struct cost {
    int iterations, rounds;
    double drift; /* m */
} cost;

static cost cost_of_rest(int heap)
{
    pe_body_id ids[BOXES];
    pe_vec3 begin[BOXES];
    cost c = {0};
    pe_world *world = heap_at_rest(heap, ids);
    for (int i = 0; i < BOXES; ++i) {
        begin[i] = state_of(world, ids[i]).position;
    }
    for (int n = 0; n < COUNTED; ++n) {
        pe_step_stats s = step(world, H);
        c.iterations += s.iterations;
        c.rounds += s.projection_rounds;
    }
    for (int i = 0; i < BOXES; ++i) {
        pe_vec3 moved = pe_sub(state_of(world, ids[i]).position, begin[i]);
        c.drift = fmax(c.drift, pe_length(moved));
    }
    pe_world_destroy(world);
    return c;
}

enum { HEAPS = 20 };

static void test_heaps_at_rest_cost_little_and_stay(void **state)
{
    (void)state;
    int cheap = 0, still = 0;
    for (int k = 0; k < HEAPS; ++k) {
        cost c = cost_of_rest(k);
        print_message("    heap %d: %d iterations, %d rounds, %g m\n", k, c.iterations, c.rounds,
                      c.drift);
        assert_true(c.iterations <= 5 * COUNTED);
        assert_true(c.rounds <= COUNTED / 8);
        /* A heap whose contacts change once more is swept, to 2e-4 m/s, for a few steps. */
        assert_at_most(c.drift, 3 * 2e-4 * H);
        still += c.drift <= 1e-6;
        cheap += c.iterations <= 2 * COUNTED;
    }
    print_message("    %d of %d heaps take 2 iterations a step or fewer\n", cheap, HEAPS);
    assert_true(4 * cheap >= 3 * HEAPS);
    assert_true(10 * still >= 9 * HEAPS);
}

/* ---- Work that fails ---- */

enum { STEPS = 300 };

/* When work that always fails is tried. */
typedef struct retry {
    int due; /* step */
    pe_backoff now;
} retry;

/* Checks step n, in which it was tried or not. */
static void check_retry(retry *r, int n, bool tried, pe_backoff noted)
{
    assert_int_equal(tried, n == r->due);
    if (tried) {
        r->now = pe_backoff_after(true, r->now.pause);
        r->due = n + 1 + r->now.wait;
    } else {
        r->now.wait -= 1;
    }
    assert_int_equal(noted.wait, r->now.wait);
    assert_int_equal(noted.pause, r->now.pause);
}

static void test_pauses_double_until_the_work_succeeds(void **state)
{
    (void)state;
    static const int pauses[] = {1, 2, 4, 8, 16, 32, 64, 64, 64};
    pe_backoff b = {0};
    for (int k = 0; k < 9; ++k) {
        b = pe_backoff_after(true, b.pause);
        assert_int_equal(b.pause, pauses[k]);
        assert_int_equal(b.wait, pauses[k]);
    }
    b = pe_backoff_after(false, b.pause);
    assert_int_equal(b.pause, 0);
    assert_int_equal(b.wait, 0);
    assert_int_equal(pe_backoff_after(true, 33).pause, PE_MOST_PAUSE);
}

/* A cube at rest that is a little in the ground: no motion pays for a lift. */
static void test_correction_taken_back_waits_ever_longer(void **state)
{
    (void)state;
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_ACCURATE; ++profile) {
        pe_world_def def = pe_world_def_default();
        def.profile = (pe_profile)profile;
        pe_world *world = make_world(&def);
        add_plane(world, pe_v3(0, 0, 1), add_material(world, 0.5, 0));
        pe_body_def cube = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0.5 - 1e-5));
        pe_body_id id = add_body(world, &cube);
        int slot = (int)id.index;
        retry r = {0};
        for (int n = 0; n < STEPS; ++n) {
            bool tried = step(world, H).projection_rounds > 0;
            check_retry(&r, n, tried, pe_records(world)[slot].correction);
            assert_close(state_of(world, id).position.z, cube.position.z, 1e-9, 0);
        }
        assert_int_equal(r.now.pause, PE_MOST_PAUSE);
        pe_world_destroy(world);
    }
}

enum { ROWS = 5 };

/* Cubes in rows of ROWS, ROWS - 1, ..., 1, whose problem needs more than one iteration. */
static void test_failed_direct_solver_waits_ever_longer(void **state)
{
    (void)state;
    pe_world_def def = pe_world_def_default();
    def.max_iterations = 1;
    pe_world *world = make_world(&def);
    pe_material_id material = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), material);
    int slot = 0;
    for (int row = 0; row < ROWS; ++row) {
        for (int i = 0; i < ROWS - row; ++i) {
            pe_body_def cube = box_def(0.5, 0.5, 0.5, pe_v3(1.1 * (i + 0.5 * row), 0, row + 0.5));
            cube.material = material;
            slot = (int)add_body(world, &cube).index;
        }
    }
    retry r = {0};
    for (int n = 0; n < STEPS; ++n) {
        bool tried = step(world, H).factor_flops > 0;
        check_retry(&r, n, tried, pe_records(world)[slot].direct);
    }
    assert_int_equal(r.now.pause, PE_MOST_PAUSE);
    pe_world_destroy(world);
}

/* ---- Islands that are held ---- */

/* Whether the step before tried in vain to solve a box's island, so that the next may hold it. */
static bool is_held(const pe_world *world, pe_body_id id)
{
    const pe_record *r = &pe_records(world)[id.index];
    return r->put_back && r->direct.wait > 0 && r->settling.wait > 0;
}

/* Throws up or lifts the topmost box of a heap at rest, and returns how far a box then goes in a
 * quarter of a second, in m. */
static double way_after(pe_world *world, const pe_body_id *ids, int disturbance)
{
    pe_vec3 begin[BOXES];
    double most = 0;
    int top = 0;
    for (int i = 0; i < BOXES; ++i) {
        begin[i] = pe_poses(world)[ids[i].index].position;
        top = begin[i].z > begin[top].z ? i : top;
    }
    if (disturbance == 0) {
        pe_body_state s = state_of(world, ids[top]);
        s.velocity.z = 2;
        assert_int_equal(pe_body_set_state(world, ids[top], &s, NULL), PE_OK);
    }
    for (int n = 0; n < 15; ++n) {
        if (disturbance == 1) {
            const pe_vec3 up = {0, 0, 30 * pe_masses(world)[ids[top].index].mass};
            assert_int_equal(
                pe_body_apply_force(world, ids[top], up, pe_v3(0, 0, 0), PE_FRAME_WORLD, NULL),
                PE_OK);
        }
        step(world, H);
    }
    for (int i = 0; i < BOXES; ++i) {
        pe_vec3 now = pe_poses(world)[ids[i].index].position;
        most = pe_max(most, pe_length(pe_sub(now, begin[i])));
    }
    return most;
}

enum { SOME_HEAPS = 8 };

static void test_held_heap_moves_when_it_is_disturbed(void **state)
{
    (void)state;
    int held = 0;
    for (int k = 0; k < SOME_HEAPS; ++k) {
        for (int disturbance = 0; disturbance < 2; ++disturbance) {
            pe_body_id ids[BOXES];
            pe_world *world = heap_at_rest(k, ids);
            bool any = false;
            for (int i = 0; i < BOXES; ++i) {
                any |= is_held(world, ids[i]);
            }
            held += any;
            assert_true(!any || way_after(world, ids, disturbance) > 1e-3);
            pe_world_destroy(world);
        }
    }
    print_message("    %d of %d heaps were held\n", held, 2 * SOME_HEAPS);
#ifndef PLUMB_TEST_AMD
    if (held == 0) {
        skip(); /* in another elimination order the direct solver may not fail */
    }
#endif
    assert_true(held >= 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_heaps_at_rest_cost_little_and_stay),
        cmocka_unit_test(test_pauses_double_until_the_work_succeeds),
        cmocka_unit_test(test_correction_taken_back_waits_ever_longer),
        cmocka_unit_test(test_failed_direct_solver_waits_ever_longer),
        cmocka_unit_test(test_held_heap_moves_when_it_is_disturbed),
    };
    return cmocka_run_group_tests_name("engine_heaps", tests, NULL, NULL);
}
