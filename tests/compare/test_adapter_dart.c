/* What DART's shapes store: its rule of mixing, the lesser friction and the product of the
 * restitutions, must give every pair of materials its own coefficients. */
#include "adapters/dart/dart_pairs.c" /* which no other program links */
#include "check.h"
#include "engine_run.h"

#include <math.h>
#include <string.h>

enum { MATERIALS = 3 };

/* Moving boxes of materials 1 and 2 on a floor of material 0, with these coefficients of the pairs. */
static pl_dart_pairs pairs_of(const pl_pair_coefficients table[MATERIALS * MATERIALS])
{
    static const char *const names[MATERIALS] = {"ice", "stone", "rubber"};
    pl_scene scene = pl_scene_default();
    for (int i = 0; i < MATERIALS; ++i) {
        put_material(&scene, names[i], 0.5, 0);
        pl_body body = i == 0 ? floor_body() : box_body(1, 0.5, 0.5, 0.5);
        body.material = i;
        body.position[2] = i;
        put_body(&scene, body);
    }
    const pl_engine_setup setup = {.scene = &scene, .pairs = table};
    pl_dart_pairs pairs;
    assert_int_equal(pl_dart_pairs_of(&setup, &pairs), PL_OK);
    for (int a = 0; a < MATERIALS; ++a) {
        for (int b = 0; b < MATERIALS; ++b) {
            /* There is one body of each material. */
            assert_int_equal(pl_dart_can_touch(&pairs, a, b), a != b);
            const pl_pair_coefficients of_a = pl_dart_stored(&pairs, a, b);
            const pl_pair_coefficients of_b = pl_dart_stored(&pairs, b, a);
            const pl_pair_coefficients asked = table[a * MATERIALS + b];
            if (a != b) {
                assert_true(fmin(of_a.friction, of_b.friction) == asked.friction);
                assert_close(of_a.restitution * of_b.restitution, asked.restitution, 0, 1e-15);
            }
        }
    }
    pl_scene_free(&scene);
    return pairs;
}

static void test_minima_need_one_shape(void **state)
{
    (void)state;
    /* The minima of 0.8, 0.3 and 0.8. */
    const pl_pair_coefficients table[] = {{0.9, 0.1}, {0.3, 0.4}, {0.8, 0.4},
                                          {0.3, 0.4}, {0.9, 0.1}, {0.3, 0.4},
                                          {0.8, 0.4}, {0.3, 0.4}, {0.9, 0.1}};
    pl_dart_pairs pairs = pairs_of(table);
    assert_false(pairs.by_partner);
    pl_dart_pairs_free(&pairs);
}

static void test_friction_that_is_no_minimum_needs_a_shape_for_each_partner(void **state)
{
    (void)state;
    const pl_pair_coefficients table[] = {{0.9, 0.1}, {0.3, 0.4}, {0.8, 0.4},
                                          {0.3, 0.4}, {0.9, 0.1}, {0.5, 0.4},
                                          {0.8, 0.4}, {0.5, 0.4}, {0.9, 0.1}};
    pl_dart_pairs pairs = pairs_of(table);
    assert_true(pairs.by_partner);
    pl_dart_pairs_free(&pairs);
}

static void test_restitutions_that_differ_need_a_shape_for_each_partner(void **state)
{
    (void)state;
    const pl_pair_coefficients table[] = {{0.5, 0.1}, {0.5, 0},   {0.5, 0.4}, {0.5, 0},  {0.5, 0.1},
                                          {0.5, 0.4}, {0.5, 0.4}, {0.5, 0.4}, {0.5, 0.1}};
    pl_dart_pairs pairs = pairs_of(table);
    assert_true(pairs.by_partner);
    pl_dart_pairs_free(&pairs);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_minima_need_one_shape),
        cmocka_unit_test(test_friction_that_is_no_minimum_needs_a_shape_for_each_partner),
        cmocka_unit_test(test_restitutions_that_differ_need_a_shape_for_each_partner),
    };
    return cmocka_run_group_tests_name("dart pairs", tests, NULL, NULL);
}
