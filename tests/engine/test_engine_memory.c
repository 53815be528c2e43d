/* Memory: nothing allocated after warm-up, nothing lost when an allocation fails, nothing accepted
 * that the interface forbids. */
#include "base/memory.h"
#include "base/vec3.h"
#include "check.h"
#include "counting_allocator.h"
#include "world_for_tests.h"

static const double H = 1.0 / 60;

static pe_world_def counted(counter *c)
{
    pe_world_def def = pe_world_def_default();
    def.allocator = (pe_allocator){count_allocate, count_release, c};
    return def;
}

static void test_a_resting_scene_allocates_nothing_after_warm_up(void **state)
{
    (void)state;
    counter c = {.fail_at = -1};
    pe_world_def def = counted(&c);
    pe_world *world = make_world(&def);
    pe_body_id ids[8];
    add_tower(world, 8, (pe_material_id){0}, ids);
    check_allocates_nothing(world, &c, 10, 200);
}

/* Takes memory as 200 steps would: in each one block, of which the arena keeps what it needs. */
static size_t capacity_after(pe_arena *arena, const pe_allocator *allocator, size_t size)
{
    for (int i = 0; i < 200; ++i) {
        assert_non_null(pe_arena_take(arena, allocator, size, 1));
        pe_arena_reset(arena, allocator);
    }
    /* What can be taken without another block. */
    const size_t piece = 64;
    size_t taken = 0;
    assert_non_null(pe_arena_take(arena, allocator, piece, 1));
    const void *block = arena->last;
    while (arena->last == block) {
        taken += piece;
        assert_non_null(pe_arena_take(arena, allocator, piece, 1));
    }
    pe_arena_reset(arena, allocator);
    return taken;
}

static void test_arena_gives_back_what_was_long_unneeded(void **state)
{
    (void)state;
    const size_t large = 16 << 20, small = 4 << 20, tiny = 1 << 10;
    counter c = {.fail_at = -1};
    const pe_allocator allocator = {count_allocate, count_release, &c};
    pe_arena arena = {0};
    assert_true(capacity_after(&arena, &allocator, large) >= large);
    const size_t left = capacity_after(&arena, &allocator, small);
    assert_true(left >= small && left < 2 * small);
    /* A step that needs much now and then keeps it. */
    assert_true(capacity_after(&arena, &allocator, large) >= large);
    const int calls = c.calls;
    for (int i = 0; i < 200; ++i) {
        assert_non_null(pe_arena_take(&arena, &allocator, i % 50 == 0 ? large : tiny, 1));
        pe_arena_reset(&arena, &allocator);
    }
    assert_int_equal(c.calls, calls);
    pe_arena_free(&arena, &allocator);
    assert_int_equal(c.living, 0);
}

/* Builds a small scene and makes some steps; returns the first failure. */
static pe_status run_scene(const pe_world_def *def, pe_body_state *last)
{
    pe_world *world = NULL;
    pe_body_id id = {0};
    pe_status status = pe_world_create(def, &world, NULL);
    pe_material_id material = {0};
    if (status == PE_OK) {
        status = pe_material_create(world, 0.4, 0.1, &material, NULL);
    }
    pe_body_def floor_def = pe_body_def_default();
    floor_def.is_static = true;
    floor_def.shape = (pe_shape){.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}};
    if (status == PE_OK) {
        status = pe_body_create(world, &floor_def, &id, NULL);
    }
    for (int i = 0; i < 20 && status == PE_OK; ++i) {
        pe_body_def box = box_def(0.5, 0.5, 0.5, (pe_vec3){1.02 * (i % 4), 0, 0.5 + i / 4});
        box.material = material;
        status = pe_body_create(world, &box, &id, NULL);
    }
    for (int i = 0; i < 4 && status == PE_OK; ++i) {
        pe_body_state before = state_of(world, id);
        status = pe_world_step(world, H, NULL, NULL);
        pe_body_state after = state_of(world, id);
        if (status != PE_OK) {
            assert_memory_equal(&before, &after, sizeof before);
            /* The world is whole: with memory back, the same step succeeds. */
            assert_int_equal(pe_world_step(world, H, NULL, NULL), PE_OK);
        }
    }
    if (status == PE_OK) {
        *last = state_of(world, id);
    }
    pe_world_destroy(world);
    return status;
}

static void test_every_failed_allocation_is_reported_and_loses_nothing(void **state)
{
    (void)state;
    counter c = {.fail_at = -1};
    pe_world_def def = counted(&c);
    pe_body_state reference, last;
    assert_int_equal(run_scene(&def, &reference), PE_OK);
    assert_int_equal(c.living, 0);
    int total = c.calls;
    assert_true(total > 20);
    int reported = 0;
    for (int k = 0; k < total; ++k) {
        c = (counter){.fail_at = k};
        pe_status status = run_scene(&def, &last);
        assert_int_equal(c.living, 0);
        if (status == PE_OK) {
            /* Only the arena can do without new memory: it keeps its old block. */
            assert_memory_equal(&last, &reference, sizeof last);
        } else {
            assert_int_equal(status, PE_NO_MEMORY);
            reported += 1;
        }
    }
    assert_true(reported > 20);
}

static void expect_body_error(pe_world *world, pe_body_def def, const char *part)
{
    pe_error error = {0};
    pe_body_id id;
    assert_int_equal(pe_body_create(world, &def, &id, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, part);
    assert_int_equal(id.index, 0);
}

static void test_bad_bodies_are_refused_with_the_number_found(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_def good = box_def(1, 1, 1, (pe_vec3){0, 0, 0}), def;
    def = good, def.mass = 0;
    expect_body_error(world, def, "mass: expected a number in 1e-30 .. 1e+30, found 0");
    def = good, def.mass = NAN;
    expect_body_error(world, def, "mass");
    def = good, def.shape.half_extents.y = -2;
    expect_body_error(world, def, "(1, -2, 1)");
    def = good, def.position.x = INFINITY;
    expect_body_error(world, def, "position");
    def = good, def.orientation.w = 1.1;
    expect_body_error(world, def, "unit quaternion, found (1.1, 0, 0, 0)");
    def = good, def.inertia = (pe_vec3){1, 0, 1};
    expect_body_error(world, def, "inertia");
    def = good, def.material.index = 9;
    expect_body_error(world, def, "no material 9");
    def = good, def.shape = (pe_shape){.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}};
    expect_body_error(world, def, "a plane must be static");
    def.is_static = true, def.shape.normal.z = 2;
    expect_body_error(world, def, "unit normal");
    def = good, def.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0};
    expect_body_error(world, def, "radius above 0, found 0");
    pe_world_destroy(world);
}

static void test_bad_worlds_steps_and_ids_are_refused(void **state)
{
    (void)state;
    pe_error error;
    pe_world *world;
    pe_world_def def = pe_world_def_default();
    def.tolerance = 0;
    assert_int_equal(pe_world_create(&def, &world, &error), PE_BAD_ARGUMENT);
    assert_null(world);
    def = pe_world_def_default(), def.gravity.z = NAN;
    assert_int_equal(pe_world_create(&def, &world, &error), PE_BAD_ARGUMENT);

    world = make_world(NULL);
    assert_int_equal(pe_world_step(world, 0, NULL, &error), PE_BAD_ARGUMENT);
    assert_int_equal(pe_world_step(world, NAN, NULL, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, "dt");
    pe_body_def box = box_def(1, 1, 1, (pe_vec3){0, 0, 0});
    pe_body_id first = add_body(world, &box), null_id = {0};
    pe_body_state s;
    assert_int_equal(pe_body_get_state(world, null_id, &s, &error), PE_BAD_ARGUMENT);
    assert_int_equal(pe_body_destroy(world, first, &error), PE_OK);
    pe_body_id second = add_body(world, &box);
    assert_int_equal(second.index, first.index); /* the slot is used again, */
    assert_int_equal(pe_body_get_state(world, first, &s, &error), PE_BAD_ARGUMENT); /* the id not */
    assert_contains(error.message, "no living body");
    assert_int_equal(pe_body_get_state(world, second, &s, &error), PE_OK);
    pe_material_id material;
    assert_int_equal(pe_material_create(world, -1, 0, &material, &error), PE_BAD_ARGUMENT);
    assert_int_equal(pe_material_create(world, 0.5, 1.5, &material, &error), PE_BAD_ARGUMENT);
    pe_world_destroy(world);
    pe_world_destroy(NULL);
}

static void test_a_destroyed_body_leaves_nothing_behind(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[6];
    add_tower(world, 6, (pe_material_id){0}, ids);
    for (int i = 0; i < 20; ++i) {
        step(world, H);
    }
    pe_body_destroy(world, ids[2], NULL);
    pe_contact left[64];
    int count = pe_world_get_contacts(world, left, 64);
    assert_int_equal(count, 4 * 4);
    for (int i = 0; i < count; ++i) {
        assert_true(left[i].body_a.index != ids[2].index && left[i].body_b.index != ids[2].index);
    }
    /* The bodies that stood on it fall freely for one step; those below stay. */
    step(world, H);
    assert_close(state_of(world, ids[3]).velocity.z, -9.81 * H, 1e-6, 0);
    assert_close(state_of(world, ids[1]).velocity.z, 0, 1e-6, 0);
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_resting_scene_allocates_nothing_after_warm_up),
        cmocka_unit_test(test_arena_gives_back_what_was_long_unneeded),
        cmocka_unit_test(test_every_failed_allocation_is_reported_and_loses_nothing),
        cmocka_unit_test(test_bad_bodies_are_refused_with_the_number_found),
        cmocka_unit_test(test_bad_worlds_steps_and_ids_are_refused),
        cmocka_unit_test(test_a_destroyed_body_leaves_nothing_behind),
    };
    return cmocka_run_group_tests_name("engine_memory", tests, NULL, NULL);
}
