/* What holds of the contacts of every pair of shapes, as tests whose state is a law_budget. Each
 * runs over all pairs of kinds, prints the first pose of each where it fails, and how many do. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_LAWS_H
#define PLUMB_TEST_SHAPE_PAIRS_LAWS_H

typedef struct law_budget {
    int truth_poses; /* of each pair of kinds, where the truth is searched for */
    int poses;       /* where the answer proves itself */
} law_budget;

/* Of convex shapes: the least separation is the signed distance, and so is the separation along the
 * normal that is reported. */
void test_depth_and_normal_equal_the_truth(void **state);

/* Of meshes: apart, the least separation is the distance. */
void test_distance_to_a_mesh_equals_brute_force(void **state);

/* A convex mesh that overlaps by up to 1e-3 of the size is as deep as the hull. */
void test_shallow_depth_of_a_convex_mesh_equals_that_of_the_hull(void **state);

/* Finite, unit normal, no more points than there may be, features named once, and the point on
 * either surface, half a separation along the normal, is in that shape. */
void test_points_lie_in_both_shapes_a_separation_apart(void **state);

void test_swapping_the_shapes_turns_the_normal(void **state);
void test_contacts_move_with_the_world(void **state);
void test_contacts_scale_with_the_shapes(void **state);

/* The least separation changes by no more than the surfaces move. */
void test_separation_is_continuous(void **state);

/* Points within the margin, none beyond it. */
void test_a_pair_has_points_exactly_when_its_gap_is_within_the_margin(void **state);

/* The same points at every margin from least_margin to end_margin. */
void test_points_are_the_same_at_every_margin_of_their_range(void **state);

/* Normal and features of a pair at rest stay while it sways by 1e-9. */
void test_features_stay_while_a_pair_at_rest_sways(void **state);

#endif
