/* The catalogue's rain of balls: its reference, followed from impact to impact, equals small steps of
 * time with impulses that grow by little. */
#include "check.h"
#include "plumb_process.h"
#include "run_result.h"
#include "scenario_scene.h"

#include <math.h>
#include <string.h>

static const double g = 9.81; /* m/s^2 */

enum { MOST = 40 };

typedef struct ball {
    double mass, radius, x[3], v[3], w[3];
} ball;

static void cross(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; ++k) {
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

static double energy_of(const ball *b, int count)
{
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            sum += b[i].mass / 2 * b[i].v[k] * b[i].v[k];
            sum += b[i].mass / 5 * b[i].radius * b[i].radius * b[i].w[k] * b[i].w[k];
        }
        sum += b[i].mass * g * b[i].x[2];
    }
    return sum;
}

/* Adds the velocity of the point at `arm` from the centre, times side. */
static void add_velocity(const ball *b, const double arm[3], double side, double u[3])
{
    double turn[3];
    cross(b->w, arm, turn);
    for (int k = 0; k < 3; ++k) {
        u[k] += side * (b->v[k] + turn[k]);
    }
}

static void push(ball *b, const double arm[3], double side, const double p[3])
{
    double turn[3];
    cross(arm, p, turn);
    for (int k = 0; k < 3; ++k) {
        b->v[k] += side * p[k] / b->mass;
        b->w[k] += side * turn[k] / (0.4 * b->mass * b->radius * b->radius);
    }
}

/* Routh's way: the normal impulse grows by little, and with it friction against the slip of the
 * moment. `b` is NULL for the floor; n points from b to a. */
static void strike(ball *a, ball *b, const double n[3], double e, double friction)
{
    enum { PARTS = 2000 };
    double arm_a[3], arm_b[3] = {0, 0, 0}, part = 0;
    const double mass = 1 / (1 / a->mass + (b != NULL ? 1 / b->mass : 0));
    for (int k = 0; k < 3; ++k) {
        arm_a[k] = -a->radius * n[k];
        arm_b[k] = b != NULL ? b->radius * n[k] : 0;
    }
    for (int i = 0; i < PARTS; ++i) {
        double u[3] = {0, 0, 0}, p[3], slip = 0;
        add_velocity(a, arm_a, 1, u);
        if (b != NULL) {
            add_velocity(b, arm_b, -1, u);
        }
        const double into = -(u[0] * n[0] + u[1] * n[1] + u[2] * n[2]);
        part = i == 0 ? (1 + e) * mass * into / PARTS : part;
        for (int k = 0; k < 3; ++k) {
            u[k] += into * n[k];
            slip += u[k] * u[k];
        }
        const double rub = fmin(mass * 2 / 7, friction * part / fmax(sqrt(slip), 1e-300));
        for (int k = 0; k < 3; ++k) {
            p[k] = part * n[k] - rub * u[k];
        }
        push(a, arm_a, 1, p);
        if (b != NULL) {
            push(b, arm_b, -1, p);
        }
    }
}

static void strike_all(ball *b, int count, double e, double friction)
{
    static const double up[3] = {0, 0, 1};
    for (int i = 0; i < count; ++i) {
        if (b[i].x[2] < b[i].radius && b[i].v[2] < 0) {
            strike(&b[i], NULL, up, e, friction);
        }
        for (int j = 0; j < i; ++j) {
            double n[3], square = 0, along = 0;
            const double reach = b[i].radius + b[j].radius;
            for (int k = 0; k < 3; ++k) {
                n[k] = b[i].x[k] - b[j].x[k];
                square += n[k] * n[k];
                along += n[k] * (b[i].v[k] - b[j].v[k]);
            }
            if (square < reach * reach && along < 0) {
                for (int k = 0; k < 3; ++k) {
                    n[k] /= sqrt(square);
                }
                strike(&b[i], &b[j], n, e, friction);
            }
        }
    }
}

/* The balls of a scene, marched until `end`; returns the energy that they have lost. */
static double march(const pl_scene *scene, double end, ball *b)
{
    const int count = scene->body_count - 1;
    const double h = 4e-6;
    assert_true(count <= MOST);
    for (int i = 0; i < count; ++i) {
        const pl_body *body = &scene->bodies[i + 1];
        b[i] = (ball){.mass = body->mass, .radius = body->shape.radius};
        memcpy(b[i].x, body->position, sizeof b[i].x);
        memcpy(b[i].v, body->velocity, sizeof b[i].v);
    }
    const double before = energy_of(b, count);
    for (long n = lround(end / h); n > 0; --n) {
        for (int i = 0; i < count; ++i) {
            for (int k = 0; k < 3; ++k) {
                b[i].x[k] += h * b[i].v[k] - (k == 2 ? h * h * g / 2 : 0);
            }
            b[i].v[2] -= h * g;
        }
        strike_all(b, count, scene->materials[0].restitution, scene->materials[0].friction);
    }
    return before - energy_of(b, count);
}

static void test_rain_equals_small_time_steps(void **state)
{
    (void)state;
    static const char *const settings[][5] = {
        {"n=30", "columns=3", NULL},
        {"n=30", "columns=3", "restitution=0.5", "friction=0", NULL},
        {"n=24", "columns=2", "duration=0.9", "friction=1", NULL}};
    static const int counts[] = {2, 4, 4};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene;
        ball b[MOST];
        build_scenario("rain", settings[i], counts[i], 1, &scene);
        assert_int_equal(scene.value_count, 3 * (scene.body_count - 1));
        const double end = scene.values[0].until, lost = march(&scene, end, b);
        for (int k = 0; k < scene.value_count; ++k) {
            const pl_expect_value *value = &scene.values[k];
            const double *start = scene.bodies[value->body].position;
            assert_int_equal(value->body, k / 3 + 1);
            assert_close(value->until, end, 0, 0);
            assert_close(value->value, b[k / 3].x[k % 3] - start[k % 3], 2e-3, 0);
        }
        for (int k = 0; k < scene.statistic_count; ++k) {
            assert_close(scene.statistics[k].low, lost, 0, 1e-3);
            assert_close(scene.statistics[k].high, scene.statistics[k].low, 0, 0);
        }
        assert_true(i > 0 || scene.statistic_count == 1);
        pl_scene_free(&scene);
    }
}

static void test_rain_starts_apart_and_hits_itself(void **state)
{
    (void)state;
    pl_scene scene;
    build_scenario("rain", NULL, 0, 5, &scene);
    int turned_aside = 0;
    for (int i = 1; i < scene.body_count; ++i) {
        const pl_body *a = &scene.bodies[i];
        assert_true(a->position[2] > 1 + a->shape.radius);
        for (int j = 1; j < i; ++j) {
            const pl_body *b = &scene.bodies[j];
            const double *x = a->position, *y = b->position;
            assert_true(hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]) >=
                        a->shape.radius + b->shape.radius);
        }
        const pl_expect_value *x = expected_value(&scene, i, PL_QUANTITY_POSITION, 0);
        turned_aside += fabs(x->value - a->velocity[0] * x->until) > 0.01;
    }
    assert_true(turned_aside > 20);
    pl_scene_free(&scene);
}

/* Balls that rest no longer fly: what is expected ends before, and energy is not. */
static void test_rain_is_followed_while_impacts_are_apart(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=2", "columns=2", "duration=5", NULL};
    pl_scene scene = scenario_scene("rain", settings);
    assert_int_equal(scene.statistic_count, 0);
    /* The lowest ball's bounces, of e^k the time of the first, add up to this. */
    double rest = HUGE_VAL;
    for (int i = 1; i <= 2; ++i) {
        const double fall =
            sqrt(2 * (scene.bodies[i].position[2] - scene.bodies[i].shape.radius) / g);
        rest = fmin(rest, fall * 1.7 / 0.3);
    }
    assert_true(scene.values[0].until < rest && scene.values[0].until > 0.98 * rest - 1.0 / 60);
    pl_scene_free(&scene);
}

static void test_accurate_loses_the_energy_of_each_impact(void **state)
{
    (void)state;
    static const char *const few[] = {"n=10", "columns=2", NULL};
    assert_at_most(accurate_metric("rain", few, "1/2000", "statistics_error"), 1e-3);
    assert_at_most(accurate_metric("rain", few, "1/2000", "value_error"), 1e-2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rain_equals_small_time_steps),
        cmocka_unit_test(test_rain_starts_apart_and_hits_itself),
        cmocka_unit_test(test_rain_is_followed_while_impacts_are_apart),
        cmocka_unit_test(test_accurate_loses_the_energy_of_each_impact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
