/* The state of bodies as it is written by create and read by read_frame. */
#include "probe.h"
#include "referee/geometry/solid.h"

#include <math.h>
#include <string.h>

static const pl_vec POSITION = {1, -2, 5};
static const pl_vec VELOCITY = {0.3, -0.2, 0.7};
static const pl_vec SPIN = {0.5, -1.1, 0.9};

/* A body in a turned pose that moves, and spins where the engine claims rotation. */
static pl_body moving_body(pl_probe *p)
{
    pl_body body = pl_check_turned_body(p);
    pl_vec_store(POSITION, body.position);
    pl_vec_store(VELOCITY, body.velocity);
    if (pl_check_claims(p, PL_NEEDS_ROTATION)) {
        pl_vec_store(SPIN, body.angular_velocity);
    }
    return body;
}

/* Creates a scene of that body alone, which has index 0. Its state, as read. */
static const pl_body_state *create_moving(pl_probe *p)
{
    pl_probe_scene(p, 1.0 / 100);
    pl_probe_add_body(p, moving_body(p));
    pl_probe_create(p);
    return &p->now[0];
}

static void check_initial_position(pl_probe *p)
{
    pl_probe_expect_vector(
        p, "the position before the first step, m", pl_vec_of(create_moving(p)->position), POSITION,
        pl_probe_tolerance(p, 5), "create or read_frame: the position, its order or its unit");
}

static double length_of(const double q[4])
{
    return sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

static void expect_orientation(pl_probe *p, const char *when, const double q[4],
                               const double asked[4])
{
    const double dot = q[0] * asked[0] + q[1] * asked[1] + q[2] * asked[2] + q[3] * asked[3];
    const double swapped[4] = {q[3], q[0], q[1], q[2]};
    const double conjugate[4] = {q[0], -q[1], -q[2], -q[3]};
    const char *cause = "create or read_frame: the orientation";
    if (pl_angle_between(swapped, asked) < 1e-3) {
        cause = "the order of the quaternion's components is x, y, z, w: the ABI's is w, x, y, z";
    } else if (pl_angle_between(conjugate, asked) < 1e-3) {
        cause = "the quaternion is conjugated: the ABI's is from the body to the world";
    }
    /* Its length is the matter of another check. */
    const double scale = (dot < 0 ? -1 : 1) / length_of(q);
    pl_probe_expect_vector(p, pl_probe_text(p, "x, y, z of the quaternion %s", when),
                           pl_vec_scale(pl_vec_of(q + 1), scale), pl_vec_of(asked + 1),
                           pl_probe_tolerance(p, 1), cause);
    pl_probe_expect(p, pl_probe_text(p, "w of the quaternion %s", when), scale * q[0], asked[0],
                    pl_probe_tolerance(p, 1), cause);
}

static void check_initial_orientation(pl_probe *p)
{
    const double *found = create_moving(p)->orientation;
    expect_orientation(p, "before the first step", found, p->scene.bodies[0].orientation);
}

static void check_initial_velocity(pl_probe *p)
{
    const pl_vec found = pl_vec_of(create_moving(p)->velocity);
    const pl_guess guess = {pl_check_rotate_back(p->scene.bodies[0].orientation, VELOCITY),
                            "the velocity is in the body's axes: the ABI's is in the world's"};
    pl_probe_expect_vector(
        p, "the velocity before the first step, m/s", found, VELOCITY, pl_probe_tolerance(p, 1),
        pl_guess_cause(found, &guess, 1, "create or read_frame does not set the velocity"));
}

static void check_initial_spin(pl_probe *p)
{
    const pl_vec found = pl_vec_of(create_moving(p)->angular_velocity);
    const double *q = p->scene.bodies[0].orientation;
    const pl_guess guesses[] = {
        {pl_check_rotate_back(q, SPIN), "read_frame gives the angular velocity in the body's axes: "
                                        "the ABI's is in the world's"},
        {pl_check_rotate(q, SPIN), "create takes the angular velocity as one in the body's axes: "
                                   "the ABI's is in the world's"}};
    pl_probe_expect_vector(
        p, "the angular velocity before the first step, rad/s", found, SPIN,
        pl_probe_tolerance(p, 1),
        pl_guess_cause(found, guesses, 2, "create or read_frame: the angular velocity"));
}

static void check_unit_quaternions(pl_probe *p)
{
    const pl_body_state *now = create_moving(p);
    for (int step = 0; step <= 20 && !p->over; ++step) {
        pl_probe_expect(p, "the length of the quaternion", length_of(now->orientation), 1,
                        pl_probe_tolerance(p, 10),
                        "the engine or read_frame does not normalise it");
        pl_probe_steps(p, 1);
    }
}

/* The state of a static body is that of the scene, at rest. */
static void expect_static(pl_probe *p, int body, const char *when)
{
    const pl_vec zero = {0, 0, 0};
    const pl_body *asked = &p->scene.bodies[body];
    const pl_body_state *found = &p->now[body];
    const bool is_plane = asked->shape.kind == PL_SHAPE_PLANE;
    pl_probe_expect_vector(
        p, pl_probe_text(p, "the position of a static %s %s, m", is_plane ? "plane" : "body", when),
        pl_vec_of(found->position), pl_vec_of(asked->position), pl_probe_tolerance(p, 5),
        is_plane ? "read_frame: a plane has the position 0 and no rotation; its "
                   "normal and offset are the shape's"
                 : "read_frame: static bodies are read unchanged");
    expect_orientation(p, is_plane ? "of a static plane" : "of a static body", found->orientation,
                       asked->orientation);
    pl_probe_expect_vector(p, "the velocity of a static body, m/s", pl_vec_of(found->velocity),
                           zero, 0, "read_frame leaves it unset: static bodies have velocity 0");
    pl_probe_expect_vector(p, "the angular velocity of a static body, rad/s",
                           pl_vec_of(found->angular_velocity), zero, 0,
                           "read_frame leaves it unset: static bodies have velocity 0");
}

static void check_static_bodies(pl_probe *p)
{
    static const char *const when[] = {"before the first step", "after 10 steps"};
    pl_probe_scene(p, 1.0 / 100);
    pl_body block = pl_check_turned_body(p);
    block.is_static = true;
    pl_vec_store(POSITION, block.position);
    pl_probe_add_body(p, block);
    if (pl_check_claims(p, PL_NEEDS_PLANE)) {
        pl_probe_add_body(p, (pl_body){.is_static = true, .shape = pl_shape_plane(0, 0, 1, -2)});
    }
    const int count = p->scene.body_count;
    if (pl_check_claims(p, PL_NEEDS_SPHERE)) {
        pl_probe_add_ball(p, 1, (pl_vec){-4, 3, 6}, (pl_vec){0, 0, 0});
    }
    pl_probe_create(p);
    for (int later = 0; later < 2; ++later) {
        pl_probe_steps(p, 10 * later);
        for (int i = 0; i < count; ++i) {
            expect_static(p, i, when[later]);
        }
    }
}

/* A solid whose centre of mass is not the origin of its frame: the pose is that of the frame, the
 * velocity that of the centre. */
static void check_offset_centre(pl_probe *p)
{
    pl_probe_floating(p, 1.0 / 100);
    pl_body solid = moving_body(p);
    solid.shape = pl_check_skew_solid(p, (pl_shape_kind)p->check->variant);
    const int body = pl_probe_add_body(p, solid);
    pl_probe_run(p, 0);
    const pl_body *asked = &p->scene.bodies[body];
    const pl_body_state *now = &p->now[body];
    const pl_vec centre = pl_centre_of_mass(&asked->shape, asked->position, asked->orientation);
    const pl_vec arm = pl_vec_sub(centre, POSITION);
    const pl_guess is_centre = {
        centre,
        "the position is that of the centre of mass: the ABI's is that of the shape's frame"};
    const pl_guess is_origin = {pl_vec_sub(VELOCITY, pl_vec_cross(SPIN, arm)),
                                "the velocity is that of the frame's origin: the ABI's is that of "
                                "the centre of mass"};
    pl_vec found = pl_vec_of(now->position);
    pl_probe_expect_vector(p, "the position of the shape's frame before the first step, m", found,
                           POSITION, pl_probe_tolerance(p, 5),
                           pl_guess_cause(found, &is_centre, 1,
                                          "the pose of the shape's frame: its offset from the "
                                          "centre of mass is pl_polyhedron.centre"));
    expect_orientation(p, "of the shape's frame, before the first step", now->orientation,
                       asked->orientation);
    found = pl_vec_of(now->velocity);
    pl_probe_expect_vector(
        p, "the velocity of the centre of mass before the first step, m/s", found, VELOCITY,
        pl_probe_tolerance(p, 1),
        pl_guess_cause(found, &is_origin, 1, "the velocity is that of the centre of mass"));
    pl_probe_steps(p, 50);
    pl_probe_expect_vector(p, "the path of the centre of mass in 50 steps without forces, m",
                           pl_vec_sub(pl_state_centre(asked, now), centre),
                           pl_vec_scale(VELOCITY, pl_check_time(p, body)),
                           pl_probe_tolerance(p, 10),
                           "the engine turns the body about another point than its centre of mass, "
                           "pl_polyhedron.centre");
}

/* Static bodies between dynamic ones: engines keep them apart, frames do not. */
static void check_body_order(pl_probe *p)
{
    enum { COUNT = 6 };
    pl_probe_scene(p, 1.0 / 100);
    for (int i = 0; i < COUNT; ++i) {
        const bool is_static = i % 3 == 1;
        pl_probe_add_body(p, (pl_body){.shape = pl_shape_sphere(0.5),
                                       .mass = 1 + i,
                                       .is_static = is_static,
                                       .position = {3 * i, 0.5 * i * i, 0},
                                       .velocity = {is_static ? 0 : 0.1 * i, 0, 0}});
    }
    pl_probe_create(p);
    for (int step = 0; step < 2 && !p->over; ++step) {
        for (int i = 0; i < COUNT; ++i) {
            const double found = p->now[i].position[0];
            const double expected = 3 * i + (step == 0 ? 0 : p->scene.bodies[i].velocity[0] / 100);
            const int nearest = (int)lround(fmin(fmax(found / 3, 0), COUNT - 1));
            pl_probe_expect(
                p, pl_probe_text(p, "the x coordinate of body %d of a scene, m", i), found,
                expected, 0.005,
                nearest == i ? "read_frame: the positions"
                             : pl_probe_text(p,
                                             "that is body %d: frames have all bodies, static ones "
                                             "too, in the scene's order",
                                             nearest));
        }
        pl_probe_steps(p, 1);
    }
}

const pl_check pl_state_checks[] = {
    {"initial-position", "bodies begin where the scene has them", 0, 0, check_initial_position, 0},
    {"quaternion-order", "orientation reads back as (w, x, y, z), body to world", 0, 0,
     check_initial_orientation, 0},
    {"initial-velocity", "velocity begins as the scene has it, in the world frame", 0, 0,
     check_initial_velocity, 0},
    {"initial-spin", "angular velocity begins as the scene has it, in the world frame",
     PL_NEEDS_ROTATION, 0, check_initial_spin, 0},
    {"unit-quaternion", "quaternions have unit length at all times", 0, 0, check_unit_quaternions,
     0},
    {"body-order", "frames have the bodies in the scene's order", PL_NEEDS_SPHERE, 0,
     check_body_order, 0},
    {"static-bodies", "static bodies read back as the scene has them", 0, 0, check_static_bodies,
     0},
    {"hull-centre", "a hull has its own frame, and turns about its centre of mass",
     PL_NEEDS_HULL | PL_NEEDS_ROTATION, 0, check_offset_centre, PL_SHAPE_HULL},
    {"mesh-centre", "a mesh has its own frame, and turns about its centre of mass",
     PL_NEEDS_MESH | PL_NEEDS_ROTATION, 0, check_offset_centre, PL_SHAPE_MESH},
    {0}};
