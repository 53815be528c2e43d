/* No body passes a wall that is thinner than its displacement in a step. */
#include "base/vec3.h"
#include "check.h"
#include "random_pose.h"
#include "world_for_tests.h"

static const double half_wall = 0.005; /* m */
static const double dt = 1.0 / 60;

static pe_world *world_with_wall(pe_profile profile)
{
    pe_world_def def = pe_world_def_default();
    def.profile = profile;
    def.gravity = pe_v3(0, 0, 0);
    pe_world *world;
    assert_int_equal(pe_world_create(&def, &world, NULL), PE_OK);
    pe_body_def wall = pe_body_def_default();
    wall.is_static = true;
    wall.shape = (pe_shape){.kind = PE_SHAPE_BOX, .half_extents = {half_wall, 100, 100}};
    pe_body_id id;
    assert_int_equal(pe_body_create(world, &wall, &id, NULL), PE_OK);
    return world;
}

/* A box of the half extents, of two triangles a side. */
static pe_geometry_id box_mesh(pe_world *world, pe_vec3 e)
{
    static const uint32_t triangles[12][3] = {{4, 6, 2}, {4, 2, 0}, {1, 3, 7}, {1, 7, 5},
                                              {1, 5, 4}, {1, 4, 0}, {2, 6, 7}, {2, 7, 3},
                                              {2, 3, 1}, {2, 1, 0}, {4, 5, 7}, {4, 7, 6}};
    pe_vec3 vertices[8];
    for (int i = 0; i < 8; ++i) {
        vertices[i] = pe_mul(pe_v3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1), e);
    }
    const pe_geometry_def def = {
        .vertices = vertices, .triangles = triangles, .vertex_count = 8, .triangle_count = 12};
    pe_geometry_id id;
    assert_int_equal(pe_geometry_create(world, &def, &id, NULL), PE_OK);
    return id;
}

/* How far the body reaches beyond the wall's near face. */
static double reach(const pe_shape *shape, const pe_body_state *s)
{
    pe_mat3 r = pe_matrix_of(s->orientation);
    pe_vec3 e = shape->half_extents;
    double half = shape->kind == PE_SHAPE_SPHERE
                      ? shape->radius
                      : fabs(r.r0.x) * e.x + fabs(r.r0.y) * e.y + fabs(r.r0.z) * e.z;
    return s->position.x + half + half_wall;
}

/* Flies a body at the wall, at `speed` in a direction within 60 degrees of its normal, and checks
 * that its centre never passes, and that nothing of it stays in the wall; soft contacts, which push
 * out slowly, leave some. */
static void fly(check_random *random, pe_profile profile, pe_shape shape, double speed, double spin)
{
    pe_world *world = world_with_wall(profile);
    pe_body_def def = pe_body_def_default();
    double q[4];
    check_quaternion(random, q);
    def.shape = shape;
    if (shape.kind == PE_SHAPE_MESH) {
        def.shape.geometry = box_mesh(world, shape.half_extents);
    }
    def.orientation = (pe_quat){q[0], q[1], q[2], q[3]};
    def.position = pe_v3(-check_uniform(random, 1, 12), 0, 0);
    pe_vec3 sideways = random_vector(random, 1.2);
    pe_vec3 towards = pe_v3(1, sideways.y, sideways.z);
    def.velocity = pe_scale(speed / pe_length(towards), towards);
    def.angular_velocity = random_vector(random, spin);
    pe_body_id id;
    pe_body_state s;
    assert_int_equal(pe_body_create(world, &def, &id, NULL), PE_OK);
    for (int i = 0; i < 40; ++i) {
        assert_int_equal(pe_world_step(world, dt, NULL, NULL), PE_OK);
        assert_int_equal(pe_body_get_state(world, id, &s, NULL), PE_OK);
        assert_at_most(s.position.x, profile == PE_PROFILE_FAST ? 0 : -half_wall);
    }
    if (profile != PE_PROFILE_FAST) {
        assert_at_most(reach(&shape, &s), 1e-3);
    }
    pe_world_destroy(world);
}

static void fly_all(pe_shape shape, double spin)
{
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_FAST; ++profile) {
        check_random random = {99};
        for (int i = 0; i < 300; ++i) {
            fly(&random, (pe_profile)profile, shape, check_uniform(&random, 50, 200), spin);
        }
    }
}

static void test_fast_sphere_does_not_pass_thin_wall(void **state)
{
    (void)state;
    fly_all((pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0.5}, 100);
}

static void test_fast_plate_does_not_pass_thin_wall(void **state)
{
    (void)state;
    fly_all((pe_shape){.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.005}}, 0);
}

static void test_a_spinning_plate_does_not_either(void **state)
{
    (void)state;
    fly_all((pe_shape){.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.005}}, 50);
}

static void test_a_plate_of_triangles_does_not_either(void **state)
{
    (void)state;
    fly_all((pe_shape){.kind = PE_SHAPE_MESH, .half_extents = {0.5, 0.5, 0.005}}, 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fast_sphere_does_not_pass_thin_wall),
        cmocka_unit_test(test_fast_plate_does_not_pass_thin_wall),
        cmocka_unit_test(test_a_spinning_plate_does_not_either),
        cmocka_unit_test(test_a_plate_of_triangles_does_not_either),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
