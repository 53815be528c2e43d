/* Finite in, finite out: numbers out of range are refused, and a step leaves finite states. */
#include "check.h"
#include "random_pose.h"
#include "solid_forms.h"
#include "step_laws.h"
#include "world_for_tests.h"

#include <string.h>

static const double H = 1.0 / 60;

/* ---- Definitions ---- */

static const double BAD[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, 1e300, -1e300};
enum { BAD_COUNT = sizeof BAD / sizeof BAD[0] };

static void refuse_world(size_t offset, const char *name)
{
    for (int i = 0; i < BAD_COUNT; ++i) {
        pe_world_def def = pe_world_def_default();
        memcpy((char *)&def + offset, &BAD[i], sizeof BAD[i]);
        pe_world *world;
        pe_error error;
        assert_int_equal(pe_world_create(&def, &world, &error), PE_BAD_ARGUMENT);
        assert_contains(error.message, name);
        assert_contains(error.message, "expected");
        assert_contains(error.message, "found");
        assert_null(world);
    }
}

static void test_worlds_refuse_numbers_out_of_range(void **state)
{
    (void)state;
    refuse_world(offsetof(pe_world_def, gravity.y), "gravity");
    refuse_world(offsetof(pe_world_def, tolerance), "tolerance");
    refuse_world(offsetof(pe_world_def, max_contact_updates), "max_contact_updates");
    refuse_world(offsetof(pe_world_def, restitution_threshold), "restitution_threshold");
    refuse_world(offsetof(pe_world_def, contact_margin), "contact_margin");
    refuse_world(offsetof(pe_world_def, penetration_slop), "penetration_slop");
}

static void refuse_body(pe_world *world, pe_body_def def, size_t offset, const char *name)
{
    for (int i = 0; i < BAD_COUNT; ++i) {
        memcpy((char *)&def + offset, &BAD[i], sizeof BAD[i]);
        pe_body_id id;
        pe_error error;
        assert_int_equal(pe_body_create(world, &def, &id, &error), PE_BAD_ARGUMENT);
        assert_contains(error.message, name);
        assert_contains(error.message, "found");
    }
}

static void test_bodies_refuse_numbers_out_of_range(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_def def = pe_body_def_default();
    refuse_body(world, def, offsetof(pe_body_def, mass), "mass");
    refuse_body(world, def, offsetof(pe_body_def, position.x), "position");
    refuse_body(world, def, offsetof(pe_body_def, velocity.z), "velocity");
    refuse_body(world, def, offsetof(pe_body_def, angular_velocity.y), "angular_velocity");
    refuse_body(world, def, offsetof(pe_body_def, orientation.x), "orientation");
    refuse_body(world, def, offsetof(pe_body_def, shape.radius), "sphere");
    def.inertia = pe_v3(1, 1, 1);
    refuse_body(world, def, offsetof(pe_body_def, inertia.z), "inertia");
    def = box_def(1, 1, 1, pe_v3(0, 0, 0));
    refuse_body(world, def, offsetof(pe_body_def, shape.half_extents.y), "box");
    def.shape = (pe_shape){.kind = PE_SHAPE_CYLINDER, .radius = 1, .half_height = 1};
    refuse_body(world, def, offsetof(pe_body_def, shape.half_height), "cylinder");
    def.shape = (pe_shape){.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}};
    def.is_static = true;
    refuse_body(world, def, offsetof(pe_body_def, shape.offset), "plane");
    refuse_body(world, def, offsetof(pe_body_def, shape.normal.x), "plane");
    pe_world_destroy(world);
}

static void test_states_forces_and_materials_refuse_them_too(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_def def = pe_body_def_default();
    pe_body_id id = add_body(world, &def);
    const pe_body_state good = state_of(world, id);
    pe_vec3 fine = {1, 0, 0};
    pe_material_id material;
    for (int i = 0; i < BAD_COUNT; ++i) {
        pe_body_state s = good;
        pe_vec3 bad = {0, BAD[i], 0};
        pe_error error;
        s.velocity = bad;
        assert_int_equal(pe_body_set_state(world, id, &s, &error), PE_BAD_ARGUMENT);
        assert_contains(error.message, "velocity: expected");
        assert_int_equal(pe_body_apply_force(world, id, bad, fine, PE_FRAME_WORLD, &error),
                         PE_BAD_ARGUMENT);
        assert_contains(error.message, "force: expected");
        assert_int_equal(pe_body_apply_force(world, id, fine, bad, PE_FRAME_BODY, &error),
                         PE_BAD_ARGUMENT);
        assert_contains(error.message, "offset: expected");
        assert_int_equal(pe_material_create(world, BAD[i], 0, &material, &error), PE_BAD_ARGUMENT);
        assert_contains(error.message, "friction: expected");
        assert_int_equal(pe_world_step(world, BAD[i], NULL, &error), PE_BAD_ARGUMENT);
        assert_contains(error.message, "dt: expected");
    }
    pe_body_state now = state_of(world, id);
    assert_memory_equal(&now, &good, sizeof now);
    pe_world_destroy(world);
}

static pe_status try_geometry(pe_world *world, form *f, pe_error *error)
{
    pe_geometry_id id;
    const pe_geometry_def def = {.vertices = f->vertices,
                                 .triangles = (const uint32_t(*)[3])f->triangles,
                                 .vertex_count = f->vertex_count,
                                 .triangle_count = f->triangle_count};
    return pe_geometry_create(world, &def, &id, error);
}

/* A tetrahedron far out is flat, up to the rounding of its corners: which way it faces is chance. */
static void test_geometries_without_a_certain_volume_are_refused(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    check_random random = {7};
    pe_error error;
    form f = form_cube();
    assert_int_equal(try_geometry(world, &f, NULL), PE_OK);
    f.vertices[3].y = 1e13;
    assert_int_equal(try_geometry(world, &f, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, "vertex 3: expected");
    for (int i = 0; i < 1000; ++i) {
        f = form_tetrahedron();
        double scale = exp(check_uniform(&random, log(1e8), log(1e11)));
        pe_vec3 u = random_vector(&random, scale), v = random_vector(&random, scale);
        for (int k = 0; k < f.vertex_count; ++k) {
            double a = check_uniform(&random, -1, 1), b = check_uniform(&random, -1, 1);
            f.vertices[k] = pe_add(pe_scale(a, u), pe_scale(b, v));
        }
        assert_int_equal(try_geometry(world, &f, &error), PE_BAD_ARGUMENT);
    }
    pe_world_destroy(world);
}

/* ---- Steps ---- */

/* A step that would take a body too far leaves everything as it was, says so, and the next one
 * works. */
static void test_a_step_out_of_range_is_undone(void **state)
{
    (void)state;
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_FAST; ++profile) {
        pe_world_def settings = pe_world_def_default();
        settings.profile = (pe_profile)profile;
        pe_world *world = make_world(&settings), *other = make_world(&settings);
        pe_body_id ids[4], same[4];
        add_tower(world, 3, (pe_material_id){0}, ids);
        add_tower(other, 3, (pe_material_id){0}, same);
        pe_body_def def = pe_body_def_default();
        def.position = pe_v3(50, 0, 10);
        ids[3] = add_body(world, &def);
        same[3] = add_body(other, &def);
        step(world, H), step(other, H);
        pe_body_state before = state_of(world, ids[3]);
        pe_error error;
        assert_int_equal(pe_body_apply_force(world, ids[3], pe_v3(1e29, 0, 0), pe_v3(0, 1, 0),
                                             PE_FRAME_WORLD, NULL),
                         PE_OK);
        assert_int_equal(pe_world_step(world, H, NULL, &error), PE_NOT_FINITE);
        assert_int_equal(error.status, PE_NOT_FINITE);
        assert_contains(error.message, "body (5, 1): expected a finite position");
        pe_body_state after = state_of(world, ids[3]);
        assert_memory_equal(&before, &after, sizeof after);
        for (int k = 0; k < 30; ++k) {
            step(world, H), step(other, H);
        }
        for (int i = 0; i < 4; ++i) {
            pe_vec3 x = state_of(world, ids[i]).position, y = state_of(other, same[i]).position;
            assert_at_most(pe_length(pe_sub(x, y)), profile == PE_PROFILE_FAST ? 1e-4 : 1e-9);
        }
        pe_world_destroy(world);
        pe_world_destroy(other);
    }
}

/* Of any size in the range, at times none. */
static double any_size(check_random *random, double least, double most)
{
    double size = exp(check_uniform(random, log(least), log(most)));
    return check_uniform(random, 0, 1) < 0.5 ? check_uniform(random, 0.1, 2) : size;
}

static pe_vec3 any_vector(check_random *random, double most)
{
    return random_vector(random, any_size(random, 1e-12, most));
}

static pe_body_def any_body(check_random *random)
{
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){
        .kind = (pe_shape_kind)check_uniform(random, 0, PE_SHAPE_HULL),
        .normal = {0, 0, 1},
        .offset = any_vector(random, 1e12).x,
        .radius = any_size(random, 1e-12, 1e12),
        .half_height = any_size(random, 1e-12, 1e12),
        .half_extents = {any_size(random, 1e-12, 1e12), any_size(random, 1e-12, 1e12),
                         any_size(random, 1e-12, 1e12)},
    };
    def.is_static = def.shape.kind == PE_SHAPE_PLANE || check_uniform(random, 0, 1) < 0.2;
    def.mass = any_size(random, 1e-30, 1e30);
    def.position = any_vector(random, 1e12);
    def.orientation = random_turn(random);
    def.velocity = any_vector(random, 1e12);
    def.angular_velocity = any_vector(random, 1e12);
    return def;
}

/* Worlds of absurd numbers, all in range: a step ends with finite states or is undone. */
static void test_absurd_worlds_stay_finite(void **state)
{
    (void)state;
    enum { WORLDS = 600, BODIES = 4, STEPS = 4 };
    int undone = 0, done = 0;
    for (uint64_t seed = 1; seed <= WORLDS; ++seed) {
        check_random random = {seed * 0x9e3779b97f4a7c15u | 1};
        pe_world_def def = pe_world_def_default();
        def.profile = (pe_profile)(seed % 3);
        def.gravity = any_vector(&random, 1e12);
        def.contact_margin = seed % 5 == 0 ? any_size(&random, 1e-12, 1e12) : 1e-3;
        def.penetration_slop = seed % 7 == 0 ? any_size(&random, 1e-12, 1e12) : 1e-4;
        def.max_iterations = 100;
        pe_world *world = make_world(&def);
        pe_body_id ids[BODIES];
        for (int i = 0; i < BODIES; ++i) {
            pe_body_def body = any_body(&random);
            if (pe_body_create(world, &body, &ids[i], NULL) != PE_OK) {
                body = pe_body_def_default(); /* inertia out of range */
                ids[i] = add_body(world, &body);
            }
        }
        for (int k = 0; k < STEPS; ++k) {
            pe_body_state before[BODIES];
            for (int i = 0; i < BODIES; ++i) {
                before[i] = state_of(world, ids[i]);
            }
            pe_body_apply_force(world, ids[k], any_vector(&random, 1e30), any_vector(&random, 1e12),
                                PE_FRAME_BODY, NULL);
            double dt = k % 2 == 0 ? H : any_size(&random, 1e-12, 1e12);
            pe_status status = pe_world_step(world, dt, NULL, NULL);
            assert_true(status == PE_OK || status == PE_NOT_FINITE);
            for (int i = 0; i < BODIES; ++i) {
                pe_body_state after = state_of(world, ids[i]);
                if (!is_finite_state(&after) ||
                    (status != PE_OK && memcmp(&before[i], &after, sizeof after) != 0)) {
                    fail_msg("seed %d, step %d, body %d", (int)seed, k, i);
                }
            }
            undone += status != PE_OK;
            done += status == PE_OK;
        }
        pe_world_destroy(world);
    }
    assert_true(done > WORLDS && undone > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_worlds_refuse_numbers_out_of_range),
        cmocka_unit_test(test_bodies_refuse_numbers_out_of_range),
        cmocka_unit_test(test_states_forces_and_materials_refuse_them_too),
        cmocka_unit_test(test_geometries_without_a_certain_volume_are_refused),
        cmocka_unit_test(test_a_step_out_of_range_is_undone),
        cmocka_unit_test(test_absurd_worlds_stay_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
