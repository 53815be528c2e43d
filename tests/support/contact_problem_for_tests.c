#include "contact_problem_for_tests.h"

#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

pe_contact_problem *make_problem(int bodies, int manifolds, int points)
{
    pe_contact_problem *problem = NULL;
    pe_error error;
    if (pe_contact_problem_create(bodies, manifolds, points, NULL, &problem, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    return problem;
}

static void put_cube(pe_problem_body *body, double mass)
{
    double inertia = mass / 6;
    *body = (pe_problem_body){.mass = mass, .inertia = {inertia, 0, 0, inertia, 0, inertia}};
    body->free_velocity[2] = -STEP * GRAVITY;
}

/* A face of side 1 between a (below) and b (above); points `first` .. `first` + 3. */
static void put_face(pe_contact_problem *problem, int index, int a, int b, double friction)
{
    pe_problem_manifold *m = &problem->manifolds[index];
    *m = (pe_problem_manifold){.a = a,
                               .b = b,
                               .first = 4 * index,
                               .count = 4,
                               .friction = friction,
                               .frame = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                               .arm_a = {0, 0, a == PE_STATIC ? 0 : 0.5},
                               .arm_b = {0, 0, -0.5}};
    for (int k = 0; k < 4; ++k) {
        pe_problem_manifold_point *point = &problem->points[m->first + k];
        point->offset[1] = k < 2 ? -0.5 : 0.5;
        point->offset[2] = k % 2 == 0 ? -0.5 : 0.5;
    }
}

pe_contact_problem *problem_of_tower(const double *masses, int count, double friction)
{
    pe_contact_problem *problem = make_problem(count, count, 4 * count);
    for (int i = 0; i < count; ++i) {
        put_cube(&problem->bodies[i], masses[i]);
        put_face(problem, i, i - 1, i, friction);
    }
    return problem;
}

pe_contact_problem *problem_of_box_on_floor(double mass, double friction)
{
    return problem_of_tower(&mass, 1, friction);
}

/* Rows of the rotation of a unit quaternion. */
static void frame_of(const double q[4], double frame[3][3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(frame, rows, sizeof rows);
}

static void draw(check_random *random, double *values, int count, double size)
{
    for (int k = 0; k < count; ++k) {
        values[k] = check_uniform(random, -size, size);
    }
}

static void draw_body(check_random *random, pe_problem_body *body)
{
    /* R diag(d) R^T, with d within a factor of two. */
    double q[4], r[3][3], d[3], m[3][3] = {{0}};
    check_quaternion(random, q);
    frame_of(q, r);
    body->mass = check_uniform(random, 0.5, 5);
    for (int k = 0; k < 3; ++k) {
        d[k] = body->mass * check_uniform(random, 0.1, 0.2);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                m[i][j] += d[k] * r[k][i] * r[k][j];
            }
        }
    }
    const double inertia[6] = {m[0][0], m[0][1], m[0][2], m[1][1], m[1][2], m[2][2]};
    memcpy(body->inertia, inertia, sizeof inertia);
    draw(random, body->free_velocity, 6, 2);
}

/* Fills a manifold except for its frame and pair. Returns the first point index of the next one. */
static int draw_manifold(check_random *random, pe_contact_problem *problem, pe_problem_manifold *m,
                         int first, int most_points)
{
    m->first = first;
    m->count = 1 + (int)check_uniform(random, 0, most_points - 0.001);
    m->friction = check_uniform(random, 0, 1);
    if (m->a != PE_STATIC) {
        draw(random, m->arm_a, 3, 1);
    }
    draw(random, m->arm_b, 3, 1);
    for (int j = first; j < first + m->count; ++j) {
        draw(random, problem->points[j].offset, 3, 0.5);
        draw(random, problem->points[j].impulse, 3, 0.1);
        problem->points[j].bias = check_uniform(random, -0.5, 0.5);
    }
    return first + m->count;
}

static void draw_frame(check_random *random, pe_problem_manifold *m)
{
    double q[4];
    check_quaternion(random, q);
    frame_of(q, m->frame);
}

pe_contact_problem *problem_at_random(uint64_t seed, int bodies, int manifolds)
{
    check_random random = {seed};
    pe_contact_problem *problem = make_problem(bodies, manifolds, 4 * manifolds);
    int points = 0;
    for (int i = 0; i < bodies; ++i) {
        draw_body(&random, &problem->bodies[i]);
    }
    for (int i = 0; i < manifolds; ++i) {
        pe_problem_manifold *m = &problem->manifolds[i];
        draw_frame(&random, m);
        m->a = (int)check_uniform(&random, -1, bodies - 1e-9 * bodies);
        m->a = check_uniform(&random, 0, 1) < 0.3 ? PE_STATIC : m->a;
        do {
            m->b = (int)check_uniform(&random, 0, bodies - 1e-9 * bodies);
        } while (m->b == m->a);
        points = draw_manifold(&random, problem, m, points, 4);
    }
    problem->point_count = points;
    return problem;
}

pe_contact_problem *problem_of_pairs(uint64_t seed, int bodies, const int (*pairs)[2], int count)
{
    check_random random = {seed};
    pe_contact_problem *problem = make_problem(bodies, count, 8 * count);
    int points = 0;
    for (int i = 0; i < bodies; ++i) {
        draw_body(&random, &problem->bodies[i]);
    }
    for (int i = 0; i < count; ++i) {
        pe_problem_manifold *m = &problem->manifolds[i];
        draw_frame(&random, m);
        m->a = pairs[i][0];
        m->b = pairs[i][1];
        points = draw_manifold(&random, problem, m, points, 8);
    }
    problem->point_count = points;
    return problem;
}

/* ---- Independent formulas ---- */

static void cross(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* The world vector with these components in the frame. */
static void to_world(const double frame[3][3], const double c[3], double x[3])
{
    for (int k = 0; k < 3; ++k) {
        x[k] = frame[0][k] * c[0] + frame[1][k] * c[1] + frame[2][k] * c[2];
    }
}

/* From a body's centre of mass to the point, world. */
static void arm_to_point(const pe_problem_manifold *m, const double arm[3],
                         const pe_problem_manifold_point *point, double r[3])
{
    double s[3];
    to_world(m->frame, point->offset, s);
    for (int k = 0; k < 3; ++k) {
        r[k] = arm[k] + s[k];
    }
}

/* Solves the symmetric 3 x 3 system by elimination. */
static void solve3(const double m[6], const double b[3], double x[3])
{
    double a[3][4] = {{m[0], m[1], m[2], b[0]}, {m[1], m[3], m[4], b[1]}, {m[2], m[4], m[5], b[2]}};
    for (int c = 0; c < 3; ++c) {
        for (int r = c + 1; r < 3; ++r) {
            double part = a[r][c] / a[c][c];
            for (int k = c; k < 4; ++k) {
                a[r][k] -= part * a[c][k];
            }
        }
    }
    for (int c = 2; c >= 0; --c) {
        x[c] = a[c][3];
        for (int k = c + 1; k < 3; ++k) {
            x[c] -= a[c][k] * x[k];
        }
        x[c] /= a[c][c];
    }
}

static void push(const pe_problem_body *body, const double r[3], const double force[3], double sign,
                 double v[6])
{
    double torque[3], turn[3];
    cross(r, force, torque);
    solve3(body->inertia, torque, turn);
    for (int k = 0; k < 3; ++k) {
        v[k] += sign * force[k] / body->mass;
        v[3 + k] += sign * turn[k];
    }
}

void reference_velocities(const pe_contact_problem *problem, const double (*p)[3], double (*v)[6])
{
    for (int i = 0; i < problem->body_count; ++i) {
        memcpy(v[i], problem->bodies[i].free_velocity, sizeof v[i]);
    }
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_problem_manifold *m = &problem->manifolds[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            double force[3], r[3];
            to_world(m->frame, p[j], force);
            if (m->a != PE_STATIC) {
                arm_to_point(m, m->arm_a, &problem->points[j], r);
                push(&problem->bodies[m->a], r, force, -1, v[m->a]);
            }
            if (m->b != PE_STATIC) {
                arm_to_point(m, m->arm_b, &problem->points[j], r);
                push(&problem->bodies[m->b], r, force, 1, v[m->b]);
            }
        }
    }
}

static void add_point_velocity(const double v[6], const double r[3], double sign, double sum[3])
{
    double turn[3];
    cross(v + 3, r, turn);
    for (int k = 0; k < 3; ++k) {
        sum[k] += sign * (v[k] + turn[k]);
    }
}

void reference_contact_velocities(const pe_contact_problem *problem, const double (*v)[6],
                                  double (*u)[3])
{
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_problem_manifold *m = &problem->manifolds[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            double relative[3] = {0}, r[3];
            if (m->a != PE_STATIC) {
                arm_to_point(m, m->arm_a, &problem->points[j], r);
                add_point_velocity(v[m->a], r, -1, relative);
            }
            if (m->b != PE_STATIC) {
                arm_to_point(m, m->arm_b, &problem->points[j], r);
                add_point_velocity(v[m->b], r, 1, relative);
            }
            for (int k = 0; k < 3; ++k) {
                u[j][k] = m->frame[k][0] * relative[0] + m->frame[k][1] * relative[1] +
                          m->frame[k][2] * relative[2];
            }
            u[j][0] += problem->points[j].bias;
            u[j][1] += problem->points[j].slip[0];
            u[j][2] += problem->points[j].slip[1];
        }
    }
}

/* The impulse of a point divided by the lightest mass is about a velocity. */
static double lightest(const pe_contact_problem *problem)
{
    double least = HUGE_VAL;
    for (int i = 0; i < problem->body_count; ++i) {
        least = fmin(least, problem->bodies[i].mass);
    }
    return least;
}

double coulomb_fault(const pe_contact_problem *problem, const double (*p)[3], const double (*v)[6])
{
    double(*u)[3] = calloc((size_t)problem->point_count + 1, sizeof *u);
    assert_non_null(u);
    reference_contact_velocities(problem, v, u);
    double worst = 0, mass = lightest(problem);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_problem_manifold *m = &problem->manifolds[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            double radius = m->friction * p[j][0], push = hypot(p[j][1], p[j][2]);
            double slip = hypot(u[j][1], u[j][2]);
            worst = fmax(worst, -u[j][0]);
            worst = fmax(worst, -p[j][0] / mass);
            worst = fmax(worst, (push - radius) / mass);
            worst = fmax(worst, fmin(p[j][0] / mass, u[j][0]));
            /* Slipping: friction is at its bound, against the slip. */
            worst = fmax(worst, fmin(slip, (radius - push) / mass));
            if (slip > 0) {
                double along =
                    hypot(p[j][1] + radius * u[j][1] / slip, p[j][2] + radius * u[j][2] / slip);
                worst = fmax(worst, fmin(slip, along / mass));
            }
        }
    }
    free(u);
    return worst;
}
