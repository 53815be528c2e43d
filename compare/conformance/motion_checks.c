/* Free motion: the step, gravity, the integrator, and rotation without torque. */
#include "probe.h"

#include <math.h>
#include <string.h>

/* ---- The step ---- */

/* Without forces, every integrator moves a body by its velocity times the time. Two steps that no
 * engine has as its own tell a step that is scaled from one that is always the same. */
static void check_step_length(pl_probe *p)
{
    enum { STEPS = 20 };
    static const double steps[2] = {1.0 / 100, 1.0 / 37};
    const double speed = 3;
    double found[2] = {0, 0};
    for (int i = 0; i < 2; ++i) {
        pl_body body = pl_check_any_body(p);
        body.velocity[1] = speed;
        const int index = pl_check_create_floating(p, steps[i], body);
        pl_probe_steps(p, STEPS);
        const double moves = (p->start[index].velocity[1] + p->now[index].velocity[1]) / 2;
        pl_probe_require(p, moves != 0, "a body that begins with a velocity moves", "it is at rest",
                         "create does not set the velocity");
        found[i] = (p->now[index].position[1] - p->start[index].position[1]) / (STEPS * moves);
    }
    const bool is_constant = fabs(found[0] - found[1]) < 1e-3 * steps[0];
    for (int i = 0; i < 2; ++i) {
        pl_probe_expect(p, "the time by which a body moves in a step, s", found[i], steps[i],
                        pl_probe_tolerance(p, 1) * steps[i] + pl_probe_tolerance(p, 0.02),
                        is_constant ? "the engine always makes steps of the same length: step "
                                      "must advance by its dt"
                                    : "step must advance by exactly dt");
    }
}

static void check_frame_time(pl_probe *p)
{
    enum { STEPS = 20 };
    const double dt = 1.0 / 100;
    pl_check_create_floating(p, dt, pl_check_any_body(p));
    for (int i = 0; i <= STEPS && !p->over; ++i) {
        pl_probe_expect(p, i == 0 ? "pl_frame.time before the first step, s" : "pl_frame.time, s",
                        p->frame.time, i * dt, pl_probe_tolerance(p, 1),
                        isnan(p->frame.time) ? "read_frame does not fill pl_frame.time"
                                             : "the time is the number of steps times dt");
        pl_probe_steps(p, 1);
    }
}

/* ---- Free fall ---- */

/* Creates a scene of one body with this gravity, and makes ten steps. */
static int run_fall(pl_probe *p, pl_vec gravity, pl_body body)
{
    pl_probe_scene(p, 1.0 / 100);
    pl_vec_store(gravity, p->scene.gravity);
    const int index = pl_probe_add_body(p, body);
    pl_probe_run(p, 10);
    return index;
}

static void check_gravity(pl_probe *p)
{
    const pl_vec gravity = {0, -1.5, -8.25};
    pl_body body = pl_check_any_body(p);
    body.velocity[0] = 3;
    const int index = run_fall(p, gravity, body);
    const pl_vec change =
        pl_vec_sub(pl_vec_of(p->now[index].velocity), pl_vec_of(p->start[index].velocity));
    const pl_vec found = pl_vec_scale(change, 1 / pl_check_time(p, index));
    const pl_guess guesses[] = {
        {{0, 0, -8.25}, "only the z component of pl_scene.gravity is used"},
        {{0, 0, -9.81}, "pl_scene.gravity is ignored: gravity is always (0, 0, -9.81)"},
        {{0, -9.81, 0}, "pl_scene.gravity is ignored: gravity is always (0, -9.81, 0)"},
        {{0, -8.25, 1.5}, "the axes are turned: y is up in the engine, z in the scene"},
        {{0, -8.25, -1.5}, "y and z are exchanged: a mirrored, left-handed world"},
    };
    pl_probe_expect_vector(p, "the acceleration of a falling body, m/s^2", found, gravity,
                           pl_probe_tolerance(p, 50),
                           pl_guess_cause(found, guesses, (int)(sizeof guesses / sizeof *guesses),
                                          "gravity is not pl_scene.gravity"));
}

/* The gravity's x component, which the check above needs for its clock. */
static void check_sideways_gravity(pl_probe *p)
{
    const pl_vec gravity = {0.5, 0, -8.25};
    const int index = run_fall(p, gravity, pl_check_any_body(p));
    const double *v = p->now[index].velocity;
    pl_probe_expect(p, "the x component of a fall over its z component", v[0] / v[2],
                    gravity.x / gravity.z, pl_probe_tolerance(p, 10),
                    "the x component of pl_scene.gravity is not used");
}

static const struct {
    const char *name;
    double end; /* +1: the velocity at the end of each sub-step moves the body; -1: at its start */
} integrators[] = {
    [PL_INTEGRATOR_UNKNOWN] = {"an integrator that is not stated", 0},
    [PL_INTEGRATOR_SEMI_IMPLICIT_EULER] = {"semi-implicit Euler", 1},
    [PL_INTEGRATOR_EXPLICIT_EULER] = {"explicit Euler", -1},
    [PL_INTEGRATOR_MIDPOINT] = {"the midpoint rule", 0},
};

/* The drop after `steps` steps of `substeps`, over g t^2. */
static double drop_of(pl_integrator integrator, long steps, int substeps)
{
    return 0.5 * (1 + integrators[integrator].end / (double)(steps * substeps));
}

/* The integrator and the sub-steps that a drop would be of. */
static const char *name_drop(pl_probe *p, double drop, double tolerance, long steps)
{
    static const pl_integrator known[] = {PL_INTEGRATOR_MIDPOINT, PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
                                          PL_INTEGRATOR_EXPLICIT_EULER};
    for (int substeps = 1; substeps <= 64; ++substeps) {
        for (size_t i = 0; i < sizeof known / sizeof *known; ++i) {
            if (fabs(drop - drop_of(known[i], steps, substeps)) <= tolerance) {
                return pl_probe_text(
                    p,
                    "the motion is that of %s with %d sub-steps: pl_engine.integrator or "
                    ".substeps says otherwise",
                    integrators[known[i]].name, substeps);
            }
        }
    }
    return "the velocity does not move the body as pl_engine.integrator and .substeps say";
}

/* How far a body falls tells the integrator and the number of sub-steps; both are known to the
 * harness only from what the engine declares. */
static void check_integrator(pl_probe *p)
{
    enum { STEPS = 5 };
    pl_probe_scene(p, 1.0 / 50);
    pl_body body = pl_check_any_body(p);
    body.velocity[0] = 1;
    const int index = pl_probe_add_body(p, body);
    if (!pl_probe_run(p, STEPS)) {
        return;
    }
    const pl_integrator declared = p->choice->engine->integrator;
    const int substeps = pl_probe_substeps(p);
    const double time = pl_check_time(p, index);
    const double speed = p->start[index].velocity[2] - p->now[index].velocity[2];
    const double drop = (p->start[index].position[2] - p->now[index].position[2]) / (speed * time);
    const double tolerance = pl_probe_tolerance(p, 50);
    if (declared == PL_INTEGRATOR_UNKNOWN) {
        pl_probe_expect(p, "the drop of a falling body after 5 steps, over g t^2", drop, 0.5,
                        0.5 / STEPS + tolerance, "the position does not follow the velocity");
        return;
    }
    pl_probe_expect(
        p,
        pl_probe_text(
            p, "the drop of a falling body after %d steps, over g t^2, by %s with %d sub-steps",
            STEPS, integrators[declared].name, substeps),
        drop, drop_of(declared, STEPS, substeps), tolerance, name_drop(p, drop, tolerance, STEPS));
}

/* ---- Damping ---- */

/* Fails when a velocity is not that of the start, and says what damping that would be. */
static void expect_kept(pl_probe *p, const char *what, const double found[3], const double start[3])
{
    const double speed = pl_vec_length(pl_vec_of(start));
    const double time = (double)p->steps * p->scene.dt;
    const double rate = log(speed / pl_vec_length(pl_vec_of(found))) / time;
    pl_probe_expect_vector(
        p, what, pl_vec_of(found), pl_vec_of(start), pl_probe_tolerance(p, 2 * speed),
        rate > 1e-6
            ? pl_probe_text(p, "it falls, as by a damping of %.4g 1/s: the ABI has none", rate)
            : "a torque or a force that the scene does not have");
}

static void check_speed_kept(pl_probe *p)
{
    pl_body body = pl_check_any_body(p);
    memcpy(body.velocity, (double[]){3, -2, 1}, sizeof body.velocity);
    const int index = pl_check_create_floating(p, 1.0 / 100, body);
    pl_probe_steps(p, 100);
    expect_kept(p, "the velocity of a free body after 1 s, m/s", p->now[index].velocity,
                p->start[index].velocity);
}

/* A body that spins at 2 rad/s about its first axis, a principal one. */
static int create_spinning(pl_probe *p)
{
    pl_body body = pl_check_turned_body(p);
    pl_vec_store(pl_check_rotate(body.orientation, (pl_vec){2, 0, 0}), body.angular_velocity);
    body.velocity[1] = 1;
    return pl_check_create_floating(p, 1.0 / 100, body);
}

static void check_spin_kept(pl_probe *p)
{
    const int index = create_spinning(p);
    pl_probe_steps(p, 100);
    expect_kept(p, "the angular velocity of a free body about a principal axis after 1 s, rad/s",
                p->now[index].angular_velocity, p->start[index].angular_velocity);
}

/* Speeds above the limits that engines for games have by default. */
static void check_no_limits(pl_probe *p)
{
    const double speed = 200, spin = 60;
    const bool turns = pl_check_claims(p, PL_NEEDS_ROTATION);
    pl_body body = pl_check_any_body(p);
    body.velocity[0] = speed;
    body.angular_velocity[2] = turns ? spin : 0;
    const int index = pl_check_create_floating(p, 1.0 / 240, body);
    pl_probe_steps(p, 5);
    pl_probe_expect(p, "the speed of a fast body, m/s", p->now[index].velocity[0], speed,
                    pl_probe_tolerance(p, speed), "the engine limits speeds: raise its limit");
    pl_probe_expect(p, "the angular speed of a fast body, rad/s", p->now[index].angular_velocity[2],
                    turns ? spin : 0, pl_probe_tolerance(p, spin),
                    "the engine limits angular speeds: raise its limit");
}

/* ---- Rotation ---- */

/* The rotation from orientation a to b as a vector along the world's axis, rad. */
static pl_vec turn_between(const double a[4], const double b[4])
{
    const pl_vec va = pl_vec_of(a + 1), vb = pl_vec_of(b + 1);
    const double w = a[0] * b[0] + pl_vec_dot(va, vb);
    pl_vec v = pl_vec_sub(pl_vec_scale(vb, a[0]), pl_vec_scale(va, b[0]));
    v = pl_vec_add(v, pl_vec_cross(va, vb));
    const double sine = pl_vec_length(v);
    const double angle = 2 * atan2(w < 0 ? -sine : sine, fabs(w));
    return sine > 0 ? pl_vec_scale(v, angle / sine) : v;
}

/* Makes steps and expects the turn since the start. A thousandth allows for integrators of the first
 * order. */
static void expect_turn(pl_probe *p, int body, int steps)
{
    pl_probe_steps(p, steps);
    const double *q = p->start[body].orientation;
    const pl_vec expected =
        pl_vec_scale(pl_vec_of(p->scene.bodies[body].angular_velocity), pl_check_time(p, body));
    const pl_vec turn = turn_between(q, p->now[body].orientation);
    const pl_guess guesses[] = {
        {pl_vec_scale(expected, -1),
         "the sense is reversed: a quaternion from the world to the body, or a left-handed angular "
         "velocity"},
        {pl_check_rotate(q, expected),
         "the angular velocity is taken as one in the body's axes: the ABI's is in the world's"},
        {pl_check_rotate_back(q, expected),
         "the angular velocity is turned to the body's axes and used in the world's"},
        {{0, 0, 0}, "the orientation does not follow the angular velocity"},
    };
    pl_probe_expect_vector(
        p, pl_probe_text(p, "the turn in %ld steps, along the world's axis, rad", p->steps), turn,
        expected, 1e-3 * pl_vec_length(expected),
        pl_guess_cause(turn, guesses, (int)(sizeof guesses / sizeof *guesses),
                       "the unit or the frame of the angular velocity, or the sense of the "
                       "quaternion"));
}

static void check_spin_turns(pl_probe *p)
{
    const int index = create_spinning(p);
    expect_turn(p, index, 1);
    expect_turn(p, index, 49);
}

/* The angular momentum in the world of a body with these principal moments. */
static pl_vec momentum_of(const pl_body_state *state, const double inertia[3])
{
    const pl_axes axes = pl_axes_of(state->orientation);
    const pl_vec spin = pl_to_local(&axes, pl_vec_of(state->angular_velocity));
    return pl_to_world(&axes,
                       (pl_vec){inertia[0] * spin.x, inertia[1] * spin.y, inertia[2] * spin.z});
}

/* Whether the angular momentum with the body's moments in this order is that of the start. */
static bool is_conserved(const pl_probe *p, int body, const int order[3])
{
    const double *moments = p->scene.bodies[body].inertia;
    const double inertia[3] = {moments[order[0]], moments[order[1]], moments[order[2]]};
    const pl_vec before = momentum_of(&p->start[body], inertia);
    const pl_vec after = momentum_of(&p->now[body], inertia);
    return pl_vec_length(pl_vec_sub(after, before)) <= 0.01 * pl_vec_length(before);
}

static const char *name_precession(const pl_probe *p, int body)
{
    static const struct {
        int order[3];
        const char *cause;
    } orders[] = {
        {{0, 2, 1}, "the moments about the second and third axes are exchanged"},
        {{1, 0, 2}, "the moments about the first and second axes are exchanged"},
        {{2, 1, 0}, "the moments about the first and third axes are exchanged"},
        {{1, 2, 0}, "each axis has the moment of the next one"},
        {{2, 0, 1}, "each axis has the moment of the one before"},
        {{0, 0, 0},
         "the inertia is that of a sphere, or the gyroscopic torque is left out, which "
         "PL_GYROSCOPIC_NONE declares"},
    };
    for (size_t i = 0; i < sizeof orders / sizeof *orders; ++i) {
        if (is_conserved(p, body, orders[i].order)) {
            return orders[i].cause;
        }
    }
    return "the inertia, its axes, or the gyroscopic torque w x I w";
}

/* A body with three moments that spins about no principal axis. Where the gyroscopic torque is
 * left out, the angular velocity is constant; else the angular momentum. */
static void check_precession(pl_probe *p)
{
    const pl_vec spin = {2, 3, 4};
    const pl_gyroscopic declared = p->choice->engine->gyroscopic;
    pl_body body = pl_check_turned_body(p);
    body.shape = pl_shape_box(0.1, 0.3, 0.8);
    pl_vec_store(spin, body.angular_velocity);
    const int index = pl_check_create_floating(p, 1.0 / 1000, body);
    pl_probe_steps(p, 200);
    const pl_body_state *now = &p->now[index];
    const pl_vec found = pl_vec_of(now->angular_velocity);
    const bool is_constant = pl_vec_length(pl_vec_sub(found, spin)) <= pl_probe_tolerance(p, 10);
    if (declared == PL_GYROSCOPIC_NONE) {
        pl_probe_expect_vector(p, "the angular velocity after 0.2 s, rad/s", found, spin,
                               pl_probe_tolerance(p, 10),
                               "PL_GYROSCOPIC_NONE is declared, and there is a torque");
    } else if (declared != PL_GYROSCOPIC_UNKNOWN || !is_constant) {
        const double *moments = p->scene.bodies[index].inertia;
        const pl_vec before = momentum_of(&p->start[index], moments);
        pl_probe_expect_vector(p, "the angular momentum of a free body after 0.2 s, kg m^2/s",
                               momentum_of(now, moments), before, 0.01 * pl_vec_length(before),
                               name_precession(p, index));
    }
}

const pl_check pl_motion_checks[] = {
    {"step-length", "a step advances by its dt", 0, 0, check_step_length, 0},
    {"frame-time", "the frame's time is that of the steps made", 0, 0, check_frame_time, 0},
    {"gravity", "bodies fall by the scene's gravity", 0, 0, check_gravity, 0},
    {"gravity-direction", "gravity may point in any direction", 0, 0, check_sideways_gravity, 0},
    {"integrator", "the integrator and the sub-steps are those declared", 0, 0, check_integrator,
     0},
    {"linear-damping", "free bodies keep their velocity", 0, 0, check_speed_kept, 0},
    {"angular-damping", "free bodies keep their angular velocity", PL_NEEDS_ROTATION, 0,
     check_spin_kept, 0},
    {"speed-limits", "fast bodies stay fast", 0, 0, check_no_limits, 0},
    {"angular-velocity", "angular velocity turns bodies about the world's axis, in rad/s",
     PL_NEEDS_ROTATION, 0, check_spin_turns, 0},
    {"gyroscopic-torque", "free bodies precess as declared", PL_NEEDS_ROTATION | PL_NEEDS_BOX, 0,
     check_precession, 0},
    {0}};
