/* Exact sums and signs: against integers, against the definition, and under every order. */
#include "base/exact.h"
#include "check.h"

#include <math.h>

static void test_sum_is_the_double_nearest_to_it(void **state)
{
    (void)state;
    pl_exact_sum sum = {{0}, {0}};
    assert_int_equal(pl_exact_sign(&sum), 0);
    pl_exact_add(&sum, 1e50, 1e50, 1e50);
    pl_exact_add(&sum, 0x1p-1074, 0x1p-1074, -0x1p-1074);
    pl_exact_add(&sum, -1e50, 1e50, 1e50);
    assert_int_equal(pl_exact_sign(&sum), -1);
    pl_exact_add(&sum, 3, 5, 7);
    assert_close(pl_exact_value(&sum), 105, 0, 0);
    pl_exact_add(&sum, 1, 0x1p60, 1); /* 2^60 + 105 - a little: to the nearest multiple of 256 */
    assert_close(pl_exact_value(&sum), 0x1p60, 0, 0);
    pl_exact_add(&sum, 23, 1, 1); /* 128 above, less a little */
    assert_close(pl_exact_value(&sum), 0x1p60, 0, 0);
    pl_exact_add(&sum, 0x1p-1074, 0x1p-1074, 0x1p-1074); /* half: to the even one */
    assert_close(pl_exact_value(&sum), 0x1p60, 0, 0);
    pl_exact_add(&sum, 0x1p-1074, 0x1p-1074, 0x1p-1074);
    assert_close(pl_exact_value(&sum), 0x1p60 + 256, 0, 0);
}

/* Points of a plane, moved by one bit along z: the sign is that of the move. */
static void test_one_bit_decides_the_side(void **state)
{
    (void)state;
    check_random random = {.state = 5};
    for (int i = 0; i < 2000; ++i) {
        double p[4][3];
        const double scale = ldexp(1, (int)check_uniform(&random, -20, 40));
        for (int k = 0; k < 4; ++k) { /* on z = x + y, whole numbers of units: exactly */
            p[k][0] = floor(check_uniform(&random, -1000, 1000)) * scale;
            p[k][1] = floor(check_uniform(&random, -1000, 1000)) * scale;
            p[k][2] = p[k][0] + p[k][1];
        }
        const int turn = pl_turn_about(2, p[0], p[1], p[2]);
        assert_int_equal(pl_side_of_plane(p[0], p[1], p[2], p[3]), 0);
        p[3][2] = nextafter(p[3][2], INFINITY);
        assert_int_equal(pl_side_of_plane(p[0], p[1], p[2], p[3]), turn);
        assert_int_equal(pl_side_of_plane(p[1], p[0], p[2], p[3]), -turn);
        assert_int_equal(pl_side_of_plane(p[3], p[1], p[2], p[0]), -turn);
    }
}

static void test_side_of_a_line_is_exact(void **state)
{
    (void)state;
    const double far = 0x1p52;
    const double a[3] = {far, far, 0}, b[3] = {far + 3, far + 3, 0};
    double c[3] = {far + 1, far + 1, 9};
    assert_int_equal(pl_turn_about(2, a, b, c), 0);
    c[1] = far + 2;
    assert_int_equal(pl_turn_about(2, a, b, c), 1);
    assert_int_equal(pl_turn_about(2, b, a, c), -1);
    const double u[3] = {0.1, 0.1, 0}, v[3] = {0.3, 0.3, 0}, w[3] = {0.7, nextafter(0.7, 0), 0};
    assert_int_equal(pl_turn_about(2, u, v, w), -1);
    assert_int_equal(pl_turn_about(2, v, w, u), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sum_is_the_double_nearest_to_it),
        cmocka_unit_test(test_one_bit_decides_the_side),
        cmocka_unit_test(test_side_of_a_line_is_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
