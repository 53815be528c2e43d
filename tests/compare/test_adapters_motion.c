/* Conformance of every adapter of this build, all profiles: that bodies move as the scene says.
 * Truths: Euler's equations solved densely, Newton's law, the exact sums of semi-implicit Euler. */
#include "check.h"
#include "engine_run.h"
#include "engine_shapes.h"
#include "polyhedra.h"
#include "rotation_for_tests.h"

#include <math.h>
#include <string.h>

static void finish(engine_run *r, pl_scene *scene)
{
    engine_finish(r);
    pl_scene_free(scene);
}

/* A box, or a mesh whose frame is neither at its centre of mass nor along its principal axes. */
static pl_body tumbling_body(pl_scene *scene, bool mesh)
{
    check_random random = {20};
    pl_body body = box_body(3, 0.2, 0.5, 0.9);
    if (mesh) {
        body.shape = pl_shape_of(mesh_of(scene, random_hull(scene, &random, 14)));
    }
    pl_shape_inertia(&body.shape, body.mass, body.inertia);
    check_quaternion(&random, body.orientation);
    memcpy(body.position, (double[]){1, -2, 30}, sizeof body.position);
    memcpy(body.velocity, (double[]){0.3, -0.2, 0.5}, sizeof body.velocity);
    memcpy(body.angular_velocity, (double[]){1.1, 2.3, -1.7}, sizeof body.angular_velocity);
    return body;
}

/* The centre of mass in the world and the orientation of the principal axes, of a body whose frame
 * is at `position` and `orientation`. */
static void principal_pose(const pl_shape *shape, const double position[3],
                           const double orientation[4], double centre[3], double q[4])
{
    static const pl_polyhedron plain = {.axes = {1, 0, 0, 0}};
    const pl_polyhedron *solid = shape->polyhedron != NULL ? shape->polyhedron : &plain;
    to_world(orientation, solid->centre, centre);
    for (int k = 0; k < 3; ++k) {
        centre[k] += position[k];
    }
    quaternion_product(orientation, solid->axes, q);
}

/* y = (q, body angular velocity): q' = q (0, w) / 2, I w' = -w x I w. */
static void euler_rate(const double inertia[3], const double y[7], double rate[7])
{
    const double *q = y, *w = y + 4;
    double spin[3] = {inertia[0] * w[0], inertia[1] * w[1], inertia[2] * w[2]}, torque[3];
    cross(spin, w, torque);
    rate[0] = -0.5 * (q[1] * w[0] + q[2] * w[1] + q[3] * w[2]);
    rate[1] = 0.5 * (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]);
    rate[2] = 0.5 * (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]);
    rate[3] = 0.5 * (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]);
    for (int i = 0; i < 3; ++i) {
        rate[4 + i] = torque[i] / inertia[i];
    }
}

/* The principal axes and the angular velocity after `duration`. Classical Runge-Kutta of order 4
 * with steps of 0.1 ms: its error here is below 1e-12. */
static void dense_tumble(const pl_body *body, double duration, double q[4], double omega[3])
{
    static const double part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    int steps = (int)round(duration / 1e-4);
    double h = duration / steps, y[7], centre[3];
    principal_pose(&body->shape, body->position, body->orientation, centre, y);
    to_body(y, body->angular_velocity, y + 4);
    for (int n = 0; n < steps; ++n) {
        double rate[7] = {0}, sum[7] = {0}, at[7];
        for (int stage = 0; stage < 4; ++stage) {
            for (int i = 0; i < 7; ++i) {
                at[i] = y[i] + part[stage] * h * rate[i];
            }
            euler_rate(body->inertia, at, rate);
            for (int i = 0; i < 7; ++i) {
                sum[i] += weight[stage] * rate[i];
            }
        }
        for (int i = 0; i < 7; ++i) {
            y[i] += h / 6 * sum[i];
        }
    }
    memcpy(q, y, 4 * sizeof *q);
    to_world(q, y + 4, omega);
}

/* Ours moves a body by the mean of its old and new velocity, the others by the new one. */
static bool is_second_order(const pl_engine_choice *choice)
{
    return strcmp(choice->engine->name, "plumb") == 0;
}

/* Errors after one second in orientation (rad) and world angular velocity (rad/s). */
static void tumble(const pl_engine_choice *choice, bool mesh, int steps, double *angle,
                   double *rate)
{
    pl_scene scene = pl_scene_default();
    put_material(&scene, "stone", 0.5, 0);
    put_body(&scene, tumbling_body(&scene, mesh));
    const pl_body *body = &scene.bodies[0];
    memcpy(scene.gravity, (double[]){1, -2, -9}, sizeof scene.gravity);
    double h = 1.0 / steps, q[4], omega[3], start[3], centre[3], axes[4];
    principal_pose(&body->shape, body->position, body->orientation, start, axes);
    engine_run r;
    scene.dt = h;
    engine_start(&r, choice, &scene);
    for (int n = 0; n < steps; ++n) {
        engine_step(&r);
    }
    bool exact = is_second_order(choice);
    principal_pose(&body->shape, r.now[0].position, r.now[0].orientation, centre, axes);
    for (int i = 0; i < 3; ++i) {
        double fall = scene.gravity[i] * h * h * steps * (steps + (exact ? 0 : 1.0)) / 2;
        assert_close(centre[i], start[i] + body->velocity[i] + fall, 1e-11, 1e-12);
        assert_close(r.now[0].velocity[i], body->velocity[i] + scene.gravity[i], 1e-11, 1e-12);
    }
    assert_close(r.time, 1, 1e-12, 0);
    dense_tumble(body, 1, q, omega);
    *angle = angle_between(axes, q);
    *rate = distance(r.now[0].angular_velocity, omega);
    finish(&r, &scene);
}

/* With a wrong convention the error would stay of order 1 however small the step. */
static void check_tumble(const pl_engine_choice *choice, bool mesh)
{
    double angle, rate, fine_angle, fine_rate;
    tumble(choice, mesh, 1000, &angle, &rate);
    tumble(choice, mesh, 4000, &fine_angle, &fine_rate);
    assert_at_most(angle, 0.02);
    assert_at_most(rate, 0.05);
    assert_at_most(fine_angle, fmax(0.3 * angle, 1e-7));
    assert_at_most(fine_rate, fmax(0.3 * rate, 1e-7));
}

static void law_tumble(const pl_engine_choice *choice)
{
    check_tumble(choice, false);
    if (knows(choice, PL_SHAPE_MESH)) {
        check_tumble(choice, true);
    }
}

static void test_free_tumbling_body_converges_to_eulers_equations(void **state)
{
    (void)state;
    for_each_profile(law_tumble);
}

static void law_order(const pl_engine_choice *choice)
{
    pl_scene scene = pl_scene_default();
    put_material(&scene, "stone", 0.5, 0);
    check_random random = {9};
    for (int i = 0; i < MOST_BODIES; ++i) {
        pl_body body = i == 3 ? floor_body() : box_body(1 + i, 0.2, 0.3, 0.4);
        body.is_static = i % 3 == 0;
        if (i % 2 == 1 && i != 3) {
            body.shape = pl_shape_sphere(0.3);
        }
        check_quaternion(&random, body.orientation);
        memcpy(body.position, (double[]){3 * i, -i, 2 + i}, sizeof body.position);
        if (!body.is_static) {
            memcpy(body.velocity, (double[]){0.1 * i, 0.2, 0.3}, sizeof body.velocity);
            memcpy(body.angular_velocity, (double[]){1, 0.1 * i, 2}, sizeof body.velocity);
        }
        put_body(&scene, body);
    }
    engine_run r;
    scene.dt = 1.0 / 100;
    engine_start(&r, choice, &scene);
    assert_close(r.time, 0, 0, 0);
    pl_body_state first[MOST_BODIES];
    memcpy(first, r.now, sizeof first);
    for (int i = 0; i < MOST_BODIES; ++i) {
        const pl_body *body = &scene.bodies[i];
        assert_close(distance(first[i].position, body->position), 0, 1e-14, 0);
        assert_close(distance(first[i].velocity, body->velocity), 0, 1e-14, 0);
        assert_close(distance(first[i].angular_velocity, body->angular_velocity), 0, 1e-14, 0);
        assert_close(angle_between(first[i].orientation, body->orientation), 0, 1e-14, 0);
    }
    for (int n = 0; n < 20; ++n) {
        engine_step(&r);
    }
    for (int i = 0; i < MOST_BODIES; ++i) {
        bool moved = memcmp(&first[i], &r.now[i], sizeof first[i]) != 0;
        assert_int_equal(moved, !scene.bodies[i].is_static);
    }
    finish(&r, &scene);
}

static void test_bodies_keep_scene_order_and_static_poses(void **state)
{
    (void)state;
    for_each_profile(law_order);
}

/* Bodies 0 to 2: a world force at an offset, a body force through the centre, a body force at an
 * offset. Each acts over 10 of 30 steps. */
static void law_forces(const pl_engine_choice *choice)
{
    pl_scene scene = pl_scene_default();
    memset(scene.gravity, 0, sizeof scene.gravity);
    put_material(&scene, "stone", 0.5, 0);
    check_random random = {31};
    /* Ten times 0.1 sums to less than 1, but the eleventh step must count as starting at 1. */
    double dt = 0.1, acting = 1, along[3];
    pl_force forces[3] = {
        {.force = {0, 2, 0}, .at = {0.5, 0, 0}, .frame = PL_FRAME_WORLD},
        {.force = {1, 2, -3}, .frame = PL_FRAME_BODY},
        {.force = {0, 2, 0}, .at = {0.5, 0, 0}, .frame = PL_FRAME_BODY},
    };
    for (int i = 0; i < 3; ++i) {
        pl_body body = box_body(4, 0.2, 0.3, 0.4);
        body.position[0] = 10 * i;
        if (i == 1) {
            check_quaternion(&random, body.orientation);
        }
        forces[i].body = put_body(&scene, body);
        forces[i].from = 1;
        forces[i].until = 2;
        assert_int_equal(pl_scene_add_force(&scene, &forces[i], NULL), PL_OK);
    }
    engine_run r;
    scene.dt = dt;
    engine_start(&r, choice, &scene);
    for (int n = 1; n <= 30; ++n) {
        engine_step(&r);
        double share = fmin(fmax(n - 10, 0), 10) / 10.0;
        assert_close(r.now[0].velocity[1], share * acting * 2 / 4, 1e-13, 0);
    }
    double about_z = scene.bodies[0].inertia[2];
    to_world(scene.bodies[1].orientation, forces[1].force, along);
    for (int k = 0; k < 3; ++k) {
        assert_close(r.now[0].angular_velocity[k], k == 2 ? acting / about_z : 0, 1e-12, 0);
        assert_close(r.now[1].velocity[k], acting * along[k] / 4, 1e-12, 0);
        assert_close(r.now[1].angular_velocity[k], 0, 1e-12, 0);
        assert_close(r.now[2].angular_velocity[k], k == 2 ? acting / about_z : 0, 1e-12, 0);
    }
    /* The third turned by then, and its force with it. */
    assert_true(r.now[2].velocity[0] < -1e-3);
    finish(&r, &scene);
}

static void test_forces_accelerate_by_newton_and_euler_when_active(void **state)
{
    (void)state;
    for_each_profile(law_forces);
}

/* A mesh, at rest and without gravity, under a force F of its body frame along one principal axis,
 * at an arm d along the next: it turns about the third, k, by angle(t) = d F t^2 / (2 I_k), and
 *
 *     x(T) = F/m integral_0^T (T - t) (cos angle, -sin angle) dt,   v(T) without (T - t),
 *
 * by Cauchy's formula for the double integral: Fresnel's integrals. Here over one second, by the
 * midpoint rule on 2e4 intervals. */
enum { THRUST = 12, MIDPOINTS = 20000 };

static void fly(double acceleration, double spin_up, double x[2], double v[2])
{
    x[0] = x[1] = v[0] = v[1] = 0;
    for (int i = 0; i < MIDPOINTS; ++i) {
        double t = (i + 0.5) / MIDPOINTS, angle = spin_up * t * t / 2;
        double along[2] = {cos(angle), -sin(angle)};
        for (int k = 0; k < 2; ++k) {
            x[k] += acceleration * (1 - t) * along[k] / MIDPOINTS;
            v[k] += acceleration * along[k] / MIDPOINTS;
        }
    }
}

/* Errors after one second in the place (m) and velocity (m/s) of the centre of mass, for an arm
 * that spins the mesh up by `spin_up` (rad/s^2). */
static void rocket(const pl_engine_choice *choice, double spin_up, int steps, double *place,
                   double *rate)
{
    pl_scene scene = pl_scene_default();
    memset(scene.gravity, 0, sizeof scene.gravity);
    put_material(&scene, "stone", 0.5, 0);
    pl_body body = tumbling_body(&scene, true);
    memset(body.velocity, 0, sizeof body.velocity);
    memset(body.angular_velocity, 0, sizeof body.angular_velocity);
    const double *inertia = body.inertia;
    int k = inertia[0] > inertia[1] ? 0 : 1;
    k = inertia[2] > inertia[k] ? 2 : k;
    double unit[3][3] = {{0}}, axis[3][3]; /* along, arm, about: in the world */
    double start[3], centre[3], q[4], x[2], v[2];
    principal_pose(&body.shape, body.position, body.orientation, start, q);
    pl_force force = {.frame = PL_FRAME_BODY, .until = INFINITY};
    for (int i = 0; i < 3; ++i) {
        unit[i][(k + 1 + i) % 3] = 1;
        to_world(q, unit[i], axis[i]);
    }
    for (int i = 0; i < 2; ++i) {
        double in_shape[3];
        to_world(body.shape.polyhedron->axes, unit[i], in_shape);
        for (int c = 0; c < 3; ++c) {
            double arm = spin_up * inertia[k] / THRUST;
            *(i == 0 ? &force.force[c] : &force.at[c]) = in_shape[c] * (i == 0 ? THRUST : arm);
        }
    }
    force.body = put_body(&scene, body);
    assert_int_equal(pl_scene_add_force(&scene, &force, NULL), PL_OK);
    engine_run r;
    scene.dt = 1.0 / steps;
    engine_start(&r, choice, &scene);
    for (int n = 0; n < steps; ++n) {
        engine_step(&r);
    }
    fly(THRUST / body.mass, spin_up, x, v);
    double at[3], velocity[3];
    principal_pose(&body.shape, r.now[0].position, r.now[0].orientation, centre, q);
    for (int c = 0; c < 3; ++c) {
        at[c] = start[c] + x[0] * axis[0][c] + x[1] * axis[1][c];
        velocity[c] = v[0] * axis[0][c] + v[1] * axis[1][c];
        /* F along the first axis at an arm along the second turns about minus the third. */
        assert_close(r.now[0].angular_velocity[c], -spin_up * axis[2][c], 1e-9, 0);
    }
    *place = distance(centre, at);
    *rate = distance(r.now[0].velocity, velocity);
    finish(&r, &scene);
}

static void law_rocket(const pl_engine_choice *choice)
{
    if (!knows(choice, PL_SHAPE_MESH)) {
        return;
    }
    double place, rate, fine_place, fine_rate;
    rocket(choice, 4, 250, &place, &rate);
    rocket(choice, 4, 1000, &fine_place, &fine_rate);
    print_message("      off by %.1e m, %.1e m/s, at a quarter of the step %.1e, %.1e\n", place,
                  rate, fine_place, fine_rate);
    assert_at_most(place, 0.02);
    assert_at_most(rate, 0.05);
    /* An engine may be right to the error of the expected path. */
    assert_at_most(fine_place, fmax(0.3 * place, 1e-8));
    assert_at_most(fine_rate, fmax(0.3 * rate, 1e-8));
    /* On the axis: a straight line, with the exact sums of the two orders. */
    rocket(choice, 0, 100, &place, &rate);
    double late = is_second_order(choice) ? 0 : 0.5 * THRUST / 3 / 100;
    assert_close(place, late, 1e-10, 0);
    assert_at_most(rate, 1e-10);
}

static void test_rocket_off_its_axis_flies_fresnels_path(void **state)
{
    (void)state;
    for_each_profile(law_rocket);
}

/* A world force on a resting mesh: m v = F t, I w = r x F, over one short step. */
static void law_world_force(const pl_engine_choice *choice)
{
    if (!knows(choice, PL_SHAPE_MESH)) {
        return;
    }
    pl_scene scene = pl_scene_default();
    memset(scene.gravity, 0, sizeof scene.gravity);
    put_material(&scene, "stone", 0.5, 0);
    pl_body body = tumbling_body(&scene, true);
    memset(body.velocity, 0, sizeof body.velocity);
    memset(body.angular_velocity, 0, sizeof body.angular_velocity);
    pl_force force = {.force = {3, -1, 2}, .at = {0.2, 0.4, -0.3}, .until = INFINITY};
    force.body = put_body(&scene, body);
    assert_int_equal(pl_scene_add_force(&scene, &force, NULL), PL_OK);
    engine_run r;
    const double dt = 1e-4;
    scene.dt = dt;
    engine_start(&r, choice, &scene);
    double centre[3], q[4], torque[3], turning[3], expected[3];
    engine_step(&r);
    principal_pose(&body.shape, body.position, body.orientation, centre, q);
    cross(force.at, force.force, torque);
    to_body(q, torque, turning);
    for (int k = 0; k < 3; ++k) {
        turning[k] *= dt / body.inertia[k];
        assert_close(r.now[0].velocity[k], dt * force.force[k] / body.mass, 1e-15, 1e-12);
    }
    to_world(q, turning, expected);
    assert_at_most(distance(r.now[0].angular_velocity, expected),
                   1e-6 * distance(expected, (double[]){0, 0, 0}));
    finish(&r, &scene);
}

static void test_mesh_force_acts_about_its_centre_of_mass(void **state)
{
    (void)state;
    for_each_profile(law_world_force);
}

/* A sleeping body would stay at rest. How exactly it slides is another law's matter. */
static void law_no_sleep(const pl_engine_choice *choice)
{
    if (!solves_coulomb(choice)) {
        return;
    }
    pl_scene scene = scene_with_block(0.2, 1, 0.5, 0.1);
    pl_force push = {.force = {6, 0, 0}, .body = 1, .from = 10, .until = INFINITY};
    assert_int_equal(pl_scene_add_force(&scene, &push, NULL), PL_OK);
    engine_run r;
    scene.dt = 1.0 / 60;
    engine_start(&r, choice, &scene);
    for (int n = 0; n < 600; ++n) {
        engine_step(&r);
    }
    assert_close(r.now[1].velocity[0], 0, 1e-3, 0);
    for (int n = 0; n < 30; ++n) {
        engine_step(&r);
    }
    assert_close(r.now[1].velocity[0], 0.5 * (6 - 0.2 * g), 0, 0.1);
    finish(&r, &scene);
}

static void test_body_at_rest_still_responds_to_a_force(void **state)
{
    (void)state;
    for_each_profile(law_no_sleep);
}

/* The same scene twice gives the same bits, though instances share the process. */
static void law_repeats(const pl_engine_choice *choice)
{
    pl_body_state last[2][MOST_BODIES];
    memset(last, 0, sizeof last);
    for (int turn = 0; turn < 2; ++turn) {
        pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
        for (int i = 0; i < 3; ++i) {
            pl_body cube = box_body(1, 0.5, 0.5, 0.5);
            cube.position[0] = 0.1 * i;
            cube.position[2] = 1.5 + i;
            put_body(&scene, cube);
        }
        engine_run r;
        scene.dt = 1.0 / 60;
        engine_start(&r, choice, &scene);
        for (int n = 0; n < 60; ++n) {
            engine_step(&r);
        }
        memcpy(last[turn], r.now, (size_t)scene.body_count * sizeof *r.now);
        finish(&r, &scene);
    }
    assert_memory_equal(last[0], last[1], sizeof last[0]);
}

static void test_the_same_scene_twice_gives_the_same_bits(void **state)
{
    (void)state;
    for_each_profile(law_repeats);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_tumbling_body_converges_to_eulers_equations),
        cmocka_unit_test(test_bodies_keep_scene_order_and_static_poses),
        cmocka_unit_test(test_forces_accelerate_by_newton_and_euler_when_active),
        cmocka_unit_test(test_rocket_off_its_axis_flies_fresnels_path),
        cmocka_unit_test(test_mesh_force_acts_about_its_centre_of_mass),
        cmocka_unit_test(test_body_at_rest_still_responds_to_a_force),
        cmocka_unit_test(test_the_same_scene_twice_gives_the_same_bits),
    };
    return cmocka_run_group_tests_name("adapters motion", tests, NULL, NULL);
}
