/* The state of bodies as it is written by create and read by read_frame. */
#include "check_bodies.h"
#include "mismatch.h"
#include "plumb/vec.h"
#include "referee/geometry/solid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double POSITION[3] = {1, -2, 5};
static const double VELOCITY[3] = {0.3, -0.2, 0.7};
static const double SPIN[3] = {0.5, -1.1, 0.9};

/* A body in a turned pose that moves, and spins where the engine claims rotation. */
static pl_body moving_body(pl_probe *p)
{
    pl_body body = pl_check_turned_body(p);
    memcpy(body.position, POSITION, sizeof body.position);
    memcpy(body.velocity, VELOCITY, sizeof body.velocity);
    if (pl_check_claims(p, PL_NEEDS_ROTATION)) {
        memcpy(body.angular_velocity, SPIN, sizeof body.angular_velocity);
    }
    return body;
}

/* Creates a scene of one body, whose index is returned. */
static int create_one(pl_probe *p, pl_body body)
{
    pl_probe_scene(p, 1.0 / 100);
    const int index = pl_probe_add_body(p, body);
    pl_probe_create(p);
    return index;
}

static void check_initial_position(pl_probe *p)
{
    const int body = create_one(p, moving_body(p));
    pl_probe_expect_vector(p, "the position before the first step, m", p->now[body].position,
                           POSITION, pl_probe_tolerance(p, 5),
                           "create or read_frame: the position, its order or its unit");
}

static void expect_orientation(pl_probe *p, const char *when, const double q[4],
                               const double asked[4])
{
    char what[100];
    const double sign = q[0] * asked[0] + q[1] * asked[1] + q[2] * asked[2] + q[3] * asked[3];
    const double swapped[4] = {q[3], q[0], q[1], q[2]};
    const double conjugate[4] = {q[0], -q[1], -q[2], -q[3]};
    const char *cause = "create or read_frame: the orientation";
    if (pl_angle_between(swapped, asked) < 1e-3) {
        cause = "the order of the quaternion's components is x, y, z, w: the ABI's is w, x, y, z";
    } else if (pl_angle_between(conjugate, asked) < 1e-3) {
        cause = "the quaternion is conjugated: the ABI's is from the body to the world";
    }
    /* Its length is the matter of another check. */
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    double found[4];
    for (int k = 0; k < 4; ++k) {
        found[k] = (sign < 0 ? -q[k] : q[k]) / length;
    }
    snprintf(what, sizeof what, "x, y, z of the quaternion %s", when);
    pl_probe_expect_vector(p, what, found + 1, asked + 1, pl_probe_tolerance(p, 1), cause);
    snprintf(what, sizeof what, "w of the quaternion %s", when);
    pl_probe_expect(p, what, found[0], asked[0], pl_probe_tolerance(p, 1), cause);
}

static void check_initial_orientation(pl_probe *p)
{
    const int body = create_one(p, moving_body(p));
    expect_orientation(p, "before the first step", p->now[body].orientation,
                       p->scene.bodies[body].orientation);
}

static void check_initial_velocity(pl_probe *p)
{
    const int body = create_one(p, moving_body(p));
    double turned_back[3];
    pl_check_rotate_back(p->scene.bodies[body].orientation, VELOCITY, turned_back);
    pl_guess guess = {.cause = "the velocity is in the body's axes: the ABI's is in the world's"};
    memcpy(guess.value, turned_back, sizeof guess.value);
    const double *found = p->now[body].velocity;
    pl_probe_expect_vector(
        p, "the velocity before the first step, m/s", found, VELOCITY, pl_probe_tolerance(p, 1),
        pl_guess_cause(found, &guess, 1, "create or read_frame does not set the velocity"));
}

static void check_initial_spin(pl_probe *p)
{
    const int body = create_one(p, moving_body(p));
    const double *q = p->scene.bodies[body].orientation;
    pl_guess guesses[] = {
        {.cause = "read_frame gives the angular velocity in the body's axes: the ABI's is in the "
                  "world's"},
        {.cause = "create takes the angular velocity as one in the body's axes: the ABI's is in "
                  "the world's"}};
    pl_check_rotate_back(q, SPIN, guesses[0].value);
    pl_check_rotate(q, SPIN, guesses[1].value);
    const double *found = p->now[body].angular_velocity;
    pl_probe_expect_vector(
        p, "the angular velocity before the first step, rad/s", found, SPIN,
        pl_probe_tolerance(p, 1),
        pl_guess_cause(found, guesses, 2, "create or read_frame: the angular velocity"));
}

static void check_unit_quaternions(pl_probe *p)
{
    const int body = create_one(p, moving_body(p));
    for (int step = 0; step <= 20 && !p->over; ++step) {
        const double *q = p->now[body].orientation;
        const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        pl_probe_expect(p, "the length of the quaternion", length, 1, pl_probe_tolerance(p, 10),
                        "the engine or read_frame does not normalise it");
        pl_probe_steps(p, 1);
    }
}

/* The state of a static body is that of the scene, at rest. */
static void expect_static(pl_probe *p, int body, const char *when)
{
    static const double zero[3] = {0, 0, 0};
    const pl_body *asked = &p->scene.bodies[body];
    const pl_body_state *found = &p->now[body];
    const bool is_plane = asked->shape.kind == PL_SHAPE_PLANE;
    char what[100];
    snprintf(what, sizeof what, "the position of a static %s %s, m", is_plane ? "plane" : "body",
             when);
    pl_probe_expect_vector(p, what, found->position, asked->position, pl_probe_tolerance(p, 5),
                           is_plane ? "read_frame: a plane has the position 0 and no rotation; its "
                                      "normal and offset are the shape's"
                                    : "read_frame: static bodies are read as they were given");
    expect_orientation(p, is_plane ? "of a static plane" : "of a static body", found->orientation,
                       asked->orientation);
    pl_probe_expect_vector(p, "the velocity of a static body, m/s", found->velocity, zero, 0,
                           "read_frame leaves it unset: static bodies have velocity 0");
    pl_probe_expect_vector(p, "the angular velocity of a static body, rad/s",
                           found->angular_velocity, zero, 0,
                           "read_frame leaves it unset: static bodies have velocity 0");
}

static void check_static_bodies(pl_probe *p)
{
    pl_probe_scene(p, 1.0 / 100);
    pl_body block = pl_check_turned_body(p);
    block.is_static = true;
    memcpy(block.position, POSITION, sizeof block.position);
    int bodies[2] = {pl_probe_add_body(p, block), -1};
    if (pl_check_claims(p, PL_NEEDS_PLANE)) {
        pl_body plane = pl_body_default();
        plane.is_static = true;
        plane.shape = pl_shape_plane(0, 0, 1, -2);
        bodies[1] = pl_probe_add_body(p, plane);
    }
    if (pl_check_claims(p, PL_NEEDS_SPHERE)) {
        pl_probe_add_sphere(p, 0.5, 1, (double[]){-4, 3, 6});
    }
    pl_probe_create(p);
    for (int i = 0; i < 2 && bodies[i] >= 0; ++i) {
        expect_static(p, bodies[i], "before the first step");
    }
    pl_probe_steps(p, 10);
    for (int i = 0; i < 2 && bodies[i] >= 0; ++i) {
        expect_static(p, bodies[i], "after 10 steps");
    }
}

/* A solid whose centre of mass is not the origin of its frame: the pose is that of the frame, the
 * velocity that of the centre. */
static void check_offset_centre(pl_probe *p, pl_shape (*shape_of)(pl_probe *))
{
    pl_probe_scene(p, 1.0 / 100);
    memset(p->scene.gravity, 0, sizeof p->scene.gravity);
    pl_body solid = moving_body(p);
    solid.shape = shape_of(p);
    const int body = pl_probe_add_body(p, solid);
    pl_probe_create(p);
    if (p->over) {
        return;
    }
    const pl_body *asked = &p->scene.bodies[body];
    const pl_vec centre = pl_centre_of_mass(&asked->shape, asked->position, asked->orientation);
    const pl_vec arm = pl_vec_sub(centre, pl_vec_of(asked->position));
    pl_guess is_centre = {.cause = "the position is that of the centre of mass: the ABI's is that "
                                   "of the shape's frame"};
    pl_vec_store(centre, is_centre.value);
    pl_probe_expect_vector(p, "the position of the shape's frame before the first step, m",
                           p->now[body].position, POSITION, pl_probe_tolerance(p, 5),
                           pl_guess_cause(p->now[body].position, &is_centre, 1,
                                          "the pose of the shape's frame: its offset from the "
                                          "centre of mass is pl_polyhedron.centre"));
    expect_orientation(p, "of the shape's frame, before the first step", p->now[body].orientation,
                       asked->orientation);
    pl_guess is_origin = {.cause = "the velocity is that of the frame's origin: the ABI's is that "
                                   "of the centre of mass"};
    pl_vec_store(pl_vec_sub(pl_vec_of(VELOCITY), pl_vec_cross(pl_vec_of(SPIN), arm)),
                 is_origin.value);
    pl_probe_expect_vector(p, "the velocity of the centre of mass before the first step, m/s",
                           p->now[body].velocity, VELOCITY, pl_probe_tolerance(p, 1),
                           pl_guess_cause(p->now[body].velocity, &is_origin, 1,
                                          "the velocity is that of the centre of mass"));
    pl_probe_steps(p, 50);
    if (p->over) {
        return;
    }
    const double time = pl_check_time(p, body);
    double path[3], expected[3];
    pl_vec_store(pl_vec_sub(pl_state_centre(asked, &p->now[body]), centre), path);
    pl_vec_store(pl_vec_scale(pl_vec_of(VELOCITY), time), expected);
    pl_probe_expect_vector(p, "the path of the centre of mass in 50 steps without forces, m", path,
                           expected, pl_probe_tolerance(p, 10),
                           "the engine turns the body about another point than its centre of mass, "
                           "pl_polyhedron.centre");
}

static void check_hull_centre(pl_probe *p)
{
    check_offset_centre(p, pl_check_skew_hull);
}

static void check_mesh_centre(pl_probe *p)
{
    check_offset_centre(p, pl_check_skew_mesh);
}

/* Static bodies between dynamic ones: engines keep them apart, frames do not. */
static void check_body_order(pl_probe *p)
{
    enum { COUNT = 6 };
    pl_probe_scene(p, 1.0 / 100);
    for (int i = 0; i < COUNT; ++i) {
        pl_body ball = pl_body_default();
        ball.shape = pl_shape_sphere(0.5);
        ball.mass = 1 + i;
        ball.is_static = i % 3 == 1;
        ball.position[0] = 3 * i;
        ball.position[1] = 0.5 * i * i;
        ball.velocity[0] = ball.is_static ? 0 : 0.1 * i;
        pl_probe_add_body(p, ball);
    }
    pl_probe_create(p);
    for (int step = 0; step < 2 && !p->over; ++step) {
        for (int i = 0; i < COUNT; ++i) {
            char what[PL_CHECK_TEXT_SIZE], cause[PL_CHECK_TEXT_SIZE] = "read_frame: the positions";
            const double *found = p->now[i].position;
            const int nearest = (int)lround(fmin(fmax(found[0] / 3, 0), COUNT - 1));
            if (nearest != i) {
                snprintf(cause, sizeof cause,
                         "that is body %d: frames have all bodies, static ones too, in the scene's "
                         "order",
                         nearest);
            }
            snprintf(what, sizeof what, "the x coordinate of body %d of a scene, m", i);
            pl_probe_expect(p, what, found[0],
                            3 * i + (step == 0 ? 0 : p->scene.bodies[i].velocity[0] / 100), 0.005,
                            cause);
        }
        pl_probe_steps(p, 1);
    }
}

const pl_check pl_state_checks[] = {
    {"initial-position", "bodies begin where the scene has them", 0, 0, check_initial_position},
    {"quaternion-order", "orientation reads back as (w, x, y, z), body to world", 0, 0,
     check_initial_orientation},
    {"initial-velocity", "velocity begins as the scene has it, in the world frame", 0, 0,
     check_initial_velocity},
    {"initial-spin", "angular velocity begins as the scene has it, in the world frame",
     PL_NEEDS_ROTATION, 0, check_initial_spin},
    {"unit-quaternion", "quaternions have unit length at all times", 0, 0, check_unit_quaternions},
    {"body-order", "frames have the bodies in the scene's order", PL_NEEDS_SPHERE, 0,
     check_body_order},
    {"static-bodies", "static bodies read back as the scene has them", 0, 0, check_static_bodies},
    {"hull-centre", "a hull has its own frame, and turns about its centre of mass",
     PL_NEEDS_HULL | PL_NEEDS_ROTATION, 0, check_hull_centre},
    {"mesh-centre", "a mesh has its own frame, and turns about its centre of mass",
     PL_NEEDS_MESH | PL_NEEDS_ROTATION, 0, check_mesh_centre},
    {0}};
