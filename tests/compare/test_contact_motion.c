/* The velocities that contacts leave at their own time, against Euler's equations integrated here
 * in fine steps. */
#include "referee/metrics/modules.h"

#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <string.h>

enum { FLOOR, BOX, FINE = 20000 };

/* A body as Euler's equations move it: world velocity, and angular velocity in its own axes. */
typedef struct flight {
    double v[3], w[3], q[4];
} flight;

static void to_axes(const double q[4], const double x[3], bool to_world, double out[3])
{
    pl_axes axes = pl_axes_of(q);
    pl_vec v = pl_vec_of(x);
    pl_vec_store(to_world ? pl_to_world(&axes, v) : pl_to_local(&axes, v), out);
}

/* Moves freely for `time`, by the midpoint method in FINE steps a second of the step. */
static void fly(const pl_scene *scene, double time, flight *f)
{
    const double *inertia = scene->bodies[BOX].inertia;
    const int steps = (int)ceil(FINE * time / scene->dt);
    const double h = time / steps;
    for (int n = 0; n < steps; ++n) {
        double half[3], q[4], change[3];
        for (int pass = 0; pass < 2; ++pass) {
            const double *w = pass == 0 ? f->w : half;
            for (int k = 0; k < 3; ++k) {
                const int i = (k + 1) % 3, j = (k + 2) % 3;
                change[k] = (inertia[i] - inertia[j]) / inertia[k] * w[i] * w[j];
            }
            for (int k = 0; k < 3; ++k) {
                half[k] = f->w[k] + 0.5 * h * change[k];
            }
        }
        /* q' = q (0, w) / 2, with the angular velocity of the middle. */
        const double *p = f->q, x = 0.5 * h * half[0], y = 0.5 * h * half[1], z = 0.5 * h * half[2];
        q[0] = p[0] - p[1] * x - p[2] * y - p[3] * z;
        q[1] = p[1] + p[0] * x + p[2] * z - p[3] * y;
        q[2] = p[2] + p[0] * y + p[3] * x - p[1] * z;
        q[3] = p[3] + p[0] * z + p[1] * y - p[2] * x;
        const double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (int k = 0; k < 4; ++k) {
            f->q[k] = q[k] / size;
        }
        for (int k = 0; k < 3; ++k) {
            f->w[k] += h * change[k];
            f->v[k] += h * scene->gravity[k];
        }
    }
}

/* An impulse at a world arm. */
static void strike(const pl_scene *scene, const double arm[3], const double impulse[3], flight *f)
{
    const pl_body *body = &scene->bodies[BOX];
    double local[3], moment[3];
    pl_vec_store(pl_vec_cross(pl_vec_of(arm), pl_vec_of(impulse)), moment);
    to_axes(f->q, moment, false, local);
    for (int k = 0; k < 3; ++k) {
        f->v[k] += impulse[k] / body->mass;
        f->w[k] += local[k] / body->inertia[k];
    }
}

static pl_vec point_velocity(const flight *f, const double arm[3])
{
    double w[3];
    to_axes(f->q, f->w, true, w);
    return pl_vec_add(pl_vec_of(f->v), pl_vec_cross(pl_vec_of(w), pl_vec_of(arm)));
}

static pl_body_state state_of(const flight *f)
{
    pl_body_state s = {.position = {0, 0, 0}};
    memcpy(s.velocity, f->v, sizeof s.velocity);
    memcpy(s.orientation, f->q, sizeof s.orientation);
    to_axes(f->q, f->w, true, s.angular_velocity);
    return s;
}

static double uniform_in(check_random *random, double most)
{
    return check_uniform(random, -most, most);
}

/* Three impacts on a tumbling box: the velocity right after each is that of Euler's equations. */
static void test_velocities_after_impacts_follow_from_impulses(void **state)
{
    (void)state;
    check_random random = {3};
    for (int trial = 0; trial < 20; ++trial) {
        run r;
        run_prepare_box_on_floor(&r, 1);
        pl_body *body = &r.scene.bodies[BOX];
        const double inertia[3] = {0.2, 0.35, 0.45};
        memcpy(body->inertia, inertia, sizeof inertia);
        const double dt = r.scene.dt;
        flight f;
        check_quaternion(&random, f.q);
        for (int k = 0; k < 3; ++k) {
            f.v[k] = uniform_in(&random, 3);
            f.w[k] = uniform_in(&random, 8);
        }
        pl_body_state before[2] = {{.orientation = {1, 0, 0, 0}}, state_of(&f)};
        pl_contact contacts[3] = {{0}};
        pl_contact_time times[3] = {{0}};
        pl_vec truth[3];
        for (int i = 0; i < 3; ++i) {
            fly(&r.scene, 0.3 * dt, &f);
            times[i].begin = times[i].end = 0.3 * (i + 1) * dt;
            times[i].order = i + 1;
            contacts[i].body_a = FLOOR;
            contacts[i].body_b = BOX;
            times[i].acts.normal[2] = 1;
            for (int k = 0; k < 3; ++k) {
                times[i].acts.arm_b[k] = uniform_in(&random, 0.5);
                contacts[i].impulse[k] = uniform_in(&random, 2);
            }
            times[i].holds = times[i].acts;
            strike(&r.scene, times[i].acts.arm_b, contacts[i].impulse, &f);
            truth[i] = point_velocity(&f, times[i].acts.arm_b);
        }
        fly(&r.scene, 0.1 * dt, &f);
        pl_body_state after[2] = {before[FLOOR], state_of(&f)};
        pl_arena arena = {0};
        pl_contact_motion *motion = pl_contact_motion_create(&r.scene, &arena);
        assert_non_null(motion);
        const pl_step step = {.number = 1,
                              .before = before,
                              .after = after,
                              .contacts = contacts,
                              .times = times,
                              .contact_count = 3};
        pl_contact_motion_step(motion, &step);
        for (int i = 0; i < 3; ++i) {
            const pl_vec left = pl_contact_motion_velocity(motion, &step, i).left;
            assert_at_most(pl_vec_length(pl_vec_sub(left, truth[i])), 2e-5);
        }
        pl_arena_free(&arena);
        pl_scene_free(&r.scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_velocities_after_impacts_follow_from_impulses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
