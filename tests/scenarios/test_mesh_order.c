/* A mesh is accepted in every order of its vertices and triangles, or in none. */
#include "check.h"
#include "solid_for_tests.h"

#include <math.h>
#include <string.h>

static solid_surface surface, other; /* too large for the stack */

static bool is_accepted(const solid_surface *s, double *volume)
{
    pl_scene scene = pl_scene_default();
    const pl_polyhedron *made = NULL;
    const pl_status status =
        pl_scene_add_mesh(&scene, NULL, (const double(*)[3])s->vertices, s->vertex_count,
                          (const int(*)[3])s->triangles, s->triangle_count, &made, NULL);
    *volume = status == PL_OK ? made->volume : 0;
    pl_scene_free(&scene);
    return status == PL_OK;
}

static void shuffle(int *order, int count, check_random *random)
{
    for (int i = 0; i < count; ++i) {
        const int k = (int)check_uniform(random, 0, i + 0.999);
        order[i] = order[k];
        order[k] = i;
    }
}

/* `other` becomes `surface` in another order, wound in any way. */
static void reorder(check_random *random)
{
    int place[256], order[256];
    assert_true(surface.vertex_count <= 256 && surface.triangle_count <= 256);
    shuffle(place, surface.vertex_count, random);
    shuffle(order, surface.triangle_count, random);
    other.vertex_count = surface.vertex_count;
    other.triangle_count = surface.triangle_count;
    for (int i = 0; i < surface.vertex_count; ++i) {
        memcpy(other.vertices[place[i]], surface.vertices[i], sizeof surface.vertices[i]);
    }
    for (int t = 0; t < surface.triangle_count; ++t) {
        const int first = (int)check_uniform(random, 0, 2.999);
        const int step = 1 + (int)check_uniform(random, 0, 1.999);
        for (int k = 0; k < 3; ++k) {
            other.triangles[order[t]][k] = place[surface.triangles[t][(first + step * k) % 3]];
        }
    }
}

/* Returns whether it is accepted. */
static bool check_orders(check_random *random, int count)
{
    double volume, other_volume;
    const bool accepted = is_accepted(&surface, &volume);
    for (int i = 0; i < count; ++i) {
        reorder(random);
        assert_int_equal(is_accepted(&other, &other_volume), accepted);
        assert_close(other_volume, volume, 0, 0.01);
    }
    return accepted;
}

/* Boxes that touch, or overlap by about the tolerance, turned and far away. */
static void test_touching_boxes_are_alike_in_every_order(void **state)
{
    (void)state;
    check_random random = {.state = 3};
    int accepted = 0;
    for (int i = 0; i < 200; ++i) {
        double rotation[4];
        const double half[3] = {1, 1, 1}, origin[3] = {0, 0, 0}, far[3] = {1e4, -2e4, 3e4};
        const double gap = i % 2 == 0 ? 0 : check_uniform(&random, -6e-9, 6e-9);
        const double beside[3] = {2 + gap, check_uniform(&random, -1, 1), 0.25};
        check_quaternion(&random, rotation);
        known_clear(&surface);
        known_add_box(&surface, origin, half, false);
        known_add_box(&surface, beside, half, false);
        known_move(&surface, rotation, i % 3 == 0 ? far : origin);
        accepted += check_orders(&random, 4);
    }
    assert_in_range(accepted, 120, 199);
}

/* Tetrahedra on a coarse grid, where planes, lines and corners meet, moved by a few bits. */
static void test_degenerate_solids_are_alike_in_every_order(void **state)
{
    (void)state;
    check_random random = {.state = 11};
    int accepted = 0;
    for (int i = 0; i < 4000; ++i) {
        const double scale = i % 2 == 0 ? 1 : 1e11;
        known_clear(&surface);
        for (int solid = 0; solid < 2; ++solid) {
            const int first = surface.vertex_count;
            for (int k = 0; k < 4; ++k) {
                double v[3];
                for (int axis = 0; axis < 3; ++axis) {
                    v[axis] = scale * floor(check_uniform(&random, 0, 3.999)) / 3;
                    v[axis] =
                        i % 4 < 2 ? v[axis] : nextafter(v[axis], check_uniform(&random, -9, 9));
                }
                known_add_vertex(&surface, v[0], v[1], v[2]);
            }
            known_add_triangle(&surface, first, first + 1, first + 2);
            known_add_triangle(&surface, first, first + 1, first + 3);
            known_add_triangle(&surface, first + 1, first + 2, first + 3);
            known_add_triangle(&surface, first + 2, first, first + 3);
        }
        accepted += check_orders(&random, 3);
    }
    assert_in_range(accepted, 400, 3600);
}

/* A plate on which a smaller box stands: the box's first triangle lies in the plate's face. */
static void test_box_that_stands_on_another_is_no_cavity(void **state)
{
    (void)state;
    const double plate[3] = {4, 4, 1}, box[3] = {1, 1, 1}, below[3] = {0.5, 0.25, -1};
    const double above[3] = {0, 0, 1};
    check_random random = {.state = 29};
    double volume, rotation[4];
    for (int i = 0; i < 100; ++i) {
        known_clear(&surface);
        known_add_box(&surface, below, plate, false);
        known_add_box(&surface, above, box, false);
        check_quaternion(&random, rotation);
        known_move(&surface, rotation, above);
        reorder(&random);
        assert_true(is_accepted(&other, &volume));
        assert_close(volume, 128 + 8, 1e-9, 0);
    }
}

/* A column with corners in both faces of the plate that it goes through: no edge goes through the
 * inside of a triangle of the other surface. */
static void test_column_through_a_plate_crosses(void **state)
{
    (void)state;
    double radius[4] = {1, 1, 1, 1}, height[4] = {-2, -1, 1, 2}, volume;
    const double origin[3] = {0, 0, 0}, plate[3] = {4, 4, 1};
    known_clear(&surface);
    known_add_box(&surface, origin, plate, false);
    known_add_rings(&surface, 4, radius, height, 4, false);
    assert_false(is_accepted(&surface, &volume));
}

/* A flat tetrahedron far away, its volume below the rounding of the coordinates. */
static void test_volume_far_away_has_the_right_sign(void **state)
{
    (void)state;
    check_random random = {.state = 31};
    static const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    for (int i = 0; i < 2000; ++i) {
        double vertices[4][3];
        for (int k = 0; k < 12; ++k) {
            const double scale = k % 3 == 2 ? 1e-4 : 1e4;
            vertices[k / 3][k % 3] = 1e12 + scale * check_uniform(&random, -1, 1);
        }
        known_make_tetrahedron(&surface, (const double(*)[3])vertices, faces);
        check_orders(&random, 3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_touching_boxes_are_alike_in_every_order),
        cmocka_unit_test(test_degenerate_solids_are_alike_in_every_order),
        cmocka_unit_test(test_box_that_stands_on_another_is_no_cavity),
        cmocka_unit_test(test_column_through_a_plate_crosses),
        cmocka_unit_test(test_volume_far_away_has_the_right_sign),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
