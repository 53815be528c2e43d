/* One large island on the threads of a world: the same bits for any number of them, and no allocation
 * after warm-up. */
#include "base/pool.h"
#include "base/vec3.h"
#include "check.h"
#include "contact_problem_for_tests.h"
#include "counting_allocator.h"
#include "solver/kernels.h"
#include "solver/solve_newton.h"
#include "world_for_tests.h"

#include <stdlib.h>
#include <string.h>

static const int THREADS[] = {1, 2, 3, 8};
enum { COUNTS = 4 };

/* ---- Problems ---- */

/* A problem on some threads. */
typedef struct shared_problem {
    pe_allocator allocator;
    pe_arena arena;
    pe_pool *pool;
    pe_workspace work;
    pe_problem problem;
} shared_problem;

static void share(shared_problem *s, const pe_contact_problem *source, int threads)
{
    pe_world_def def = pe_world_def_default();
    def.threads = threads;
    *s = (shared_problem){.allocator = pe_allocator_default()};
    assert_int_equal(pe_pool_create(&def, &s->allocator, &s->pool, NULL), PE_OK);
    s->work = (pe_workspace){&s->arena, &s->allocator, s->pool};
    assert_int_equal(pe_problem_of_data(source, s->work, &s->problem, NULL), PE_OK);
    assert_true((s->problem.side != NULL) == (threads > 1));
}

static void end_sharing(shared_problem *s)
{
    pe_arena_free(&s->arena, &s->allocator);
    pe_pool_destroy(s->pool, &s->allocator);
}

static uint64_t hash_of(uint64_t hash, const void *memory, size_t size)
{
    const unsigned char *bytes = memory;
    for (size_t i = 0; i < size; ++i) {
        hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
    }
    return hash;
}

/* Of the impulses, the velocities and the residual. */
static uint64_t hash_problem(uint64_t hash, const pe_problem *problem)
{
    pe_residual residual = pe_problem_residual(problem);
    hash = hash_of(hash, problem->impulse, (size_t)problem->point_count * sizeof *problem->impulse);
    hash =
        hash_of(hash, problem->velocity, (size_t)problem->body_count * sizeof *problem->velocity);
    return hash_of(hash, &residual, sizeof residual);
}

enum { SPARSE_BODIES = 3000, SPARSE_MANIFOLDS = 4500 };

/* Some sweeps of the problem, by `sweep_once`. */
static uint64_t hash_sweeps(uint64_t hash, shared_problem *s, pe_sweep *sweep,
                            void (*sweep_once)(pe_sweep *sweep))
{
    int shared = 0;
    for (int i = 0; i < sweep->stages.count; ++i) {
        shared += sweep->stages.of[i].shared;
    }
    assert_true(shared >= 2);
    const pe_sweep_part whole = pe_sweep_whole(sweep);
    for (int n = 0; n < 6; ++n) {
        pe_sweep_set_beta(sweep, &whole, 0.1 * n);
        sweep_once(sweep);
    }
    const pe_violation violation = pe_sweep_violation(sweep);
    pe_sweep_store(sweep, &whole);
    pe_problem_rebuild_velocity(&s->problem);
    return hash_problem(hash_of(hash, &violation, sizeof violation), &s->problem);
}

/* Sweeps over all cones, and then over the normals of two thirds of the manifolds. */
static uint64_t hash_of_sweeps(const pe_contact_problem *source, int threads)
{
    static bool chosen[SPARSE_MANIFOLDS];
    const pe_sweep_kernel *kernel = pe_kernels_for(0)->sweep;
    shared_problem s;
    pe_sweep sweep;
    double worst;
    share(&s, source, threads);
    uint64_t hash = hash_problem(UINT64_C(14695981039346656037), &s.problem);
    assert_int_equal(pe_sweep_create(&s.problem, kernel, s.work, &sweep, NULL), PE_OK);
    hash = hash_sweeps(hash, &s, &sweep, pe_sweep_cones);
    const pe_sweep_part whole = pe_sweep_whole(&sweep);
    pe_sweep_residuals(&sweep, &whole, 1, &worst);
    hash = hash_of(hash, &worst, sizeof worst);
    for (int i = 0; i < SPARSE_MANIFOLDS; ++i) {
        chosen[i] = i % 3 != 0;
    }
    assert_int_equal(pe_sweep_create_normals(&s.problem, chosen, kernel, s.work, &sweep, NULL),
                     PE_OK);
    hash = hash_sweeps(hash, &s, &sweep, pe_sweep_normals);
    end_sharing(&s);
    return hash;
}

static void test_sweeps_do_not_depend_on_threads(void **state)
{
    (void)state;
    pe_contact_problem *source = problem_at_random(7, SPARSE_BODIES, SPARSE_MANIFOLDS);
    const uint64_t expected = hash_of_sweeps(source, 1);
    for (int i = 1; i < COUNTS; ++i) {
        assert_true(hash_of_sweeps(source, THREADS[i]) == expected);
    }
    pe_contact_problem_destroy(source);
}

enum { GRID = 40, GRID_PAIRS = 2 * GRID * (GRID - 1) };

/* A square grid of bodies, each with its neighbours: its factor has wide columns. */
static pe_contact_problem *problem_of_grid(void)
{
    static int pairs[GRID_PAIRS][2];
    int count = 0;
    for (int i = 0; i < GRID * GRID; ++i) {
        if (i % GRID + 1 < GRID) {
            pairs[count][0] = i;
            pairs[count++][1] = i + 1;
        }
        if (i + GRID < GRID * GRID) {
            pairs[count][0] = i;
            pairs[count++][1] = i + GRID;
        }
    }
    assert_int_equal(count, GRID_PAIRS);
    return problem_of_pairs(3, GRID * GRID, (const int(*)[2])pairs, count);
}

/* A few iterations of Newton's method. */
static uint64_t hash_of_newton(const pe_contact_problem *source, int threads)
{
    shared_problem s;
    share(&s, source, threads);
    const pe_solve_limits limits = {1e-9, 4};
    pe_pattern pattern;
    pe_newton_settings settings;
    assert_int_equal(pe_newton_prepare(&s.problem, &limits, s.work, &pattern, &settings, NULL),
                     PE_OK);
    int widest = 0;
    for (int k = 0; k < pattern.count; ++k) {
        const int width = pattern.start[k + 1] - pattern.start[k];
        widest = width > widest ? width : widest;
    }
    assert_true(widest > 40);
    pe_solve_report report = {0};
    assert_int_equal(pe_newton(&s.problem, &settings, &limits, s.work, &report, NULL), PE_OK);
    assert_int_equal(report.iterations, 4);
    const uint64_t hash = hash_problem(UINT64_C(14695981039346656037), &s.problem);
    end_sharing(&s);
    return hash;
}

static void test_factors_do_not_depend_on_threads(void **state)
{
    (void)state;
    pe_contact_problem *source = problem_of_grid();
    const uint64_t expected = hash_of_newton(source, 1);
    for (int i = 1; i < COUNTS; ++i) {
        assert_true(hash_of_newton(source, THREADS[i]) == expected);
    }
    pe_contact_problem_destroy(source);
}

/* ---- Worlds ---- */

enum { ROWS = 16, COLUMNS = 40, BRICKS = ROWS * COLUMNS, STEPS = 2 };
static const double H = 1.0 / 60;

/* A wall of bricks that overlap by 2 mm and move in different ways. */
static pe_world *make_moving_wall(const pe_world_def *def, pe_body_id ids[BRICKS])
{
    pe_world *world = make_world(def);
    pe_material_id material = add_material(world, 0.5, 0.3);
    add_plane(world, pe_v3(0, 0, 1), material);
    for (int i = 0; i < BRICKS; ++i) {
        const int row = i / COLUMNS, column = i % COLUMNS;
        pe_body_def brick =
            box_def(0.2, 0.1, 0.1, pe_v3(0.398 * column + 0.2 * (row % 2), 0, 0.098 + 0.198 * row));
        brick.material = material;
        brick.velocity = pe_v3(0.01 * (i % 7), 0.3 + 0.02 * (i % 5), -0.01 * (i % 3));
        ids[i] = add_body(world, &brick);
    }
    return world;
}

/* Steps the wall, and leaves the states of its bricks. */
static void step_wall(pe_profile profile, int threads, pe_body_state states[BRICKS])
{
    static pe_body_id ids[BRICKS];
    pe_world_def def = pe_world_def_default();
    def.profile = profile;
    def.threads = threads;
    pe_world *world = make_moving_wall(&def, ids);
    int corrected = 0;
    for (int i = 0; i < STEPS; ++i) {
        pe_step_stats stats = step(world, H);
        corrected += stats.projection_rounds;
        assert_int_equal(stats.islands, 1);
        assert_int_equal(
            stats.islands_by_path[profile == PE_PROFILE_FAST ? PE_PATH_SOFT : PE_PATH_SWEEPS], 1);
    }
    assert_true(corrected > 0);
    for (int i = 0; i < BRICKS; ++i) {
        states[i] = state_of(world, ids[i]);
    }
    pe_world_destroy(world);
}

static void test_large_islands_do_not_depend_on_threads(void **state)
{
    (void)state;
    static pe_body_state expected[BRICKS], found[BRICKS];
    static const pe_profile profiles[] = {PE_PROFILE_DEFAULT, PE_PROFILE_FAST};
    for (int k = 0; k < 2; ++k) {
        step_wall(profiles[k], 1, expected);
        for (int i = 1; i < COUNTS; ++i) {
            step_wall(profiles[k], THREADS[i], found);
            assert_memory_equal(found, expected, sizeof expected);
        }
    }
}

static void test_large_islands_allocate_nothing_after_warm_up(void **state)
{
    (void)state;
    static pe_body_id ids[BRICKS];
    static const pe_profile profiles[] = {PE_PROFILE_DEFAULT, PE_PROFILE_FAST};
    for (int k = 0; k < 2; ++k) {
        counter c = {.fail_at = -1};
        pe_world_def def = pe_world_def_default();
        def.profile = profiles[k];
        def.threads = 3;
        def.tasks = tasks_at_once(NULL);
        def.allocator = (pe_allocator){count_allocate, count_release, &c};
        pe_world *world = make_moving_wall(&def, ids);
        check_allocates_nothing(world, &c, 4, 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sweeps_do_not_depend_on_threads),
        cmocka_unit_test(test_factors_do_not_depend_on_threads),
        cmocka_unit_test(test_large_islands_do_not_depend_on_threads),
        cmocka_unit_test(test_large_islands_allocate_nothing_after_warm_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
