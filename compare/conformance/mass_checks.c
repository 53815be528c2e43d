/* Mass, inertia and applied forces, by the motion that they cause. */
#include "probe.h"
#include "referee/geometry/solid.h"
#include "runner/session.h"

#include <math.h>
#include <string.h>

static const double DT = 1.0 / 100;

/* Adds a force; one whose end is 0 never ends. */
static void add_force(pl_probe *p, pl_force force)
{
    pl_error error = {.message = ""};
    force.until = force.until == 0 ? (double)INFINITY : force.until;
    pl_probe_expect_made(p, pl_scene_add_force(&p->scene, &force, &error), &error);
}

/* ---- Mass ---- */

static void check_mass(pl_probe *p)
{
    const pl_vec force = {3, -4, 5};
    const double mass = 2.5;
    pl_probe_floating(p, DT);
    pl_body body = pl_check_turned_body(p);
    body.mass = mass;
    memcpy(body.velocity, (double[]){4, 3, 0}, sizeof body.velocity);
    const int index = pl_probe_add_body(p, body);
    add_force(p, (pl_force){.body = index, .force = {force.x, force.y, force.z}});
    pl_probe_run(p, 1);
    const double time = pl_check_time(p, index);
    const pl_vec expected = pl_vec_scale(force, time / mass);
    const pl_vec found =
        pl_vec_sub(pl_vec_of(p->now[index].velocity), pl_vec_of(p->start[index].velocity));
    const pl_guess guesses[] = {
        {pl_vec_scale(force, time),
         "the force is used as an acceleration: it is not divided by the mass"},
        {pl_vec_scale(force, 1 / mass),
         "the force is used as an impulse: it is not multiplied by the step"},
        {pl_check_rotate(body.orientation, expected),
         "a force in the world's axes is taken as one in the body's"},
    };
    pl_probe_expect_vector(p, "the change of velocity by a force in one step, F/m dt, m/s", found,
                           expected, pl_probe_tolerance(p, 1),
                           pl_guess_cause(found, guesses, 3, "the mass, or the applied force"));
}

/* ---- Inertia ---- */

/* What the angular velocity becomes by an impulse of torque (N m s), in the world's axes, of a body with
 * these moments along these axes. */
static pl_vec spin_by(const pl_axes *axes, const double moments[3], pl_vec impulse)
{
    const pl_vec local = pl_to_local(axes, impulse);
    return pl_to_world(axes,
                       (pl_vec){local.x / moments[0], local.y / moments[1], local.z / moments[2]});
}

/* Adds a turned box, which moves along its axis `k`, and a force in the world's axes off its centre,
 * whose torque is about that axis. */
static void add_turned_by(pl_probe *p, pl_body box, int k, double torque)
{
    const double reach = 0.25;
    const pl_axes axes = pl_axes_of(box.orientation);
    pl_vec_store(axes.axis[k], box.velocity);
    memcpy(box.position, (double[]){4.0 * k, 1, -2}, sizeof box.position);
    pl_force force = {.body = pl_probe_add_body(p, box)};
    pl_vec_store(pl_vec_scale(axes.axis[(k + 1) % 3], reach), force.at);
    pl_vec_store(pl_vec_scale(axes.axis[(k + 2) % 3], torque / reach), force.force);
    add_force(p, force);
}

static void expect_turned_by(pl_probe *p, int k, double torque)
{
    static const char *const axis_names[3] = {"first", "second", "third"};
    const pl_body *box = &p->scene.bodies[k];
    const pl_force *force = &p->scene.forces[k];
    const pl_axes axes = pl_axes_of(box->orientation);
    const double time = pl_check_time(p, k);
    const pl_vec impulse = pl_vec_scale(axes.axis[k], torque * time);
    const pl_vec push = pl_vec_scale(pl_vec_of(force->force), time), at = pl_vec_of(force->at);
    const pl_vec from_origin = pl_vec_sub(at, pl_vec_of(box->position));
    const pl_vec turned = pl_check_rotate(box->orientation, at);
    const double *m = box->inertia;
    const pl_guess guesses[] = {
        {spin_by(&axes, (double[]){m[1], m[2], m[0]}, impulse),
         "the moment about this axis is that of the next one: the order of pl_body.inertia is that "
         "of the shape's axes"},
        {spin_by(&axes, (double[]){m[2], m[0], m[1]}, impulse),
         "the moment about this axis is that of the one before: the order of pl_body.inertia is "
         "that of the shape's axes"},
        {{0, 0, 0}, "pl_force.at is ignored: the force acts at the centre of mass"},
        {spin_by(&axes, m, pl_vec_cross(from_origin, push)),
         "the force is applied at a point of the world: pl_force.at is an offset from the centre "
         "of "
         "mass"},
        {spin_by(&axes, m, pl_vec_cross(turned, push)),
         "pl_force.at of PL_FRAME_WORLD is taken as an offset in the body's axes"},
    };
    const pl_vec found = pl_vec_of(p->now[k].angular_velocity);
    /* The moments of a sphere are all the same. */
    const int first = m[0] == m[1] ? 2 : 0;
    pl_probe_expect_vector(
        p,
        pl_probe_text(
            p, "the angular velocity after one step of a torque about the body's %s axis, rad/s",
            axis_names[k]),
        found, spin_by(&axes, m, impulse), pl_probe_tolerance(p, 1),
        pl_guess_cause(found, guesses + first, 5 - first,
                       "the inertia, or the torque of an applied force"));
}

/* One box for each axis. A torque about a principal axis of a body at rest changes the angular
 * velocity along that axis alone, by any integrator and any number of sub-steps. With a variant, the
 * moments are not those of a uniform box. */
static void check_inertia(pl_probe *p)
{
    const double torque = 0.05;
    pl_probe_floating(p, DT);
    for (int k = 0; k < 3; ++k) {
        pl_body box = pl_check_turned_body(p);
        if (p->check->variant != 0) {
            memcpy(box.inertia, (double[]){0.3, 0.5, 0.6}, sizeof box.inertia);
        }
        add_turned_by(p, box, k, torque);
    }
    pl_probe_run(p, 1);
    for (int k = 0; k < 3 && !p->over; ++k) {
        expect_turned_by(p, k, torque);
    }
}

/* The moments of a hull or a mesh belong to the axes of pl_polyhedron.axes, which are not those of
 * the shape's frame. The torque is about no principal axis: the rotation within the step, and its
 * gyroscopic torque, change the result by less than a thousandth. */
static void check_polyhedron_inertia(pl_probe *p)
{
    pl_probe_floating(p, DT);
    pl_body solid = pl_check_turned_body(p);
    solid.shape = pl_check_skew_solid(p, (pl_shape_kind)p->check->variant);
    solid.velocity[2] = 1; /* along the axis that the force is perpendicular to */
    const int index = pl_probe_add_body(p, solid);
    add_force(p, (pl_force){.body = index, .force = {0.03, -0.04, 0}, .at = {0.3, 0.2, -0.4}});
    pl_probe_run(p, 1);
    const pl_body *body = &p->scene.bodies[index];
    const pl_force *force = &p->scene.forces[0];
    const pl_vec impulse = pl_vec_scale(pl_vec_cross(pl_vec_of(force->at), pl_vec_of(force->force)),
                                        pl_check_time(p, index));
    const pl_axes principal = pl_principal_axes(&body->shape, body->orientation);
    const pl_axes frame = pl_axes_of(body->orientation);
    const pl_vec expected = spin_by(&principal, body->inertia, impulse);
    const pl_vec found = pl_vec_of(p->now[index].angular_velocity);
    const pl_guess guess = {
        spin_by(&frame, body->inertia, impulse),
        "the moments are taken along the axes of the shape's frame: they belong "
        "to the principal axes, pl_polyhedron.axes"};
    pl_probe_expect_vector(
        p, "the angular velocity after one step of a torque, rad/s", found, expected,
        1e-3 * pl_vec_length(expected),
        pl_guess_cause(found, &guess, 1,
                       "the moments of inertia, their axes, or a torque that is not about the "
                       "centre of mass, pl_polyhedron.centre"));
}

/* ---- Applied forces ---- */

/* Expects a change of velocity along `direction`, in the body's axes. Its size is the matter of other
 * checks. */
static void expect_along(pl_probe *p, const char *what, pl_vec found, const double orientation[4],
                         pl_vec direction, const char *cause_if_world)
{
    const double size = pl_vec_length(found);
    const pl_guess guess = {direction, cause_if_world};
    const pl_vec scaled = size > 0 ? pl_vec_scale(found, 1 / size) : (pl_vec){0, 0, 0};
    pl_probe_expect_vector(
        p, what, scaled, pl_check_rotate(orientation, direction), pl_probe_tolerance(p, 10),
        size > 0 ? pl_guess_cause(scaled, &guess, 1,
                                  "the force and pl_force.at of PL_FRAME_BODY are in the body's "
                                  "axes, the latter from the centre of mass")
                 : "forces of PL_FRAME_BODY, or their torques, are ignored");
}

/* A force in the body's axes, at a point in the body's axes. */
static void check_body_force(pl_probe *p)
{
    pl_probe_floating(p, DT);
    pl_body body = pl_check_turned_body(p);
    const int pushed = pl_probe_add_body(p, body);
    add_force(p, (pl_force){.body = pushed, .force = {3, -4, 12}, .frame = PL_FRAME_BODY});
    body.position[0] += 4;
    const int turned = pl_probe_add_body(p, body);
    add_force(
        p, (pl_force){
               .body = turned, .force = {0, 0, 0.2}, .at = {0, 0.25, 0}, .frame = PL_FRAME_BODY});
    pl_probe_run(p, 1);
    expect_along(p, "the direction of the velocity by a force in the body's axes",
                 pl_vec_of(p->now[pushed].velocity), body.orientation,
                 (pl_vec){3 / 13.0, -4 / 13.0, 12 / 13.0},
                 "a force of PL_FRAME_BODY is taken as one in the world's axes");
    expect_along(p, "the direction of the angular velocity by a force in the body's axes",
                 pl_vec_of(p->now[turned].angular_velocity), body.orientation, (pl_vec){1, 0, 0},
                 "pl_force.at of PL_FRAME_BODY is taken as one in the world's axes");
}

/* Forces on one body add up, and each acts on its own body alone. */
static void check_two_forces(pl_probe *p)
{
    pl_probe_floating(p, DT);
    pl_body body = pl_check_any_body(p);
    /* Beyond spheres, two bodies may touch, and need rotation. */
    const bool has_other =
        body.shape.kind == PL_SHAPE_SPHERE || pl_check_claims(p, PL_NEEDS_ROTATION);
    const int other = has_other ? pl_probe_add_body(p, body) : -1;
    body.position[0] = 5;
    body.velocity[1] = 1;
    const int index = pl_probe_add_body(p, body);
    add_force(p, (pl_force){.body = index, .force = {3, 0, 0}});
    add_force(p, (pl_force){.body = index, .force = {0, 0, 5}});
    pl_probe_run(p, 1);
    const double rate = pl_check_time(p, index) / body.mass;
    const pl_vec found = pl_vec_of(p->now[index].velocity);
    const pl_vec sum = {3 * rate, 1, 5 * rate};
    const pl_guess guesses[] = {{{sum.x, 1, 0}, "only the first force on a body acts"},
                                {{0, 1, sum.z}, "only the last force on a body acts"},
                                {{0, 1, 0}, "forces do not act on the body that they name"}};
    pl_probe_expect_vector(p, "the velocity after one step of two forces on a body, m/s", found,
                           sum, pl_probe_tolerance(p, 1),
                           pl_guess_cause(found, guesses, 3, "the sum of the forces on a body"));
    if (other >= 0) {
        pl_probe_expect_vector(p, "the velocity of a body that no force acts on, m/s",
                               pl_vec_of(p->now[other].velocity), (pl_vec){0, 0, 0},
                               pl_probe_tolerance(p, 1),
                               "forces do not act on the body that they name: pl_force.body");
    }
}

/* A force acts during the steps for which pl_force_acts: those that start from its beginning on and
 * before its end, where rounding of the summed time does not matter. A time that is summed in floats
 * is further off, so that an engine of that precision gets times between two steps. */
static void check_force_window(pl_probe *p)
{
    enum { FROM = 5, UNTIL = 10, STEPS = 15 };
    const bool single = p->choice->engine->precision == PL_PRECISION_FLOAT;
    const double earlier = single ? 0.5 * DT : 0;
    pl_probe_floating(p, DT);
    const int index = pl_probe_add_body(p, pl_check_any_body(p));
    add_force(p, (pl_force){.body = index,
                            .force = {2, 0, 0},
                            .from = FROM * DT - earlier,
                            .until = UNTIL * DT - earlier});
    pl_probe_create(p);
    double before = 0, first = 0;
    for (int step = 1; step <= STEPS && !p->over; ++step) {
        const bool acts = step > FROM && step <= UNTIL;
        pl_probe_steps(p, 1);
        const double change = p->now[index].velocity[0] - before;
        before = p->now[index].velocity[0];
        pl_probe_require(
            p, (fabs(change) > 1e-3 * DT) == acts,
            pl_probe_text(p, "a force from step %d to %d %s in step %d", FROM + 1, (int)UNTIL,
                          acts ? "acts" : "does not act", step),
            pl_probe_text(p, "the velocity changes by %.6g m/s", change),
            "pl_force.from or .until: pl_force_acts says whether a force acts over a step");
        first = step == FROM + 1 ? change : first;
        if (acts) {
            pl_probe_expect(p, "the change of velocity by a constant force in a later step, m/s",
                            change, first, pl_probe_tolerance(p, 1),
                            "forces add up from step to step: they are to be cleared after each");
        }
    }
}

/* ---- Without forces ---- */

/* Two spheres that collide show the ratio of their masses, whatever the contact is like. */
static void check_mass_ratio(pl_probe *p)
{
    pl_probe_floating(p, DT);
    p->scene.materials[0].friction = 0;
    const int light = pl_probe_add_ball(p, 1, (pl_vec){0, 0, 0}, (pl_vec){2, 0, 0});
    const int heavy = pl_probe_add_ball(p, 3, (pl_vec){1.05, 0, 0}, (pl_vec){0, 0, 0});
    pl_probe_run(p, 20);
    const double gained = p->now[heavy].velocity[0] - p->start[heavy].velocity[0];
    const double lost = p->start[light].velocity[0] - p->now[light].velocity[0];
    pl_probe_require(p, gained > 0.1, "a sphere of 2 m/s moves the sphere that it hits",
                     pl_probe_text(p, "velocities %.6g and %.6g m/s", p->now[light].velocity[0],
                                   p->now[heavy].velocity[0]),
                     "the spheres pass through each other, or create does not set the velocity");
    const double ratio = lost / gained;
    const char *cause = "the masses, or impulses on the two bodies that are not opposite";
    if (fabs(ratio - 1) < 1e-3) {
        cause = "pl_body.mass is ignored: both bodies have the same mass";
    } else if (fabs(3 * ratio - 1) < 1e-3) {
        cause = "the inverse mass is used as the mass";
    }
    pl_probe_expect(p,
                    "the ratio of the masses of 3 kg and 1 kg, by the changes of their velocities "
                    "in a collision",
                    ratio, 3, fmax(pl_probe_tolerance(p, 9), 3e-6), cause);
}

/* What the engine reads back of the scene's parameters, where it reads back any. */
static void check_read_back(pl_probe *p)
{
    pl_probe_scene(p, DT);
    memcpy(p->scene.gravity, (double[]){0.5, -1.5, -8.25}, sizeof p->scene.gravity);
    pl_body body = pl_check_turned_body(p);
    body.position[2] = 3;
    pl_probe_add_body(p, body);
    body.is_static = true;
    body.position[2] = 6;
    if (pl_check_claims(p, PL_NEEDS_ROTATION) || body.shape.kind == PL_SHAPE_SPHERE) {
        pl_probe_add_body(p, body);
    }
    if (!pl_probe_run(p, 0)) {
        return;
    }
    unsigned compared = 0;
    int substeps = 0;
    pl_error error = {.message = ""};
    if (pl_parameter_check(&p->session, &p->scene, &compared, &substeps, &error) != PL_OK) {
        pl_probe_fail(p, "what the engine reads back is what the scene has", error.message,
                      "read_settings or read_pair, or the engine simulates another scene; a number "
                      "that it does not have stays NAN");
    } else if (compared == 0) {
        pl_probe_skip(p, "the engine reads nothing back");
    }
}

const pl_check pl_mass_checks[] = {
    {"mass", "an applied force changes the velocity by F/m dt", PL_NEEDS_FORCES, 0, check_mass, 0},
    {"inertia-axes", "a torque about each axis turns a body by its moment of inertia",
     PL_NEEDS_FORCES | PL_NEEDS_ROTATION, 0, check_inertia, 0},
    {"given-inertia", "a body's inertia is the scene's, not its shape's",
     PL_NEEDS_FORCES | PL_NEEDS_ROTATION | PL_NEEDS_BOX, 0, check_inertia, true},
    {"hull-inertia", "the moments of a hull belong to its principal axes",
     PL_NEEDS_FORCES | PL_NEEDS_ROTATION | PL_NEEDS_HULL, 0, check_polyhedron_inertia,
     PL_SHAPE_HULL},
    {"mesh-inertia", "the moments of a mesh belong to its principal axes",
     PL_NEEDS_FORCES | PL_NEEDS_ROTATION | PL_NEEDS_MESH, 0, check_polyhedron_inertia,
     PL_SHAPE_MESH},
    {"body-force", "forces in the body's axes turn with the body",
     PL_NEEDS_FORCES | PL_NEEDS_ROTATION, 0, check_body_force, 0},
    {"two-forces", "forces add up, and act on the body that they name", PL_NEEDS_FORCES, 0,
     check_two_forces, 0},
    {"force-times", "a force acts from its start until its end", PL_NEEDS_FORCES, 0,
     check_force_window, 0},
    {"mass-ratio", "a collision conserves momentum with the scene's masses", PL_NEEDS_SPHERE, 0,
     check_mass_ratio, 0},
    {"read-back", "masses, gravity and the step read back as the scene has them", 0, 0,
     check_read_back, 0},
    {0}};
