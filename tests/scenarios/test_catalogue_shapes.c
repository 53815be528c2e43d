/* The scenarios of shapes: what rests touches, what rolls and flies follows laws worked out here by
 * another way. */
#include "base/trigonometry.h"
#include "check.h"
#include "plumb/vec.h"
#include "referee/geometry/gap.h"
#include "scenario_scene.h"

#include <math.h>
#include <stdio.h>

static double gap_at(const pl_scene *scene, int a, int b, const double position_b[3])
{
    const pl_body *p = &scene->bodies[a], *q = &scene->bodies[b];
    pl_placed_shape placed_a = {.shape = &p->shape}, placed_b = {.shape = &q->shape};
    for (int k = 0; k < 4; ++k) {
        placed_a.orientation[k] = p->orientation[k];
        placed_b.orientation[k] = q->orientation[k];
    }
    for (int k = 0; k < 3; ++k) {
        placed_a.position[k] = p->position[k];
        placed_b.position[k] = position_b[k];
    }
    double gap = 0;
    assert_int_equal(pl_gap(&placed_a, &placed_b, (double)INFINITY, &gap), PL_OK);
    return gap;
}

/* The centre of mass, in the world. */
static pl_vec centre_of(const pl_body *body)
{
    pl_vec x = pl_vec_of(body->position);
    if (body->shape.polyhedron != NULL) {
        pl_axes axes = pl_axes_of(body->orientation);
        x = pl_vec_add(x, pl_to_world(&axes, pl_vec_of(body->shape.polyhedron->centre)));
    }
    return x;
}

static void test_every_shape_touches_the_floor_and_can_rest(void **state)
{
    (void)state;
    for (int shape = 0; shape <= 7; ++shape) {
        for (int mesh = 0; mesh <= 1; ++mesh) {
            char shape_is[16], mesh_is[16];
            snprintf(shape_is, sizeof shape_is, "shape=%d", shape);
            snprintf(mesh_is, sizeof mesh_is, "mesh=%d", mesh);
            const char *const settings[] = {shape_is, mesh_is};
            pl_scene scene;
            build_scenario("rest-shape", settings, 2, 1, &scene);
            const pl_body *body = &scene.bodies[1];
            assert_close(gap_at(&scene, 0, 1, body->position), 0, 1e-15, 0);
            const pl_polyhedron *p = body->shape.polyhedron;
            if (p != NULL) {
                /* The centre of mass lies over the bounds of the corners on the floor. */
                double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
                for (int i = 0; i < p->vertex_count; ++i) {
                    const double *v = p->vertices[i];
                    for (int k = 0; k < 2 && fabs(v[2] + body->position[2]) < 1e-12; ++k) {
                        low[k] = fmin(low[k], v[k]);
                        high[k] = fmax(high[k], v[k]);
                    }
                }
                for (int k = 0; k < 2; ++k) {
                    assert_true(p->centre[k] > low[k] + 1e-3 && p->centre[k] < high[k] - 1e-3);
                }
                assert_true(p->convex == (mesh == 0 && shape < 6));
            }
            pl_scene_free(&scene);
        }
    }
}

static void test_linked_rings_touch_only_at_rest(void **state)
{
    (void)state;
    pl_scene scene;
    build_scenario("linked-rings", NULL, 0, 1, &scene);
    const double *rest = scene.rests[0].position;
    assert_close(gap_at(&scene, 0, 1, rest), 0, 1e-15, 0);
    double above[3] = {rest[0], rest[1], rest[2] + 0.01};
    assert_close(gap_at(&scene, 0, 1, above), 0.01, 1e-12, 0);
    /* Linked: the lower ring's tube crosses the upper one's plane inside its hole, and outside. */
    assert_true(-rest[2] > 0.5 && -rest[2] < 1);
    pl_scene_free(&scene);
    const char *const settings[] = {"drop=0.25"};
    build_scenario("linked-rings", settings, 1, 1, &scene);
    assert_close(scene.bodies[1].position[2] - scene.rests[0].position[2], 0.25, 1e-15, 0);
    assert_true(gap_at(&scene, 0, 1, scene.bodies[1].position) > 0.1);
    pl_scene_free(&scene);
}

static void test_rollers_touch_the_slope(void **state)
{
    (void)state;
    static const char *const shapes[] = {"shape=0", "shape=1", "shape=2"};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene;
        build_scenario("roll-slope", &shapes[i], 1, 1, &scene);
        assert_close(gap_at(&scene, 0, 1, scene.bodies[1].position), 0, 1e-15, 0);
        pl_scene_free(&scene);
    }
}

/* By the torque about the line of contact: (m r^2 + I) a / r = m g r sin(angle). */
static void test_rolling_distance_follows_from_contact_torque(void **state)
{
    (void)state;
    static const char *const shapes[] = {"shape=0", "shape=1"};
    for (int i = 0; i < 2; ++i) {
        pl_scene scene;
        build_scenario("roll-slope", &shapes[i], 1, 1, &scene);
        const pl_body *body = &scene.bodies[1];
        double r = body->shape.radius, m = body->mass;
        double inertia = body->inertia[i == 0 ? 0 : 2]; /* about the axis of the roll */
        double a = m * 9.81 * r * sin(0.3) / ((m * r * r + inertia) / r), v = 0, x = 0;
        for (long n = 0; n < pl_scene_steps(&scene); ++n) {
            v += a * scene.dt;
            x += v * scene.dt;
        }
        assert_close(scene.travels[0].discrete, x, 0, 1e-12);
        assert_close(scene.travels[0].distance, a * 2, 0, 1e-12);
        pl_scene_free(&scene);
    }
    pl_error error = {.message = ""};
    const pl_scenario *scenario = pl_scenario_find("roll-slope", NULL);
    double values[PL_MAX_PARAMS];
    const char *const slips[] = {"angle=1.2", "friction=0.5"};
    assert_int_equal(pl_scenario_values(scenario, slips, 2, values, NULL), PL_OK);
    pl_scene scene;
    assert_int_equal(pl_scenario_build(scenario, values, 0, &scene, &error), PL_BAD_INPUT);
    assert_contains(error.message, "where it does not slip");
}

/* Newton's and Euler's equations by the classical Runge-Kutta method in small steps. */
static void fly(const pl_scene *scene, double way[2])
{
    enum { STEPS = 20000 };
    const pl_force *f = &scene->forces[0];
    const pl_body *body = &scene->bodies[0];
    double h = scene->duration / STEPS, torque = f->at[2] * f->force[0] - f->at[0] * f->force[2];
    double s[6] = {0}; /* x, z, angle, and their rates */
    for (int n = 0; n < STEPS; ++n) {
        double k[4][6], at[6];
        for (int stage = 0; stage < 4; ++stage) {
            double part = stage == 0 ? 0 : stage == 3 ? h : h / 2;
            for (int i = 0; i < 6; ++i) {
                at[i] = s[i] + (stage == 0 ? 0 : part * k[stage - 1][i]);
            }
            for (int i = 0; i < 3; ++i) {
                k[stage][i] = at[3 + i];
            }
            k[stage][3] = f->force[2] * sin(at[2]) / body->mass;
            k[stage][4] = f->force[2] * cos(at[2]) / body->mass - 9.81;
            k[stage][5] = torque / body->inertia[1];
        }
        for (int i = 0; i < 6; ++i) {
            s[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
        }
    }
    way[0] = s[0];
    way[1] = s[1];
}

static void test_rocket_flies_as_runge_kutta_says(void **state)
{
    (void)state;
    static const char *const offsets[] = {"offset=0", "offset=0.01", "offset=-0.05", "offset=0.2"};
    for (int i = 0; i < 4; ++i) {
        pl_scene scene;
        build_scenario("rocket", &offsets[i], 1, 1, &scene);
        double way[2];
        fly(&scene, way);
        const pl_expect_travel *travel = &scene.travels[0];
        assert_close(travel->distance * travel->direction[0], way[0], 1e-9, 0);
        assert_close(travel->distance * travel->direction[2], way[1], 1e-9, 0);
        pl_scene_free(&scene);
    }
}

static void test_body_at_the_wall_stops_at_touch(void **state)
{
    (void)state;
    static const char *const shapes[] = {"shape=0", "shape=1", "shape=2"};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene;
        build_scenario("thin-wall", &shapes[i], 1, 1, &scene);
        assert_close(gap_at(&scene, 0, 1, scene.rests[0].position), 0, 1e-15, 0);
        assert_true(gap_at(&scene, 0, 1, scene.bodies[1].position) > 7);
        pl_scene_free(&scene);
    }
}

static void test_blocks_lie_on_the_floor_apart(void **state)
{
    (void)state;
    static const char *const kinds[] = {"mesh=0", "mesh=1"};
    for (int i = 0; i < 2; ++i) {
        const char *const settings[] = {"n=10", kinds[i]};
        pl_scene scene;
        build_scenario("blocks", settings, 2, 1, &scene);
        assert_int_equal(scene.body_count, 11);
        for (int b = 1; b <= 10; ++b) {
            assert_close(gap_at(&scene, 0, b, scene.bodies[b].position), 0, 1e-15, 0);
            for (int c = 1; c < b; ++c) {
                assert_true(gap_at(&scene, c, b, scene.bodies[b].position) >= 0.5 - 1e-12);
            }
        }
        pl_scene_free(&scene);
    }
}

static void test_bodies_of_a_pile_start_apart(void **state)
{
    (void)state;
    static const char *const kinds[] = {"shape=3", "shape=4"};
    for (int i = 0; i < 2; ++i) {
        const char *const settings[] = {"n=40", kinds[i]};
        pl_scene scene;
        build_scenario("pile", settings, 2, 1, &scene);
        for (int b = 5; b < scene.body_count; ++b) {
            for (int c = 0; c < b; ++c) {
                double reach = 2;
                pl_vec d = pl_vec_sub(centre_of(&scene.bodies[b]), centre_of(&scene.bodies[c]));
                if (c < 5 || pl_vec_length(d) < reach) {
                    assert_true(gap_at(&scene, c, b, scene.bodies[b].position) > 0);
                }
            }
        }
        pl_scene_free(&scene);
    }
}

static void test_circle_points_mirror_each_other_exactly(void **state)
{
    (void)state;
    for (int n = 4; n <= 400; n += 4) {
        for (int k = 0; k < n; ++k) {
            double x, y, u, v;
            pl_circle_point(k, n, &x, &y);
            long double angle = 2 * acosl(-1) * k / n;
            assert_close(x, (double)cosl(angle), 4e-16, 0);
            assert_close(y, (double)sinl(angle), 4e-16, 0);
            pl_circle_point((n - k) % n, n, &u, &v);
            assert_true(x == u && y == -v);
            pl_circle_point((k + n / 4) % n, n, &u, &v);
            assert_true(u == -y && v == x);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_shape_touches_the_floor_and_can_rest),
        cmocka_unit_test(test_linked_rings_touch_only_at_rest),
        cmocka_unit_test(test_rollers_touch_the_slope),
        cmocka_unit_test(test_rolling_distance_follows_from_contact_torque),
        cmocka_unit_test(test_rocket_flies_as_runge_kutta_says),
        cmocka_unit_test(test_body_at_the_wall_stops_at_touch),
        cmocka_unit_test(test_blocks_lie_on_the_floor_apart),
        cmocka_unit_test(test_bodies_of_a_pile_start_apart),
        cmocka_unit_test(test_circle_points_mirror_each_other_exactly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
