/* Meshes at rest in a world. */
#include "check.h"
#include "mesh_for_tests.h"
#include "world_for_tests.h"

static pe_geometry_id add_geometry(pe_world *world, test_mesh m)
{
    pe_geometry_def def = mesh_def(&m, false);
    pe_geometry_id id;
    pe_error error = {0};
    if (pe_geometry_create(world, &def, &id, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    mesh_free(&m);
    return id;
}

static pe_body_id add_mesh(pe_world *world, pe_geometry_id g, pe_vec3 position, pe_quat q)
{
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){.kind = PE_SHAPE_MESH, .geometry = g};
    def.position = position;
    def.orientation = pe_quat_unit(q);
    return add_body(world, &def);
}

static void test_meshes_rest_on_plane_and_each_other(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_material_id wood = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), wood);
    pe_geometry_id small = add_geometry(world, mesh_cube(1)),
                   bar = add_geometry(world, mesh_angle_bar());
    pe_geometry_id ring = add_geometry(world, mesh_torus(1, 0.3, 24, 8));
    double height = pl_torus_half_height(0.3, 8);
    pe_vec3 places[5] = {{0, 0, 0.5}, {0, 0, 1.5}, {0.2, 0.1, 2.5}, {5, 0, 0}, {-5, 0, height}};
    pe_body_id ids[5];
    for (int i = 0; i < 5; ++i) {
        pe_geometry_id g = i < 3 ? small : i == 3 ? bar : ring;
        ids[i] = add_mesh(world, g, places[i], unturned);
    }
    for (int i = 0; i < 600; ++i) {
        step(world, 1.0 / 60);
    }
    for (int i = 0; i < 5; ++i) {
        pe_body_state s = state_of(world, ids[i]);
        assert_close(s.position.x, places[i].x, 1e-6, 0);
        assert_close(s.position.y, places[i].y, 1e-6, 0);
        assert_close(s.position.z, places[i].z, 1e-6, 0);
    }
    pe_world_destroy(world);
}

/* The upper ring is held; the lower one hangs in it, swings, and stays in it. */
static void test_a_ring_hangs_in_a_ring(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_geometry_id ring = add_geometry(world, mesh_torus(1, 0.2, 25, 10));
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){.kind = PE_SHAPE_MESH, .geometry = ring};
    def.is_static = true;
    def.orientation = pe_quat_unit((pe_quat){1, 1, 0, 0});
    add_body(world, &def);
    pe_body_id lower = add_mesh(world, ring, pe_v3(0.1, 0, -1.3), (pe_quat){1, 1, 1, 1});
    for (int i = 0; i < 300; ++i) {
        pe_step_stats stats = step(world, 1.0 / 60);
        assert_at_most(stats.penetration_left, 0.02);
    }
    pe_body_state s = state_of(world, lower);
    /* The inner sides of both tubes touch: the centres are about 2 (1 - 0.2) apart. */
    assert_close(s.position.z, -1.6, 0.1, 0);
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_meshes_rest_on_plane_and_each_other),
        cmocka_unit_test(test_a_ring_hangs_in_a_ring),
    };
    return cmocka_run_group_tests_name("engine_mesh_world", tests, NULL, NULL);
}
