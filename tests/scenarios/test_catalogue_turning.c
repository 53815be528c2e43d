/* The references of the top, of the plate that slides and spins, and of the coin that rolls on its
 * edge, by another way than the builders'. */
#include "check.h"
#include "scenario_scene.h"

#include <math.h>
#include <string.h>

static const double g = 9.81; /* m/s^2 */

/* A symmetric top whose tip, at -l along its axis a, stays on a smooth floor. y = (a, L), L the
 * angular momentum about the centre. */
typedef struct gyro {
    double mass, across, along, length;
} gyro;

static void cross(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; ++k) {
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

/* a' = L x a / I1; the tip stays on the floor: the centre is at z = l a_z, so that the reaction N
 * satisfies N = m (g + l a_z'') with L' = N l z x a, which gives a_z'' as a line in N. */
static void gyro_rate(const void *context, double t, const double *y, double *rate)
{
    (void)t;
    const gyro *top = context;
    const double *a = y, *momentum = y + 3, up[3] = {0, 0, 1};
    double turned[3], lever[3], of_turn[3], of_lever[3];
    cross(momentum, a, turned);
    for (int k = 0; k < 3; ++k) {
        rate[k] = turned[k] / top->across;
    }
    cross(up, a, lever);
    cross(momentum, rate, of_turn);
    cross(lever, a, of_lever);
    /* a_z'' = (L' x a + L x a')_z / I1 = (N l (z x a) x a + L x a')_z / I1 */
    const double free = of_turn[2] / top->across;
    const double yields = top->length * of_lever[2] / top->across;
    const double reaction =
        top->mass * (g + top->length * free) / (1 - top->mass * top->length * yields);
    for (int k = 0; k < 3; ++k) {
        rate[3 + k] = reaction * top->length * lever[k];
    }
}

static void spin_of(const gyro *top, const double *y, double spin[3])
{
    const double along = y[0] * y[3] + y[1] * y[4] + y[2] * y[5];
    for (int k = 0; k < 3; ++k) {
        spin[k] = y[3 + k] / top->across + (1 / top->along - 1 / top->across) * along * y[k];
    }
}

/* Of the hull, along an axis of its own frame. */
static double inertia_along(const pl_body *body, int axis)
{
    const double *q = body->shape.polyhedron->axes;
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double rotation[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    double inertia = 0;
    for (int k = 0; k < 3; ++k) {
        inertia += body->inertia[k] * rotation[axis][k] * rotation[axis][k];
    }
    return inertia;
}

static void test_top_precesses_by_its_equations_of_motion(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"spin=25", "tilt=0.3", "duration=3", NULL},
                                              {"spin=13", "tilt=0.1", "duration=5", NULL},
                                              {"spin=60", "tilt=0.6", "duration=4", NULL},
                                              {"spin=12", "tilt=0.6", "duration=3", NULL}};
    for (int i = 0; i < 4; ++i) {
        pl_scene scene = scenario_scene("top", settings[i]);
        const pl_body *body = &scene.bodies[1];
        const double *w = body->angular_velocity, half = acos(body->orientation[0]);
        const double a[3] = {sin(2 * half), 0, cos(2 * half)};
        const gyro top = {body->mass, inertia_along(body, 0), inertia_along(body, 2), 0.75};
        assert_close(inertia_along(body, 1), top.across, 0, 1e-12);
        assert_close(body->position[2], 0.75 * a[2], 1e-14, 0);
        for (int k = 0; k < 3; ++k) {
            assert_close(body->shape.polyhedron->centre[k], 0, 1e-15, 0);
        }
        double y[6], spin[3];
        const double along = w[0] * a[0] + w[2] * a[2];
        for (int k = 0; k < 3; ++k) {
            y[k] = a[k];
            y[3 + k] = top.across * w[k] + (top.along - top.across) * along * a[k];
        }
        integrate(gyro_rate, &top, 0, scene.duration, 40000, 6, y);
        assert_close(y[2], a[2], 1e-10, 0); /* steady */
        spin_of(&top, y, spin);
        for (int k = 0; k < 3; ++k) {
            const pl_expect_value *value = expected_value(&scene, 1, PL_QUANTITY_SPIN, k);
            assert_close(value->value, spin[k], 1e-7, 0);
        }
        pl_scene_free(&scene);
    }
}

/* Reactions of three points by elimination from force and moments; slips are unit. */
static void share_weight(const double r[3][2], const double slip[3][2], double friction,
                         double height, double reaction[3])
{
    double m[3][4];
    for (int i = 0; i < 3; ++i) {
        m[0][i] = 1;
        m[1][i] = r[i][0] - friction * height * slip[i][0];
        m[2][i] = r[i][1] - friction * height * slip[i][1];
    }
    m[0][3] = g, m[1][3] = 0, m[2][3] = 0;
    for (int k = 0; k < 3; ++k) {
        int pivot = k;
        for (int i = k + 1; i < 3; ++i) {
            pivot = fabs(m[i][k]) > fabs(m[pivot][k]) ? i : pivot;
        }
        for (int j = 0; j < 4; ++j) {
            const double keep = m[k][j];
            m[k][j] = m[pivot][j];
            m[pivot][j] = keep;
        }
        for (int i = 0; i < 3; ++i) {
            const double part = i == k ? 0 : m[i][k] / m[k][k];
            for (int j = 0; j < 4; ++j) {
                m[i][j] -= part * m[k][j];
            }
        }
    }
    for (int k = 0; k < 3; ++k) {
        reaction[k] = m[k][3] / m[k][k];
    }
}

typedef struct plate {
    double x, y, turn, vx, vy, spin, energy_lost;
} plate;

/* Euler's rule with steps of h, with the mean of old and new velocities for the way. */
static plate slide(const pl_scene *scene, double h)
{
    const pl_body *body = &scene->bodies[1];
    const double friction = scene->materials[0].friction;
    plate p = {.vx = body->velocity[0], .spin = body->angular_velocity[2]};
    for (double time = 0; time < scene->duration; time += h) {
        double r[3][2], slip[3][2], speed[3], n[3], force[2] = {0, 0}, torque = 0;
        for (int i = 0; i < 3; ++i) {
            const double angle = p.turn + (2 * i + 1) * atan(1) * 4 / 3;
            r[i][0] = 0.5 * cos(angle), r[i][1] = 0.5 * sin(angle);
            slip[i][0] = p.vx - p.spin * r[i][1], slip[i][1] = p.vy + p.spin * r[i][0];
            speed[i] = hypot(slip[i][0], slip[i][1]);
            slip[i][0] /= speed[i], slip[i][1] /= speed[i];
        }
        share_weight((const double(*)[2])r, (const double(*)[2])slip, friction, 0.05, n);
        for (int i = 0; i < 3; ++i) {
            assert_true(n[i] > 0);
            force[0] -= friction * n[i] * slip[i][0], force[1] -= friction * n[i] * slip[i][1];
            torque -= friction * n[i] * (r[i][0] * slip[i][1] - r[i][1] * slip[i][0]);
            p.energy_lost += h * friction * n[i] * speed[i];
        }
        const plate old = p;
        p.vx += h * force[0], p.vy += h * force[1], p.spin += h * torque / (0.25 * 0.25);
        if (hypot(p.vx, p.vy) + fabs(p.spin) < 1e-3) {
            break;
        }
        p.x += h * (p.vx + old.vx) / 2, p.y += h * (p.vy + old.vy) / 2;
        p.turn += h * (p.spin + old.spin) / 2;
    }
    return p;
}

static void test_plate_motion_equals_small_time_steps(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"speed=2", "spin=6", NULL},
                                              {"speed=3", "spin=1", "friction=0.5", NULL},
                                              {"speed=2", "spin=6", "duration=0.3", NULL}};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("slide-and-spin", settings[i]);
        const plate p = slide(&scene, 1e-5);
        const double *v = scene.bodies[1].velocity, spin = scene.bodies[1].angular_velocity[2];
        const pl_expect_value *x = expected_value(&scene, 1, PL_QUANTITY_POSITION, 0);
        const bool stops = i < 2;
        assert_close(inertia_along(&scene.bodies[1], 2), 0.25 * 0.25, 0, 1e-12);
        assert_close(x->value, p.x, 2e-5, 0);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_POSITION, 1)->value, p.y, 2e-5, 0);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_TURN, 2)->value, p.turn, 1e-4, 0);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_VELOCITY, 0)->value, stops ? 0 : p.vx,
                     1e-4, 0);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_SPIN, 2)->value, stops ? 0 : p.spin,
                     1e-3, 0);
        /* All its energy went into friction, and it went farther than without spin. */
        const double energy = v[0] * v[0] / 2 + 0.0625 * spin * spin / 2;
        assert_true(!stops || fabs(p.energy_lost - energy) < 1e-4 * energy);
        assert_true(!stops || x->value > v[0] * v[0] / (2 * scene.materials[0].friction * g));
        pl_scene_free(&scene);
    }
}

static void test_plates_with_one_motion_equal_one_point(void **state)
{
    (void)state;
    /* Nearly no spin: mu m g brakes it. Nearly no way: mu m g R / I brakes the turn. */
    static const char *const slow_spin[] = {"speed=100", "spin=0.1", "friction=1", "duration=20",
                                            NULL};
    static const char *const slow_way[] = {"speed=0.1", "spin=200", "friction=1", "duration=20",
                                           NULL};
    pl_scene scene = scenario_scene("slide-and-spin", slow_spin);
    assert_close(expected_value(&scene, 1, PL_QUANTITY_POSITION, 0)->value, 1e4 / (2 * g), 0, 1e-6);
    pl_scene_free(&scene);
    scene = scenario_scene("slide-and-spin", slow_way);
    assert_close(expected_value(&scene, 1, PL_QUANTITY_TURN, 2)->value,
                 4e4 / (2 * g * 0.5 / 0.0625), 0, 1e-4);
    pl_scene_free(&scene);
}

/* A disk that rolls without slip, in vectors. y = (x, y of the centre, axis a, spin w), r the lowest
 * point from the centre, v = -w x r, and F = m (v' + g z):
 *   J w' + w x J w = r x F,  v' = -w' x r - w x r'. */
typedef struct disk {
    double radius, half, across, along; /* of 1 kg */
} disk;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* r and r', for the axis a and a'. */
static void lowest(const disk *d, const double a[3], const double rate[3], double r[3],
                   double of_r[3])
{
    double up[3], of_up[3];
    for (int k = 0; k < 3; ++k) {
        up[k] = (k == 2 ? 1 : 0) - a[2] * a[k];
        of_up[k] = -rate[2] * a[k] - a[2] * rate[k];
    }
    const double length = sqrt(dot(up, up)), growth = dot(up, of_up) / length;
    for (int k = 0; k < 3; ++k) {
        r[k] = -d->half * a[k] - d->radius * up[k] / length;
        of_r[k] = -d->half * rate[k] -
                  d->radius * (of_up[k] / length - up[k] * growth / (length * length));
    }
}

/* m w' = b for a symmetric m, by Cramer's rule. */
static void solve_3(double m[3][3], const double b[3], double x[3])
{
    double c[3][3], whole;
    for (int k = 0; k < 3; ++k) {
        cross(m[(k + 1) % 3], m[(k + 2) % 3], c[k]);
    }
    whole = dot(m[0], c[0]);
    for (int k = 0; k < 3; ++k) {
        x[k] = (b[0] * c[0][k] + b[1] * c[1][k] + b[2] * c[2][k]) / whole;
    }
}

static void disk_rate(const void *context, double t, const double *y, double *rate)
{
    (void)t;
    const disk *d = context;
    const double *a = y + 2, *w = y + 5;
    double r[3], of_r[3], v[3], momentum[3], whirl[3], carried[3], moment[3], m[3][3], b[3];
    cross(w, a, rate + 2);
    lowest(d, a, rate + 2, r, of_r);
    cross(r, w, v);
    const double about = dot(a, w), square = dot(r, r), weight[3] = {0, 0, g};
    for (int k = 0; k < 3; ++k) {
        momentum[k] = d->across * w[k] + (d->along - d->across) * about * a[k];
        for (int j = 0; j < 3; ++j) {
            m[k][j] = (k == j ? d->across + square : 0) + (d->along - d->across) * a[k] * a[j] -
                      r[k] * r[j];
        }
    }
    cross(w, momentum, whirl);
    cross(w, of_r, carried);
    for (int k = 0; k < 3; ++k) {
        carried[k] = weight[k] - carried[k];
    }
    cross(r, carried, moment);
    for (int k = 0; k < 3; ++k) {
        b[k] = moment[k] - whirl[k];
    }
    solve_3(m, b, rate + 5);
    rate[0] = v[0];
    rate[1] = v[1];
}

static double expected_of(const pl_scene *scene, pl_quantity quantity, int axis)
{
    return expected_value(scene, 1, quantity, axis)->value;
}

static void test_coin_equals_integrated_rolling(void **state)
{
    (void)state;
    static const char *const settings[][6] = {
        {NULL},
        {"tilt=1", "path=0.2", NULL},
        {"tilt=0.1", "thickness=0.01", "duration=2", NULL},
        {"tilt=0.7", "path=1", "friction=1", "radius=0.1", "thickness=0.5", NULL}};
    for (int i = 0; i < 4; ++i) {
        pl_scene scene = scenario_scene("spinning-coin", settings[i]);
        const pl_body *coin = &scene.bodies[1];
        const double *q = coin->orientation, *v = coin->velocity;
        const disk d = {coin->shape.radius, coin->shape.half_height, coin->inertia[0],
                        coin->inertia[2]};
        double y[8] = {coin->position[0], coin->position[1], 2 * q[0] * q[2], 0,
                       1 - 2 * q[2] * q[2]};
        const double tilt = acos(y[4]), end = scene.values[0].until;
        memcpy(y + 5, coin->angular_velocity, 3 * sizeof *y);
        double rate[8];
        disk_rate(&d, 0, y, rate);
        assert_close(v[0], rate[0], 1e-14, 0);
        assert_close(v[1], rate[1], 1e-14, 1e-14);
        assert_close(coin->position[2], d.radius * sin(tilt) + d.half * cos(tilt), 0, 1e-14);
        integrate(disk_rate, &d, 0, end, 20000, 8, y);
        assert_close(acos(y[4]), tilt, 1e-8, 0);
        assert_close(y[7], expected_of(&scene, PL_QUANTITY_SPIN, 2), 0, 1e-7);
        assert_close(y[7] * end, expected_of(&scene, PL_QUANTITY_TURN, 2), 0, 1e-7);
        for (int k = 0; k < 2; ++k) {
            assert_close(y[k] - coin->position[k], expected_of(&scene, PL_QUANTITY_POSITION, k),
                         1e-6, 0);
        }
        assert_close(expected_of(&scene, PL_QUANTITY_POSITION, 2), 0, 0, 0);
        pl_scene_free(&scene);
    }
}

/* Moffatt 2000, and the friction that holds the centre on its circle. */
static void test_thin_coin_turns_as_published(void **state)
{
    (void)state;
    static const char *const thin[] = {"tilt=0.1", "thickness=0.002", NULL};
    pl_scene scene = scenario_scene("spinning-coin", thin);
    const double *w = scene.bodies[1].angular_velocity, s = sin(0.1);
    assert_close(hypot(w[0], w[2]), sqrt(4 * g / (0.5 * s)) * s, 0, 0.03);
    pl_scene_free(&scene);
    static const char *const slippery[] = {"tilt=1", "path=0.2", "friction=0.2", NULL};
    assert_scenario_refuses("spinning-coin", slippery, "expected a friction of at least 0.3");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_top_precesses_by_its_equations_of_motion),
        cmocka_unit_test(test_plate_motion_equals_small_time_steps),
        cmocka_unit_test(test_plates_with_one_motion_equal_one_point),
        cmocka_unit_test(test_coin_equals_integrated_rolling),
        cmocka_unit_test(test_thin_coin_turns_as_published),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
