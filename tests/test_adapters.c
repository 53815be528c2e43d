/* Conformance of every adapter of this build, all profiles: that what an engine is given, does and
 * reports is what the harness believes it to be. Scores come after. Truths: momentum, Euler's
 * equations solved densely, Coulomb's and Newton's laws, and the exact sums of semi-implicit Euler.
 */
#include "adapters/registry.h"
#include "plumb/scenario.h"

#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CONTACTS = 256, MOST_BODIES = 8 };

static const double g = 9.81;

/* ------------------------------------------------------------------------------------ vectors */

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* Rows of the rotation matrix, body to world. Shuster 1993, eq. 97. */
static void matrix_of(const double q[4], double m[3][3])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    double rows[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
    };
    memcpy(m, rows, sizeof rows);
}

static void to_world(const double q[4], const double v[3], double out[3])
{
    double m[3][3];
    matrix_of(q, m);
    for (int i = 0; i < 3; i++) {
        out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    }
}

static void to_body(const double q[4], const double v[3], double out[3])
{
    double m[3][3];
    matrix_of(q, m);
    for (int i = 0; i < 3; i++) {
        out[i] = m[0][i] * v[0] + m[1][i] * v[1] + m[2][i] * v[2];
    }
}

/* World angular momentum about the centre of mass of a body with principal inertia I. */
static void spin_of(const double inertia[3], const double q[4], const double omega[3],
                    double out[3])
{
    double body[3];
    to_body(q, omega, body);
    for (int i = 0; i < 3; i++) {
        body[i] *= inertia[i];
    }
    to_world(q, body, out);
}

/* The angle of the rotation from one orientation to another, from the chord of the quaternions. */
static double angle_between(const double a[4], const double b[4])
{
    double dot = 0, chord = 0;
    for (int i = 0; i < 4; i++) {
        dot += a[i] * b[i];
    }
    for (int i = 0; i < 4; i++) {
        double d = a[i] - (dot < 0 ? -b[i] : b[i]);
        chord += d * d;
    }
    return 4 * asin(fmin(1, sqrt(chord) / 2));
}

/* -------------------------------------------------------------------------------------- scenes */

static int add_material(pl_scene *scene, const char *name, double friction, double restitution)
{
    pl_material item = {.friction = friction, .restitution = restitution};
    int index = -1;
    snprintf(item.name, sizeof item.name, "%s", name);
    assert_int_equal(pl_scene_add_material(scene, &item, &index, NULL), PL_OK);
    return index;
}

static int add_body(pl_scene *scene, pl_body body)
{
    int index = -1;
    snprintf(body.name, sizeof body.name, "body %d", scene->body_count);
    assert_int_equal(pl_scene_add_body(scene, &body, &index, NULL), PL_OK);
    return index;
}

static pl_body floor_body(void)
{
    pl_body body = pl_body_default();
    body.is_static = true;
    body.shape = pl_shape_plane(0, 0, 1, 0);
    return body;
}

static pl_body box_body(double mass, double x, double y, double z)
{
    pl_body body = pl_body_default();
    body.mass = mass;
    body.shape = pl_shape_box(x, y, z);
    return body;
}

/* A floor (body 0) and a box of half height `half` flat upon it (body 1), one material. */
static pl_scene scene_with_block(double friction, double mass, double half_width,
                                 double half_height)
{
    pl_scene scene = pl_scene_default();
    add_material(&scene, "stone", friction, 0);
    add_body(&scene, floor_body());
    pl_body block = box_body(mass, half_width, half_width, half_height);
    block.position[2] = half_height;
    add_body(&scene, block);
    return scene;
}

/* ---------------------------------------------------------------------------------------- runs */

typedef struct run {
    const pl_engine *engine;
    const pl_scene *scene;
    pl_engine_instance *instance;
    pl_body_state before[MOST_BODIES], now[MOST_BODIES];
    double time;
    pl_step_stats stats;
    pl_contact contacts[MOST_CONTACTS];
    int contact_count;
} run;

static void read_now(run *r)
{
    pl_frame frame = {.body_count = r->scene->body_count, .bodies = r->now};
    r->engine->read_frame(r->instance, &frame);
    assert_int_equal(frame.body_count, r->scene->body_count);
    r->time = frame.time;
}

static run start(const pl_engine_choice *choice, const pl_scene *scene)
{
    run r = {.engine = choice->engine, .scene = scene};
    pl_error error = {.message = ""};
    assert_true(scene->body_count <= MOST_BODIES);
    pl_status status =
        r.engine->create(scene, choice->profile, choice->values, &r.instance, &error);
    if (status != PL_OK) {
        print_error("%s: %s\n", choice->spec, error.message);
    }
    assert_int_equal(status, PL_OK);
    read_now(&r);
    return r;
}

static void step(run *r, double dt)
{
    pl_error error = {.message = ""};
    memcpy(r->before, r->now, sizeof r->now);
    r->stats = (pl_step_stats){.struct_size = sizeof r->stats,
                               .iterations = NAN,
                               .residual = NAN,
                               .contacts = NAN,
                               .islands = NAN,
                               .time_collide = NAN,
                               .time_solve = NAN,
                               .time_other = NAN};
    pl_status status = r->engine->step(r->instance, dt, &r->stats, &error);
    if (status != PL_OK) {
        print_error("%s\n", error.message);
    }
    assert_int_equal(status, PL_OK);
    read_now(r);
    r->contact_count = 0;
    if (r->engine->read_contacts != NULL) {
        r->contact_count = r->engine->read_contacts(r->instance, r->contacts, MOST_CONTACTS);
        assert_true(r->contact_count <= MOST_CONTACTS);
    }
}

static void finish(run *r)
{
    r->engine->destroy(r->instance);
}

/* Applies a law to every profile of every engine of this build; on failure the last line names the
 * engine. */
static void for_each_profile(void (*law)(const pl_engine_choice *choice))
{
    int count = 0, tried = 0;
    const pl_known_engine *known = pl_known_engines(&count);
    for (int i = 0; i < count; i++) {
        for (int p = 0; known[i].engine != NULL && p < known[i].engine->profile_count; p++) {
            pl_engine_choice choice;
            char spec[2 * PL_NAME_SIZE];
            snprintf(spec, sizeof spec, "%s:%s", known[i].name, known[i].engine->profiles[p].name);
            print_message("    %s\n", spec);
            assert_int_equal(pl_engine_choose(spec, &choice, NULL), PL_OK);
            law(&choice);
            tried++;
        }
    }
    assert_true(tried > 0);
}

/* Bullet's Lemke solver bounds a friction impulse by mu N s in place of mu times the normal impulse
 * (btLemkeSolver.h takes no notice of limitDependency), and a normal one by 1e10 N s, which costs
 * ten of sixteen digits. What it reports is what it applied; but it is not Coulomb's law. */
static bool solves_coulomb(const pl_engine_choice *choice)
{
    return strcmp(choice->spec, "bullet:lemke") != 0;
}

/* ------------------------------------------------------------------------------ a: free flight */

static pl_body tumbling_box(void)
{
    pl_body body = box_body(3, 0.2, 0.5, 0.9);
    pl_shape_inertia(&body.shape, body.mass, body.inertia);
    check_random random = {20};
    check_quaternion(&random, body.orientation);
    memcpy(body.position, (double[]){1, -2, 30}, sizeof body.position);
    memcpy(body.velocity, (double[]){0.3, -0.2, 0.5}, sizeof body.velocity);
    memcpy(body.angular_velocity, (double[]){1.1, 2.3, -1.7}, sizeof body.angular_velocity);
    return body;
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
    for (int i = 0; i < 3; i++) {
        rate[4 + i] = torque[i] / inertia[i];
    }
}

/* Classical Runge-Kutta of order 4 with steps of 0.1 ms: its error here is below 1e-12. */
static void dense_tumble(const pl_body *body, double duration, double q[4], double omega[3])
{
    static const double part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    int steps = (int)round(duration / 1e-4);
    double h = duration / steps, y[7];
    memcpy(y, body->orientation, sizeof body->orientation);
    to_body(body->orientation, body->angular_velocity, y + 4);
    for (int n = 0; n < steps; n++) {
        double rate[7] = {0}, sum[7] = {0}, at[7];
        for (int stage = 0; stage < 4; stage++) {
            for (int i = 0; i < 7; i++) {
                at[i] = y[i] + part[stage] * h * rate[i];
            }
            euler_rate(body->inertia, at, rate);
            for (int i = 0; i < 7; i++) {
                sum[i] += weight[stage] * rate[i];
            }
        }
        for (int i = 0; i < 7; i++) {
            y[i] += h / 6 * sum[i];
        }
    }
    memcpy(q, y, 4 * sizeof *q);
    to_world(q, y + 4, omega);
}

/* Errors after one second in orientation (rad) and world angular velocity (rad/s). */
static void tumble(const pl_engine_choice *choice, int steps, double *angle, double *rate)
{
    pl_scene scene = pl_scene_default();
    add_material(&scene, "stone", 0.5, 0);
    add_body(&scene, tumbling_box());
    const pl_body *body = &scene.bodies[0];
    memcpy(scene.gravity, (double[]){1, -2, -9}, sizeof scene.gravity);
    double h = 1.0 / steps, q[4], omega[3];
    run r = start(choice, &scene);
    for (int n = 0; n < steps; n++) {
        step(&r, h);
    }
    for (int i = 0; i < 3; i++) {
        double fall = scene.gravity[i] * h * h * steps * (steps + 1.0) / 2;
        assert_close(r.now[0].position[i], body->position[i] + body->velocity[i] + fall, 1e-11,
                     1e-12);
        assert_close(r.now[0].velocity[i], body->velocity[i] + scene.gravity[i], 1e-11, 1e-12);
    }
    assert_close(r.time, 1, 1e-12, 0);
    dense_tumble(body, 1, q, omega);
    *angle = angle_between(r.now[0].orientation, q);
    *rate = distance(r.now[0].angular_velocity, omega);
    finish(&r);
    pl_scene_free(&scene);
}

/* With a wrong convention the error would stay of order 1 however small the step. */
static void law_tumble(const pl_engine_choice *choice)
{
    double angle, rate, fine_angle, fine_rate;
    tumble(choice, 1000, &angle, &rate);
    tumble(choice, 4000, &fine_angle, &fine_rate);
    assert_at_most(angle, 0.02);
    assert_at_most(rate, 0.05);
    assert_at_most(fine_angle, fmax(0.3 * angle, 1e-7));
    assert_at_most(fine_rate, fmax(0.3 * rate, 1e-7));
}

static void test_free_tumbling_box_converges_to_euler_and_falls_by_the_discrete_sum(void **state)
{
    (void)state;
    for_each_profile(law_tumble);
}

/* --------------------------------------------------------------------------------- b: contacts */

/* Linear momentum: m dv = m g h + sum of reported impulses, over one step, for every moving body.
 */
static void check_momentum(const run *r, double dt)
{
    for (int b = 0; b < r->scene->body_count; b++) {
        const pl_body *body = &r->scene->bodies[b];
        if (body->is_static) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            double impulse = 0, scale = body->mass * g * dt;
            for (int i = 0; i < r->contact_count; i++) {
                const pl_contact *contact = &r->contacts[i];
                int sign = contact->body_b == b ? 1 : contact->body_a == b ? -1 : 0;
                impulse += sign * contact->impulse[k];
                scale = fmax(scale, fabs(contact->impulse[k]));
            }
            double change = body->mass * (r->now[b].velocity[k] - r->before[b].velocity[k] -
                                          r->scene->gravity[k] * dt);
            assert_close(change, impulse, 1e-10 * scale, 0);
        }
    }
}

static void check_normals(const run *r)
{
    for (int i = 0; i < r->contact_count; i++) {
        const pl_contact *contact = &r->contacts[i];
        const double *n = contact->normal, *p = contact->impulse;
        assert_close(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-12, 0);
        /* Contacts push: on B, along the normal. */
        assert_at_most(-(n[0] * p[0] + n[1] * p[1] + n[2] * p[2]), 1e-12);
    }
}

static bool touched(const run *r)
{
    for (int i = 0; i < r->contact_count; i++) {
        if (distance(r->contacts[i].impulse, (double[]){0, 0, 0}) > 0) {
            return true;
        }
    }
    return false;
}

static void lowest_corner(const pl_shape *shape, const pl_body_state *state, double lowest[3])
{
    lowest[2] = INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        double local[3], world[3];
        for (int k = 0; k < 3; k++) {
            local[k] = (corner >> k & 1 ? 1 : -1) * shape->half_extents[k];
        }
        to_world(state->orientation, local, world);
        for (int k = 0; k < 3; k++) {
            world[k] += state->position[k];
        }
        if (world[2] < lowest[2]) {
            memcpy(lowest, world, 3 * sizeof *lowest);
        }
    }
}

/* A tilted box, not spinning, drops on one corner. `floor_index` is 0 or 1: the order of the
 * bodies. The floor's top is at 0, whether it is a plane or a slab. */
static void corner_drop(const pl_engine_choice *choice, int floor_index, bool slab)
{
    pl_body ground = floor_body();
    if (slab) {
        /* As large as the box within a factor of two: ODE's space pairs such shapes in either
         * order. */
        ground.shape = pl_shape_box(0.45, 0.45, 0.45);
        ground.position[2] = -0.45;
    }
    int box_index = 1 - floor_index;
    double dt = 1.0 / 240;
    pl_scene scene = pl_scene_default();
    add_material(&scene, "stone", 0.4, 0);
    pl_body box = box_body(2, 0.5, 0.3, 0.2);
    check_random random = {5};
    check_quaternion(&random, box.orientation);
    memcpy(box.velocity, (double[]){0.7, -0.4, -1.5}, sizeof box.velocity);
    box.position[2] = 0.7;
    add_body(&scene, floor_index == 0 ? ground : box);
    add_body(&scene, floor_index == 0 ? box : ground);
    const pl_body *body = &scene.bodies[box_index];

    run r = start(choice, &scene);
    int steps = 0;
    do {
        step(&r, dt);
        check_momentum(&r, dt);
        assert_true(++steps < 240);
    } while (!touched(&r));

    double corner[3] = {0}, torque[3] = {0}, spin[3];
    lowest_corner(&body->shape, &r.before[box_index], corner);
    for (int i = 0; i < r.contact_count; i++) {
        const pl_contact *contact = &r.contacts[i];
        double up = contact->body_b == box_index ? 1 : -1;
        assert_int_equal(contact->body_a + contact->body_b, 1);
        assert_close(up * contact->normal[2], 1, 1e-12, 0);
        assert_true(up * contact->impulse[2] > 0);
        assert_at_most(distance(contact->point, corner), 0.02);
        assert_close(contact->separation, corner[2], 1e-9, 0);
        double arm[3], twist[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = contact->point[k] - r.before[box_index].position[k];
        }
        cross(arm, contact->impulse, twist);
        for (int k = 0; k < 3; k++) {
            torque[k] += up * twist[k];
        }
    }
    /* It did not spin before, so no gyroscopic torque takes part in this step. */
    spin_of(body->inertia, r.before[box_index].orientation, r.now[box_index].angular_velocity,
            spin);
    double size = distance(spin, (double[]){0, 0, 0});
    assert_true(size > 0.05);
    assert_at_most(distance(spin, torque), 0.05 * size);
    for (int n = 0; n < 120; n++) {
        step(&r, dt);
        check_momentum(&r, dt);
        if (solves_coulomb(choice)) {
            check_normals(&r);
        }
    }
    finish(&r);
    pl_scene_free(&scene);
}

static void law_corner_drop(const pl_engine_choice *choice)
{
    if (choice->engine->read_contacts != NULL) {
        for (int i = 0; i < 4; i++) {
            corner_drop(choice, i % 2, i / 2 == 1);
        }
    }
}

static void test_corner_impact_balances_momentum_and_torque_with_reported_contacts(void **state)
{
    (void)state;
    for_each_profile(law_corner_drop);
}

/* Two bodies meet off centre without gravity: what one gains the other loses. */
static void law_pair_impact(const pl_engine_choice *choice)
{
    pl_shape shapes[] = {pl_shape_sphere(0.4), pl_shape_box(0.5, 0.3, 0.4)};
    for (int k = 0; choice->engine->read_contacts != NULL && k < 4; k++) {
        double dt = 1.0 / 120;
        pl_scene scene = pl_scene_default();
        memset(scene.gravity, 0, sizeof scene.gravity);
        add_material(&scene, "stone", 0.3, 0);
        check_random random = {(uint64_t)k + 3};
        for (int i = 0; i < 2; i++) {
            pl_body body = pl_body_default();
            body.shape = shapes[i == 0 ? k / 2 : k % 2];
            body.mass = 1 + 2 * i;
            check_quaternion(&random, body.orientation);
            memcpy(body.position, (double[]){1.5 * i, 0.1 * i, 0.2 * i}, sizeof body.position);
            body.velocity[0] = i == 0 ? 2 : -1;
            add_body(&scene, body);
        }
        run r = start(choice, &scene);
        bool met = false;
        for (int n = 0; n < 120; n++) {
            step(&r, dt);
            check_momentum(&r, dt);
            check_normals(&r);
            for (int i = 0; touched(&r) && i < r.contact_count; i++) {
                const pl_contact *contact = &r.contacts[i];
                double along = 0;
                for (int x = 0; x < 3; x++) {
                    along += contact->normal[x] * (r.before[contact->body_b].position[x] -
                                                   r.before[contact->body_a].position[x]);
                }
                assert_true(along > 0);
                met = true;
            }
        }
        assert_true(met);
        assert_true(r.now[0].velocity[0] < 1.5 && r.now[1].velocity[0] > -0.9);
        finish(&r);
        pl_scene_free(&scene);
    }
}

static void test_pair_impact_reports_equal_and_opposite_impulses(void **state)
{
    (void)state;
    for_each_profile(law_pair_impact);
}

/* ------------------------------------------------------------------------------------- c: rest */

static void law_rest(const pl_engine_choice *choice)
{
    if (!solves_coulomb(choice)) {
        return;
    }
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    run r = start(choice, &scene);
    for (int n = 0; n < 120; n++) {
        step(&r, 1.0 / 60);
    }
    double sum[3] = {0}, weight = g / 60;
    for (int i = 0; i < r.contact_count; i++) {
        for (int k = 0; k < 3; k++) {
            sum[k] += r.contacts[i].impulse[k];
        }
    }
    if (choice->engine->read_contacts != NULL) {
        print_message("      weight off by %.1e, sideways %.1e\n", sum[2] / weight - 1,
                      hypot(sum[0], sum[1]) / weight);
        assert_close(sum[2], weight, 0, 1e-3);
        assert_close(hypot(sum[0], sum[1]), 0, 1e-3 * weight, 0);
    }
    assert_close(r.now[1].position[2], 0.5, 2e-3, 0);
    finish(&r);
    pl_scene_free(&scene);
}

static void test_contact_impulses_of_a_resting_box_carry_its_weight(void **state)
{
    (void)state;
    for_each_profile(law_rest);
}

/* --------------------------------------------------------------------------------- d: settings */

static pl_scene scene_of_pairs(void)
{
    pl_scene scene = pl_scene_default();
    add_material(&scene, "ice", 0.2, 0.1);
    add_material(&scene, "rubber", 0.8, 0.9);
    /* Not the product 0.16, the minimum, the maximum, either mean, nor a coefficient itself. */
    pl_material_pair pair = {
        .material_a = 1, .material_b = 0, .friction = 0.35, .restitution = 0.6};
    assert_int_equal(pl_scene_add_pair(&scene, &pair, NULL), PL_OK);
    add_body(&scene, floor_body());
    return scene;
}

static void law_settings(const pl_engine_choice *choice)
{
    pl_scene scene = scene_of_pairs();
    memcpy(scene.gravity, (double[]){0.5, -1.5, -8.25}, sizeof scene.gravity);
    pl_body box = box_body(3.7, 0.2, 0.5, 0.9), ball = pl_body_default();
    box.material = 1;
    box.position[2] = 5;
    memcpy(box.inertia, (double[]){0.31, 0.22, 0.43}, sizeof box.inertia);
    ball.shape = pl_shape_sphere(0.3);
    ball.mass = 1e-3;
    ball.material = 1;
    ball.position[2] = 9;
    add_body(&scene, box);
    add_body(&scene, ball);
    run r = start(choice, &scene);
    double mass[MOST_BODIES], inertia[MOST_BODIES][3], friction, restitution;
    pl_engine_settings settings = {.mass = mass, .inertia = inertia, .body_count = 3};
    r.engine->read_settings(r.instance, 1.0 / 77, &settings);
    assert_int_equal(settings.body_count, 3);
    assert_close(settings.dt, 1.0 / 77, 0, 0);
    for (int b = 0; b < 3; b++) {
        const pl_body *body = &scene.bodies[b];
        assert_close(mass[b], body->is_static ? 0 : body->mass, 0, 1e-15);
        for (int k = 0; k < 3; k++) {
            assert_close(inertia[b][k], body->is_static ? 0 : body->inertia[k], 0, 1e-15);
            assert_close(settings.gravity[k], scene.gravity[k], 0, 0);
        }
    }
    for (int order = 0; order < 2; order++) {
        r.engine->read_pair(r.instance, order, 1 - order, &friction, &restitution);
        assert_close(friction, 0.35, 0, 0);
        assert_close(restitution, 0.6, 0, 0);
    }
    r.engine->read_pair(r.instance, 1, 2, &friction, &restitution);
    assert_close(friction, 0.8, 1e-15, 0);
    assert_close(restitution, 0.9, 1e-15, 0);
    finish(&r);
    pl_scene_free(&scene);
}

static void test_settings_read_back_equal_the_scene(void **state)
{
    (void)state;
    for_each_profile(law_settings);
}

/* v = v0 - mu g t, for a flat block that slides along x on a slab. The slab is a box, because
 * Bullet as it ships makes one point a step against a plane, and a block that hops on it shows no
 * clean friction. */
static void law_slide(const pl_engine_choice *choice)
{
    if (!solves_coulomb(choice)) {
        return;
    }
    pl_scene scene = scene_of_pairs();
    scene.bodies[0].shape = pl_shape_box(20, 20, 0.5);
    scene.bodies[0].position[2] = -0.5;
    pl_body block = box_body(2, 0.5, 0.5, 0.1);
    block.material = 1;
    block.position[2] = 0.1;
    add_body(&scene, block);
    scene.bodies[1].velocity[0] = 4;
    run r = start(choice, &scene);
    double dt = 1.0 / 240;
    for (int n = 0; n < 24; n++) {
        step(&r, dt);
    }
    double from = r.now[1].velocity[0];
    for (int n = 0; n < 120; n++) {
        step(&r, dt);
    }
    double friction = (from - r.now[1].velocity[0]) / (g * 0.5);
    print_message("      friction %.6f, asked 0.35\n", friction);
    assert_close(friction, 0.35, 0, 0.01);
    assert_close(r.now[1].velocity[1], 0, 0.01, 0);
    finish(&r);
    pl_scene_free(&scene);
}

static void test_sliding_block_slows_by_the_pairs_friction(void **state)
{
    (void)state;
    for_each_profile(law_slide);
}

/* The ball starts at the floor: Bullet's contacts hold a ball back that would touch only within the
 * step, and so swallow part of a bounce at small steps. */
static void law_bounce(const pl_engine_choice *choice)
{
    if (!solves_coulomb(choice)) {
        return;
    }
    pl_scene scene = scene_of_pairs();
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(0.5);
    ball.material = 1;
    ball.position[2] = 0.5;
    ball.velocity[2] = -4;
    add_body(&scene, ball);
    run r = start(choice, &scene);
    double dt = 1.0 / 1000;
    for (int n = 0; n < 5; n++) {
        step(&r, dt);
    }
    /* The impact takes one of these steps; engines count its gravity before the impact or after. */
    assert_close(r.now[1].velocity[2], 0.6 * 4 - 4.5 * g * dt, 0.9 * g * dt, 0);
    finish(&r);
    pl_scene_free(&scene);
}

static void test_ball_bounces_with_the_pairs_restitution(void **state)
{
    (void)state;
    for_each_profile(law_bounce);
}

/* ----------------------------------------------------------------------------- e: order, forces */

static void law_order(const pl_engine_choice *choice)
{
    pl_scene scene = pl_scene_default();
    add_material(&scene, "stone", 0.5, 0);
    check_random random = {9};
    for (int i = 0; i < MOST_BODIES; i++) {
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
        add_body(&scene, body);
    }
    run r = start(choice, &scene);
    assert_close(r.time, 0, 0, 0);
    pl_body_state first[MOST_BODIES];
    memcpy(first, r.now, sizeof first);
    for (int i = 0; i < MOST_BODIES; i++) {
        const pl_body *body = &scene.bodies[i];
        assert_close(distance(first[i].position, body->position), 0, 1e-14, 0);
        assert_close(distance(first[i].velocity, body->velocity), 0, 1e-14, 0);
        assert_close(distance(first[i].angular_velocity, body->angular_velocity), 0, 1e-14, 0);
        assert_close(angle_between(first[i].orientation, body->orientation), 0, 1e-14, 0);
    }
    for (int n = 0; n < 20; n++) {
        step(&r, 1.0 / 100);
    }
    for (int i = 0; i < MOST_BODIES; i++) {
        bool moved = memcmp(&first[i], &r.now[i], sizeof first[i]) != 0;
        assert_int_equal(moved, !scene.bodies[i].is_static);
    }
    finish(&r);
    pl_scene_free(&scene);
}

static void test_bodies_keep_the_scenes_order_and_static_ones_their_place(void **state)
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
    add_material(&scene, "stone", 0.5, 0);
    check_random random = {31};
    /* Ten times 0.1 sums to less than 1: the eleventh step must count as starting at 1 all the
     * same. */
    double dt = 0.1, acting = 1, along[3];
    pl_force forces[3] = {
        {.force = {0, 2, 0}, .at = {0.5, 0, 0}, .frame = PL_FRAME_WORLD},
        {.force = {1, 2, -3}, .frame = PL_FRAME_BODY},
        {.force = {0, 2, 0}, .at = {0.5, 0, 0}, .frame = PL_FRAME_BODY},
    };
    for (int i = 0; i < 3; i++) {
        pl_body body = box_body(4, 0.2, 0.3, 0.4);
        body.position[0] = 10 * i;
        if (i == 1) {
            check_quaternion(&random, body.orientation);
        }
        forces[i].body = add_body(&scene, body);
        forces[i].from = 1;
        forces[i].until = 2;
        assert_int_equal(pl_scene_add_force(&scene, &forces[i], NULL), PL_OK);
    }
    run r = start(choice, &scene);
    for (int n = 1; n <= 30; n++) {
        step(&r, dt);
        double share = fmin(fmax(n - 10, 0), 10) / 10.0;
        assert_close(r.now[0].velocity[1], share * acting * 2 / 4, 1e-13, 0);
    }
    double about_z = scene.bodies[0].inertia[2];
    to_world(scene.bodies[1].orientation, forces[1].force, along);
    for (int k = 0; k < 3; k++) {
        assert_close(r.now[0].angular_velocity[k], k == 2 ? acting / about_z : 0, 1e-12, 0);
        assert_close(r.now[1].velocity[k], acting * along[k] / 4, 1e-12, 0);
        assert_close(r.now[1].angular_velocity[k], 0, 1e-12, 0);
        assert_close(r.now[2].angular_velocity[k], k == 2 ? acting / about_z : 0, 1e-12, 0);
    }
    /* The third turned by then, and its force with it. */
    assert_true(r.now[2].velocity[0] < -1e-3);
    finish(&r);
    pl_scene_free(&scene);
}

static void test_forces_accelerate_by_newton_and_euler_over_their_own_steps(void **state)
{
    (void)state;
    for_each_profile(law_forces);
}

/* ------------------------------------------------------------------------------------ f: sleep */

/* A sleeping body would stay at rest. How exactly it slides is another law's matter. */
static void law_no_sleep(const pl_engine_choice *choice)
{
    if (!solves_coulomb(choice)) {
        return;
    }
    pl_scene scene = scene_with_block(0.2, 1, 0.5, 0.1);
    pl_force push = {.force = {6, 0, 0}, .body = 1, .from = 10, .until = INFINITY};
    assert_int_equal(pl_scene_add_force(&scene, &push, NULL), PL_OK);
    run r = start(choice, &scene);
    for (int n = 0; n < 600; n++) {
        step(&r, 1.0 / 60);
    }
    assert_close(r.now[1].velocity[0], 0, 1e-3, 0);
    for (int n = 0; n < 30; n++) {
        step(&r, 1.0 / 60);
    }
    assert_close(r.now[1].velocity[0], 0.5 * (6 - 0.2 * g), 0, 0.1);
    finish(&r);
    pl_scene_free(&scene);
}

static void test_body_at_rest_for_ten_seconds_still_answers_a_push(void **state)
{
    (void)state;
    for_each_profile(law_no_sleep);
}

/* ------------------------------------------------------------------------- what engines report */

static void law_descriptor(const pl_engine_choice *choice)
{
    const pl_engine *engine = choice->engine;
    assert_int_equal(engine->struct_size, sizeof *engine);
    assert_int_equal(engine->abi_version, PL_ENGINE_ABI_VERSION);
    assert_true(engine->profiles[0].in_default_comparison);
    uint32_t shapes = PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX;
    assert_int_equal(engine->capabilities & shapes, shapes);
    for (int i = 0; i < engine->option_count; i++) {
        assert_true(choice->values[i] >= engine->options[i].min);
        assert_true(choice->values[i] <= engine->options[i].max);
        if (engine->options[i].integer) {
            assert_close(choice->values[i], round(choice->values[i]), 0, 0);
        }
    }
    engine->destroy(NULL);
}

static void test_descriptors_are_whole_and_defaults_in_range(void **state)
{
    (void)state;
    for_each_profile(law_descriptor);
}

static bool is_built_in(const char *name)
{
    int count = 0;
    const pl_known_engine *known = pl_known_engines(&count);
    for (int i = 0; i < count; i++) {
        if (strcmp(known[i].name, name) == 0) {
            return known[i].engine != NULL;
        }
    }
    return false;
}

/* The table of options, which `list engines` shows, states the values that the library itself
 * ships. */
static void test_option_tables_of_reference_engines_state_what_their_libraries_ship(void **state)
{
    (void)state;
    static const char *const specs[] = {"ode:quick", "ode:dantzig", "bullet:si", "bullet:nncg"};
    for (size_t s = 0; s < sizeof specs / sizeof *specs; s++) {
        pl_engine_choice choice;
        if (pl_engine_choose(specs[s], &choice, NULL) == PL_UNSUPPORTED) {
            continue;
        }
        for (int i = 0; i < choice.engine->option_count; i++) {
            print_message("    %s %s\n", specs[s], choice.engine->options[i].name);
            /* Bullet writes some of its doubles as floats. */
            assert_close(choice.values[i], choice.engine->options[i].value, 0, 1e-7);
        }
    }
}

/* Iterations and residual of five stacked cubes in the first step. */
static pl_step_stats stack_stats(const char *spec)
{
    pl_scene scene = pl_scene_default();
    add_material(&scene, "stone", 0.5, 0);
    add_body(&scene, floor_body());
    for (int i = 0; i < 5; i++) {
        pl_body cube = box_body(1, 0.5, 0.5, 0.5);
        cube.position[2] = 0.5 + i;
        add_body(&scene, cube);
    }
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose(spec, &choice, NULL), PL_OK);
    run r = start(&choice, &scene);
    step(&r, 1.0 / 60);
    pl_step_stats stats = r.stats;
    assert_int_equal(r.contact_count, (int)stats.contacts);
    finish(&r);
    pl_scene_free(&scene);
    return stats;
}

static void test_reported_iterations_are_those_asked_and_none_where_there_are_none(void **state)
{
    (void)state;
    if (is_built_in("ode")) {
        assert_close(stack_stats("ode").iterations, 20, 0, 0);
        assert_close(stack_stats("ode:quick,iterations=7").iterations, 7, 0, 0);
        assert_true(isnan(stack_stats("ode:dantzig").iterations));
        assert_true(isnan(stack_stats("ode").residual));
    }
    if (is_built_in("bullet")) {
        assert_close(stack_stats("bullet").iterations, 10, 0, 0);
        assert_close(stack_stats("bullet:nncg,iterations=7").iterations, 7, 0, 0);
        assert_true(stack_stats("bullet").residual >
                    stack_stats("bullet:si,iterations=99").residual);
        assert_true(isnan(stack_stats("bullet:dantzig").iterations));
        assert_true(isnan(stack_stats("bullet:lemke").residual));
    }
}

/* Small boxes side by side, not touching, on a floor or on one large slab that joins them all. */
static pl_status step_many(const char *spec, bool slab, pl_error *error)
{
    pl_scene scene = pl_scene_default();
    add_material(&scene, "stone", 0.5, 0);
    add_body(&scene, floor_body());
    if (slab) {
        pl_body body = box_body(1000, 20, 20, 0.25);
        body.position[2] = 0.25;
        add_body(&scene, body);
    }
    for (int i = 0; i < 40 * 40; i++) {
        pl_body box = box_body(1, 0.3, 0.3, 0.3);
        box.position[0] = i % 40 - 19.5;
        box.position[1] = i / 40 - 19.5;
        box.position[2] = 0.299 + (slab ? 0.5 : 0);
        add_body(&scene, box);
    }
    pl_engine_choice choice;
    pl_engine_instance *instance = NULL;
    assert_int_equal(pl_engine_choose(spec, &choice, NULL), PL_OK);
    assert_int_equal(choice.engine->create(&scene, choice.profile, choice.values, &instance, error),
                     PL_OK);
    pl_step_stats stats = {.struct_size = sizeof stats};
    pl_status status = choice.engine->step(instance, 1.0 / 60, &stats, error);
    choice.engine->destroy(instance);
    pl_scene_free(&scene);
    return status;
}

static void
test_dense_solvers_decline_one_island_beyond_their_memory_but_not_many_small(void **state)
{
    (void)state;
    static const char *const specs[] = {"ode:dantzig", "bullet:dantzig", "bullet:lemke"};
    for (size_t s = 0; s < sizeof specs / sizeof *specs; s++) {
        pl_engine_choice choice;
        pl_error error = {.message = ""};
        if (pl_engine_choose(specs[s], &choice, NULL) == PL_UNSUPPORTED) {
            continue;
        }
        assert_int_equal(step_many(specs[s], true, &error), PL_UNSUPPORTED);
        print_message("    %s\n", error.message);
        assert_contains(error.message, specs[s]);
        assert_contains(error.message, "GiB");
        assert_contains(error.message, "rows");
        if (strcmp(specs[s], "ode:dantzig") == 0) {
            assert_int_equal(step_many(specs[s], false, &error), PL_OK);
        }
    }
}

static void test_iterations_that_dantzig_cannot_have_are_declined(void **state)
{
    (void)state;
    pl_engine_choice choice;
    pl_error error = {.message = ""};
    if (pl_engine_choose("ode:dantzig,iterations=50", &choice, NULL) == PL_UNSUPPORTED) {
        skip();
    }
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    pl_engine_instance *instance = NULL;
    assert_int_equal(
        choice.engine->create(&scene, choice.profile, choice.values, &instance, &error),
        PL_UNSUPPORTED);
    assert_null(instance);
    assert_contains(error.message, "iterations");
    pl_scene_free(&scene);
}

/* The same scene twice gives the same bits, though instances share the process. */
static void law_repeats(const pl_engine_choice *choice)
{
    pl_body_state last[2][MOST_BODIES];
    memset(last, 0, sizeof last);
    for (int turn = 0; turn < 2; turn++) {
        pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
        for (int i = 0; i < 3; i++) {
            pl_body cube = box_body(1, 0.5, 0.5, 0.5);
            cube.position[0] = 0.1 * i;
            cube.position[2] = 1.5 + i;
            add_body(&scene, cube);
        }
        run r = start(choice, &scene);
        for (int n = 0; n < 60; n++) {
            step(&r, 1.0 / 60);
        }
        memcpy(last[turn], r.now, (size_t)scene.body_count * sizeof *r.now);
        finish(&r);
        pl_scene_free(&scene);
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
        cmocka_unit_test(test_descriptors_are_whole_and_defaults_in_range),
        cmocka_unit_test(test_free_tumbling_box_converges_to_euler_and_falls_by_the_discrete_sum),
        cmocka_unit_test(test_corner_impact_balances_momentum_and_torque_with_reported_contacts),
        cmocka_unit_test(test_pair_impact_reports_equal_and_opposite_impulses),
        cmocka_unit_test(test_contact_impulses_of_a_resting_box_carry_its_weight),
        cmocka_unit_test(test_settings_read_back_equal_the_scene),
        cmocka_unit_test(test_sliding_block_slows_by_the_pairs_friction),
        cmocka_unit_test(test_ball_bounces_with_the_pairs_restitution),
        cmocka_unit_test(test_bodies_keep_the_scenes_order_and_static_ones_their_place),
        cmocka_unit_test(test_forces_accelerate_by_newton_and_euler_over_their_own_steps),
        cmocka_unit_test(test_body_at_rest_for_ten_seconds_still_answers_a_push),
        cmocka_unit_test(test_option_tables_of_reference_engines_state_what_their_libraries_ship),
        cmocka_unit_test(test_reported_iterations_are_those_asked_and_none_where_there_are_none),
        cmocka_unit_test(
            test_dense_solvers_decline_one_island_beyond_their_memory_but_not_many_small),
        cmocka_unit_test(test_iterations_that_dantzig_cannot_have_are_declined),
        cmocka_unit_test(test_the_same_scene_twice_gives_the_same_bits),
    };
    return cmocka_run_group_tests_name("adapters", tests, NULL, NULL);
}
