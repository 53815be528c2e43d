/* Narrow phase: the laws of contact of all pairs of shapes, over a few poses of each. */
#include "check.h"
#include "shape_pairs_laws.h"

int main(void)
{
    static law_budget budget = {.truth_poses = 40, .poses = 200};
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_depth_and_normal_equal_the_truth, &budget),
        cmocka_unit_test_prestate(test_distance_to_a_mesh_equals_brute_force, &budget),
        cmocka_unit_test_prestate(test_shallow_depth_of_a_convex_mesh_equals_that_of_the_hull,
                                  &budget),
        cmocka_unit_test_prestate(test_points_lie_in_both_shapes_a_separation_apart, &budget),
        cmocka_unit_test_prestate(test_swapping_the_shapes_turns_the_normal, &budget),
        cmocka_unit_test_prestate(test_contacts_move_with_the_world, &budget),
        cmocka_unit_test_prestate(test_contacts_scale_with_the_shapes, &budget),
        cmocka_unit_test_prestate(test_separation_is_continuous, &budget),
        cmocka_unit_test_prestate(test_a_pair_has_points_exactly_when_its_gap_is_within_the_margin,
                                  &budget),
        cmocka_unit_test_prestate(test_points_are_the_same_at_every_margin_of_their_range, &budget),
        cmocka_unit_test_prestate(test_features_stay_while_a_pair_at_rest_sways, &budget),
    };
    return cmocka_run_group_tests_name("engine_pairs", tests, NULL, NULL);
}
