/* Smooth motion in contact is second order in the step: halving it quarters the error. */
#include "base/vec3.h"
#include "check.h"
#include "plumb/contact_problem.h"
#include "world_for_tests.h"

#include <math.h>

enum { STEPS_A_SECOND = 480 };

typedef pe_body_id build_scene(pe_world *world, double speed, double spin);

/* A cube that spins on its corner, leaning, on a smooth plane. */
static pe_body_id build_top(pe_world *world, double speed, double spin)
{
    const double half = 0.2, tilt = 0.3;
    add_plane(world, (pe_vec3){0, 0, 1}, add_material(world, 0, 0));
    pe_body_def cube = box_def(half, half, half, (pe_vec3){0, 0, half * sqrt(3) * cos(tilt)});
    /* The diagonal upright, then tilted about y. */
    const double turn = acos(1 / sqrt(3)) / 2, side = sin(turn) * sqrt(0.5);
    cube.orientation = pe_quat_product((pe_quat){cos(tilt / 2), 0, sin(tilt / 2), 0},
                                       (pe_quat){cos(turn), side, -side, 0});
    cube.velocity.x = speed;
    cube.angular_velocity = (pe_vec3){spin * sin(tilt), 0, spin * cos(tilt)};
    return add_body(world, &cube);
}

/* A triangular plate on its three corners, which share its weight in one way only. */
static pe_body_id build_plate(pe_world *world, double speed, double spin)
{
    const double root = sqrt(0.75), height = 0.05;
    pe_vec3 corner[6];
    for (int i = 0; i < 6; ++i) {
        double x = i % 3 == 0 ? 0.5 : -0.25, y = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.5 : -0.5;
        corner[i] = (pe_vec3){x, root * y, i < 3 ? -height : height};
    }
    static const uint32_t triangle[8][3] = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                                            {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
    const pe_geometry_def solid = {corner, triangle, 6, 8, true};
    pe_geometry_id hull;
    assert_int_equal(pe_geometry_create(world, &solid, &hull, NULL), PE_OK);
    pe_body_def plate = pe_body_def_default();
    plate.shape.kind = PE_SHAPE_HULL;
    plate.shape.geometry = hull;
    plate.material = add_material(world, 0.3, 0);
    add_plane(world, (pe_vec3){0, 0, 1}, plate.material);
    plate.position.z = height;
    plate.velocity.x = speed;
    plate.angular_velocity.z = spin;
    return add_body(world, &plate);
}

/* Half a second in steps of 1/480 s over `finer`. */
static pe_body_state run(build_scene *build, double speed, double spin, int finer)
{
    pe_world_def def = pe_world_def_default();
    def.profile = PE_PROFILE_ACCURATE;
    pe_world *world = make_world(&def);
    pe_body_id body = build(world, speed, spin);
    for (int i = 0; i < STEPS_A_SECOND / 2 * finer; ++i) {
        step(world, 1.0 / STEPS_A_SECOND / finer);
    }
    pe_body_state state = state_of(world, body);
    pe_world_destroy(world);
    return state;
}

/* In m and m/s: rotations and angular velocities count at 0.5 m. */
static double difference(const pe_body_state *a, const pe_body_state *b)
{
    pe_quat turn = pe_quat_product(pe_quat_conjugate(a->orientation), b->orientation);
    double angle = 2 * sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
    return pe_length(pe_sub(a->position, b->position)) +
           pe_length(pe_sub(a->velocity, b->velocity)) + 0.5 * angle +
           0.5 * pe_length(pe_sub(a->angular_velocity, b->angular_velocity));
}

static void check_order(build_scene *build, double speed, double spin, double most)
{
    pe_body_state coarse = run(build, speed, spin, 1), medium = run(build, speed, spin, 2),
                  fine = run(build, speed, spin, 4);
    double first = difference(&coarse, &medium), second = difference(&medium, &fine);
    print_message("    speed %g, spin %g: %.2e, then %.2e\n", speed, spin, first, second);
    assert_at_most(first, most);
    assert_at_most(3 * second, first); /* a first-order method would halve it */
}

static void test_top_on_smooth_floor_is_second_order(void **state)
{
    (void)state;
    check_order(build_top, 0, 40, 1e-3);
    check_order(build_top, 0.7, 50, 1e-3);
}

static void test_sliding_spinning_plate_is_second_order(void **state)
{
    (void)state;
    check_order(build_plate, 2, 4, 1e-3);
    check_order(build_plate, 3, -2, 1e-3);
}

/* The largest b_t of the captured problem, over the island's only manifold. */
static double largest_slip_bias(pe_profile profile, double speed, double spin)
{
    pe_world_def def = pe_world_def_default();
    def.profile = profile;
    pe_world *world = make_world(&def);
    build_plate(world, speed, spin);
    for (int i = 0; i < 10; ++i) {
        step(world, 1.0 / STEPS_A_SECOND);
    }
    pe_contact_problem **problems;
    int count;
    double most = 0;
    assert_int_equal(
        pe_world_capture_problems(world, 1.0 / STEPS_A_SECOND, &problems, &count, NULL), PE_OK);
    assert_int_equal(count, 1);
    for (int j = 0; j < problems[0]->point_count; ++j) {
        const double *slip = problems[0]->points[j].slip;
        most = fmax(most, hypot(slip[0], slip[1]));
    }
    pe_contact_problems_destroy(problems, count);
    pe_world_destroy(world);
    return most;
}

static void test_friction_opposes_mean_slip_of_continued_sliding_only(void **state)
{
    (void)state;
    /* Half of the change of a slip of 2 m/s in a step, in size or direction. */
    double going = largest_slip_bias(PE_PROFILE_ACCURATE, 2, 4);
    assert_true(going > 0.2 * 9.81 * 0.3 / STEPS_A_SECOND && going < 0.05);
    assert_true(largest_slip_bias(PE_PROFILE_ACCURATE, 0, 0) == 0);
    assert_at_most(largest_slip_bias(PE_PROFILE_ACCURATE, 0.02, 0), 1e-9); /* has stopped */
    assert_true(largest_slip_bias(PE_PROFILE_FAST, 2, 4) == 0);
}

/* Height that a coin on its rim has lost after two seconds of steady rolling, over its height. */
static double lost_height(double tilt, int steps_a_second)
{
    const double r = 0.5, d = 0.025, s = sin(tilt), c = cos(tilt), height = r * s + d * c;
    const double a = r * r / 4 + d * d / 3, axial = r * r / 2;
    pe_world_def def = pe_world_def_default();
    def.gravity = (pe_vec3){0, 0, -9.81};
    pe_world *world = make_world(&def);
    pe_body_def coin = pe_body_def_default();
    coin.shape.kind = PE_SHAPE_CYLINDER;
    coin.shape.radius = r;
    coin.shape.half_height = d;
    coin.mass = 1;
    coin.material = add_material(world, 0.5, 0);
    add_plane(world, (pe_vec3){0, 0, 1}, coin.material);
    /* The axis turns about the vertical, the centre rests, and friction has nothing to do. */
    double turning = sqrt(9.81 * (r * c - d * s) / (s * c * a - s * s * d * axial / r));
    double along = turning * s * d / r, across = turning * s;
    coin.position.z = height;
    coin.orientation = (pe_quat){cos(tilt / 2), 0, sin(tilt / 2), 0};
    coin.angular_velocity = (pe_vec3){along * s - across * c, 0, along * c + across * s};
    pe_body_id body = add_body(world, &coin);
    double lost = 0;
    for (int i = 0; i < 2 * steps_a_second; ++i) {
        step(world, 1.0 / steps_a_second);
        lost = fmax(lost, fabs(1 - state_of(world, body).position.z / height));
    }
    pe_world_destroy(world);
    return lost;
}

static void test_coin_rolls_on_its_rim_in_second_order(void **state)
{
    (void)state;
    static const double tilts[] = {0.3, 0.5, 0.9};
    for (int i = 0; i < 3; ++i) {
        double coarse = lost_height(tilts[i], 60), fine = lost_height(tilts[i], 120);
        print_message("    tilt %g: %.2e, then %.2e\n", tilts[i], coarse, fine);
        assert_at_most(coarse, 0.01);
        assert_at_most(3 * fine, coarse);
    }
}

/* Height of a block's centre over that at rest when it has rocked on to its other corner, over the
 * one at the start (Housner 1963). */
static double rocked(double slenderness, double tilt, double h)
{
    const double b = 0.25, a = b * slenderness, alpha = atan(1 / slenderness);
    const double radius = sqrt(a * a + b * b), t = alpha * tilt;
    pe_world_def def = pe_world_def_default();
    pe_world *world = make_world(&def);
    pe_body_def block = box_def(b, b, a, (pe_vec3){0, 0, radius * cos(alpha - t)});
    block.material = add_material(world, 2, 0);
    add_plane(world, (pe_vec3){0, 0, 1}, block.material);
    block.orientation = (pe_quat){cos(t / 2), 0, sin(t / 2), 0};
    pe_body_id body = add_body(world, &block);
    double before = 0, apex = 0;
    bool struck = false;
    for (int i = 0; i * h < 3; ++i) {
        step(world, h);
        pe_body_state s = state_of(world, body);
        struck |= s.orientation.y < 0;
        if (struck && before <= 0 && s.velocity.z < 0) {
            break;
        }
        before = s.velocity.z > 0 ? -1 : before;
        apex = struck ? fmax(apex, s.position.z - a) : 0;
    }
    pe_world_destroy(world);
    return apex / (block.position.z - a);
}

static void test_rocking_block_keeps_the_share_that_the_impact_leaves(void **state)
{
    (void)state;
    static const double cases[][2] = {{4, 0.6}, {2, 0.5}, {7, 0.3}, {2.5, 0.4}};
    for (int i = 0; i < 4; ++i) {
        double sine = sin(atan(1 / cases[i][0])), ratio = 1 - 1.5 * sine * sine;
        double found = rocked(cases[i][0], cases[i][1], 1.0 / 60);
        print_message("    slenderness %g, tilt %g: %.5f, expected %.5f\n", cases[i][0],
                      cases[i][1], found, ratio * ratio);
        assert_close(found, ratio * ratio, 2e-3, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coin_rolls_on_its_rim_in_second_order),
        cmocka_unit_test(test_rocking_block_keeps_the_share_that_the_impact_leaves),
        cmocka_unit_test(test_top_on_smooth_floor_is_second_order),
        cmocka_unit_test(test_sliding_spinning_plate_is_second_order),
        cmocka_unit_test(test_friction_opposes_mean_slip_of_continued_sliding_only),
    };
    return cmocka_run_group_tests_name("engine_medium", tests, NULL, NULL);
}
