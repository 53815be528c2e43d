/* The threads of a world: loops, and task systems of the caller. The bits of whole scenes are compared by
 * test_threads_slow.sh. */
#include "base/pool.h"
#include "base/vec3.h"
#include "check.h"
#include "world_for_tests.h"

static const double H = 1.0 / 60;

/* ---- Task systems ---- */

enum { MOST_TASKS = 16 };

/* Tasks that have not run yet. */
typedef struct queue {
    struct {
        void (*work)(void *argument);
        void *argument;
    } tasks[MOST_TASKS];
    int count, runs, waits;
} queue;

static void *run_later(void (*work)(void *argument), void *argument, void *context)
{
    queue *q = context;
    assert_true(q->count < MOST_TASKS);
    q->runs += 1;
    q->tasks[q->count].work = work;
    q->tasks[q->count].argument = argument;
    return &q->tasks[q->count++];
}

static void wait_for(void *task, void *context)
{
    queue *q = context;
    q->waits += 1;
    for (int i = 0; i < q->count; ++i) {
        if (task == &q->tasks[i]) {
            q->tasks[i].work(q->tasks[i].argument);
        }
    }
    q->count -=
        q->waits % 2 == 0 ? 2 : 0; /* both tasks of a loop of three threads are waited for */
}

/* Three threads; all zero: of the world's own. */
static pe_world_def def_with(pe_task_system tasks)
{
    pe_world_def def = pe_world_def_default();
    def.threads = 3;
    def.tasks = tasks;
    return def;
}

static pe_task_system tasks_later(queue *q)
{
    return (pe_task_system){run_later, wait_for, q};
}

/* The same thread always does the same work, and allocations are counted. */
static pe_world_def counted_def(counter *c)
{
    pe_world_def def = def_with(tasks_at_once(NULL));
    def.allocator = (pe_allocator){count_allocate, count_release, c};
    return def;
}

/* ---- Loops ---- */

enum { ITEMS = 1000, GRAIN = 7, LOOPS = 300 };

typedef struct tally {
    int done[ITEMS];
    bool in_use[8]; /* by worker */
} tally;

static void count_items(void *context, int worker, int begin, int end)
{
    tally *t = context;
    assert_true(begin % GRAIN == 0 && end <= ITEMS && end - begin <= GRAIN);
    assert_false(t->in_use[worker]);
    t->in_use[worker] = true;
    for (int i = begin; i < end; ++i) {
        for (volatile int k = 0; k < 100; ++k) {}
        t->done[i] += 1;
    }
    t->in_use[worker] = false;
}

static void check_loops(const pe_world_def *def)
{
    pe_allocator allocator = pe_allocator_default();
    pe_pool *pool;
    assert_int_equal(pe_pool_create(def, &allocator, &pool, NULL), PE_OK);
    assert_int_equal(pe_pool_threads(pool), def->threads);
    tally t = {{0}, {0}};
    for (int n = 1; n <= LOOPS; ++n) {
        pe_pool_run(pool, ITEMS, GRAIN, count_items, &t);
        for (int i = 0; i < ITEMS; ++i) {
            assert_int_equal(t.done[i], n);
        }
    }
    pe_pool_destroy(pool, &allocator);
}

static void test_loops_do_every_item_once(void **state)
{
    (void)state;
    queue q = {.count = 0};
    int runs = 0;
    for (int threads = 1; threads <= 8; ++threads) {
        pe_world_def def = def_with((pe_task_system){0});
        def.threads = threads;
        check_loops(&def);
    }
    pe_world_def at_once = def_with(tasks_at_once(&runs)), later = def_with(tasks_later(&q));
    check_loops(&at_once);
    assert_int_equal(runs, 2 * LOOPS);
    check_loops(&later);
    assert_int_equal(q.runs, 2 * LOOPS);
    assert_int_equal(q.waits, 2 * LOOPS);
}

/* ---- Worlds ---- */

enum { ROWS = 30, STEPS = 20 };

static pe_world *make_field(const pe_world_def *def, pe_body_id *last)
{
    pe_world *world = make_world(def);
    pe_material_id material = add_material(world, 0.4, 0.2);
    add_plane(world, pe_v3(0, 0, 1), material);
    for (int i = 0; i < ROWS * ROWS; ++i) {
        const int row = i / ROWS;
        pe_body_def box =
            box_def(0.5, 0.5, 0.5, pe_v3(1.3 * (i % ROWS), 1.3 * row, 0.5 + 0.001 * (i % 100)));
        box.material = material;
        *last = add_body(world, &box);
    }
    return world;
}

/* The state of the last body after some steps. */
static pe_body_state end_of_field(const pe_world_def *def)
{
    pe_body_id last;
    pe_world *world = make_field(def, &last);
    for (int i = 0; i < STEPS; ++i) {
        step(world, H);
    }
    pe_body_state state = state_of(world, last);
    pe_world_destroy(world);
    return state;
}

static void test_task_systems_give_the_same_bits(void **state)
{
    (void)state;
    queue q = {.count = 0};
    pe_world_def one = pe_world_def_default();
    int runs = 0;
    const pe_world_def others[] = {def_with((pe_task_system){0}), def_with(tasks_at_once(&runs)),
                                   def_with(tasks_later(&q))};
    const pe_body_state expected = end_of_field(&one);
    for (int i = 0; i < 3; ++i) {
        pe_body_state found = end_of_field(&others[i]);
        assert_memory_equal(&found, &expected, sizeof found);
    }
    assert_true(runs > 2 * STEPS && q.runs == runs);
    assert_int_equal(q.count, 0);
}

static void test_bad_threads_are_refused(void **state)
{
    (void)state;
    queue q = {.count = 0};
    pe_world *world;
    pe_error error;
    pe_world_def def = pe_world_def_default();
    def.threads = 0;
    assert_int_equal(pe_world_create(&def, &world, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, "threads: expected 1 to 256, found 0");
    def.threads = PE_MOST_THREADS + 1;
    assert_int_equal(pe_world_create(&def, &world, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, "found 257");
    def = def_with(tasks_later(&q));
    def.tasks.wait = NULL;
    assert_int_equal(pe_world_create(&def, &world, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, "tasks");
}

/* With a task system the order of allocations is the same in every run. */
static void test_threads_report_every_failed_allocation(void **state)
{
    (void)state;
    counter c = {.fail_at = -1};
    pe_world_def def = counted_def(&c);
    pe_body_id last;
    pe_world_destroy(make_field(&def, &last));
    const int created = c.calls;
    for (int k = 0; k < created && k < 8; ++k) {
        pe_world *world;
        pe_error error;
        c = (counter){.fail_at = k};
        pe_status status = pe_world_create(&def, &world, &error);
        assert_int_equal(status, k < c.calls ? PE_NO_MEMORY : PE_OK);
        pe_world_destroy(world);
        assert_int_equal(c.living, 0);
    }
    for (int k = 0; k < 60; ++k) {
        c = (counter){.fail_at = -1};
        pe_world *world = make_field(&def, &last);
        const pe_body_state before = state_of(world, last);
        c.fail_at = c.calls + k;
        pe_status status = pe_world_step(world, H, NULL, NULL);
        if (status != PE_OK) {
            const pe_body_state after = state_of(world, last);
            assert_int_equal(status, PE_NO_MEMORY);
            assert_memory_equal(&before, &after, sizeof before);
            assert_int_equal(pe_world_step(world, H, NULL, NULL), PE_OK);
        }
        pe_world_destroy(world);
        assert_int_equal(c.living, 0);
    }
}

static void test_threads_allocate_nothing_after_warm_up(void **state)
{
    (void)state;
    counter c = {.fail_at = -1};
    pe_world_def def = counted_def(&c);
    pe_body_id last;
    pe_world *world = make_field(&def, &last);
    check_allocates_nothing(world, &c, 200, 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_loops_do_every_item_once),
        cmocka_unit_test(test_task_systems_give_the_same_bits),
        cmocka_unit_test(test_bad_threads_are_refused),
        cmocka_unit_test(test_threads_report_every_failed_allocation),
        cmocka_unit_test(test_threads_allocate_nothing_after_warm_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
