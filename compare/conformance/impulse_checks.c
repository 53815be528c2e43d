/* Impulses: contacts push, what one body gains the other loses, and the impulses that are reported
 * are those that moved the bodies. */
#include "probe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double RADIUS = 0.5;     /* m, of every sphere */
static const double DT = 1.0 / 120;   /* s */
static const double LIGHT = 1;        /* kg */
static const double HEAVY = 3;        /* kg */
static const double SPEED = 2;        /* m/s, of an impact */
static const double LEAST_SHARE = .1; /* of the speed that an impact is to change */

/* Of the impulses: solvers that stop at a tolerance report what they have by then. */
static const double SHARE = 1e-4;

static void begin(pl_probe *p, double friction, double restitution, bool has_gravity)
{
    pl_scene *scene = pl_probe_scene(p, DT);
    scene->materials[0].friction = friction;
    scene->materials[0].restitution = restitution;
    if (!has_gravity) {
        memset(scene->gravity, 0, sizeof scene->gravity);
    }
}

static int add_ball(pl_probe *p, double mass, const double position[3], const double velocity[3])
{
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(RADIUS);
    ball.mass = mass;
    memcpy(ball.position, position, sizeof ball.position);
    memcpy(ball.velocity, velocity, sizeof ball.velocity);
    return pl_probe_add_body(p, ball);
}

/* A sphere that falls freely from far above, with the velocity of another one at the start: it shows
 * what gravity does in a step. */
static int add_falling(pl_probe *p, const double velocity[3])
{
    return add_ball(p, LIGHT, (double[]){0, 0, 40}, velocity);
}

/* A light sphere that hits a heavy one at rest, or a static one, off its centre. */
typedef struct collision {
    bool light_is_last, other_is_static;
} collision;

static void begin_collision(pl_probe *p, const collision *c)
{
    begin(p, 0, 0, false);
    for (int i = 0; i < 2; ++i) {
        if ((i == 1) == c->light_is_last) {
            add_ball(p, LIGHT, (double[]){0, 0, 2}, (double[]){SPEED, 0, 0});
        } else {
            const int other = add_ball(p, HEAVY, (double[]){0.8, 0.6, 2}, (double[]){0, 0, 0});
            p->scene.bodies[other].is_static = c->other_is_static;
        }
    }
    pl_probe_create(p);
}

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* ---- What the motion shows ---- */

/* Adds the linear momentum of a body and its angular momentum about the origin. */
static void add_momentum(const pl_probe *p, const pl_body_state *states, int index,
                         double linear[3], double angular[3])
{
    const pl_body *body = &p->scene.bodies[index];
    const pl_body_state *state = &states[index];
    for (int k = 0; k < 3; ++k) {
        const int x = (k + 1) % 3, y = (k + 2) % 3;
        linear[k] += body->mass * state->velocity[k];
        angular[k] += body->inertia[k] * state->angular_velocity[k];
        angular[k] += body->mass * (state->position[x] * state->velocity[y] -
                                    state->position[y] * state->velocity[x]);
    }
}

/* Two spheres that spin meet. The step is short, so that it does not matter at which of its ends
 * the impulse is thought to act. The angular momentum has a hundredth of the radius for that and for
 * the place of the point between two bodies that overlap. */
static void check_momentum(pl_probe *p)
{
    begin(p, 0.5, 0, false);
    p->scene.dt = 1e-3;
    add_ball(p, LIGHT, (double[]){0, 0, 1}, (double[]){SPEED, 0, 0});
    add_ball(p, HEAVY, (double[]){0.8, 0.6, 1}, (double[]){0, 0, 0});
    memcpy(p->scene.bodies[0].angular_velocity, (double[]){3, -4, 20}, 3 * sizeof(double));
    memcpy(p->scene.bodies[1].angular_velocity, (double[]){0, 5, -8}, 3 * sizeof(double));
    pl_probe_create(p);
    pl_probe_steps(p, 60);
    double linear[2][3] = {{0}}, angular[2][3] = {{0}}, change[3];
    for (int body = 0; body < 2; ++body) {
        add_momentum(p, p->start, body, linear[0], angular[0]);
        add_momentum(p, p->now, body, linear[1], angular[1]);
    }
    for (int k = 0; k < 3; ++k) {
        change[k] = LIGHT * (p->now[0].velocity[k] - p->start[0].velocity[k]);
    }
    const double impulse = length(change);
    char found[PL_CHECK_TEXT_SIZE];
    snprintf(found, sizeof found, "it changed by %g m/s", impulse / LIGHT);
    pl_probe_require(p, impulse > LEAST_SHARE * SPEED * LIGHT,
                     "a sphere that meets another at 2 m/s changes its velocity", found,
                     "the two spheres do not touch: sizes, positions, or a filter of pairs");
    pl_probe_expect_vector(p, "the momentum of two spheres after they met, kg m/s", linear[1],
                           linear[0], pl_probe_tolerance(p, 10 * HEAVY * SPEED),
                           "the impulse on one body, or its friction, is not the opposite of that "
                           "on the other, or the masses are not those of the scene");
    pl_probe_expect_vector(p,
                           "the angular momentum of two spheres about the origin after they met, "
                           "kg m^2/s",
                           angular[1], angular[0],
                           0.01 * RADIUS * impulse + pl_probe_tolerance(p, 10 * HEAVY * SPEED),
                           "friction turns one of the two bodies alone, or by another arm or "
                           "another moment of inertia than the scene's");
}

static void check_push(pl_probe *p)
{
    begin_collision(p, &(collision){false, false});
    pl_probe_steps(p, 60);
    double apart[3], relative[3], approach = 0;
    for (int k = 0; k < 3; ++k) {
        apart[k] = p->now[1].position[k] - p->now[0].position[k];
        relative[k] = p->now[1].velocity[k] - p->now[0].velocity[k];
    }
    const double between = length(apart);
    for (int k = 0; k < 3; ++k) {
        approach -= relative[k] * apart[k] / between;
    }
    char found[PL_CHECK_TEXT_SIZE];
    snprintf(found, sizeof found, "%g m", between);
    pl_probe_require(p, between > 1.9 * RADIUS,
                     "the centres of two spheres that met are 1 m apart or more, less 5 %", found,
                     "the impulse draws the bodies together, or it acts on the wrong body");
    snprintf(found, sizeof found, "%g m/s", approach);
    pl_probe_require(p, approach < LEAST_SHARE * SPEED,
                     "two spheres that met at 2 m/s no longer approach each other", found,
                     "the impulse draws the bodies together, or it is too small");
}

/* ---- What is reported ---- */

/* The reported impulses on one body and their torque about its centre, and what its motion shows,
 * summed over steps. */
typedef struct balance {
    double reported[3], needed[3]; /* N s */
    double torque[3], spin[3];     /* N m s */
    double size;                   /* N s, of the impulses */
    double scale, torque_scale;    /* sizes of all that is added up, for rounding */
    double normal[3];              /* of the last contact, on the body */
    double travel; /* m: the way of the body from the first to the last sub-step of a step */
} balance;

static void add_contact(balance *sum, const pl_contact *contact, int body, const double centre[3])
{
    const double sign = contact->body_b == body ? 1 : -1;
    const double *j = contact->impulse;
    double arm[3];
    for (int k = 0; k < 3; ++k) {
        arm[k] = contact->point[k] - centre[k];
        sum->reported[k] += sign * j[k];
        sum->torque[k] += sign * contact->torque[k];
        sum->normal[k] = sign * contact->normal[k];
    }
    for (int k = 0; k < 3; ++k) {
        const int x = (k + 1) % 3, y = (k + 2) % 3;
        sum->torque[k] += sign * (arm[x] * j[y] - arm[y] * j[x]);
    }
    sum->size += length(j);
    sum->scale += length(j);
}

/* Adds the last step of a body; `falling` is the one that falls freely, or -1 without gravity. */
static void add_step(pl_probe *p, int index, int falling, balance *sum)
{
    const pl_body *body = &p->scene.bodies[index];
    const pl_body_state *before = &p->before[index], *now = &p->now[index];
    for (int k = 0; k < 3; ++k) {
        const double free_change =
            falling < 0 ? 0 : p->now[falling].velocity[k] - p->before[falling].velocity[k];
        const double turn = now->angular_velocity[k] - before->angular_velocity[k];
        sum->needed[k] += body->mass * (now->velocity[k] - before->velocity[k] - free_change);
        sum->spin[k] += body->inertia[k] * turn;
    }
    sum->scale += body->mass * length(now->velocity);
    sum->scale += falling < 0 ? 0 : body->mass * length(p->now[falling].velocity);
    sum->torque_scale += body->inertia[0] * length(now->angular_velocity);
    sum->travel = length(before->velocity) * p->scene.dt * (1 - 1.0 / pl_probe_substeps(p));
    for (int i = 0; i < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[i]); ++i) {
        if (p->contacts[i].body_a == index || p->contacts[i].body_b == index) {
            add_contact(sum, &p->contacts[i], index, before->position);
        }
    }
}

/* Whether `found` is `expected` times a factor, to 2 %. */
static bool is_times(const double found[3], const double expected[3], double factor)
{
    double error[3];
    for (int k = 0; k < 3; ++k) {
        error[k] = found[k] - factor * expected[k];
    }
    return length(error) <= 0.02 * fabs(factor) * length(expected);
}

/* What usually makes these reported impulses of those needed. */
static const char *cause_of(pl_probe *p, const balance *sum)
{
    const double substeps = pl_probe_substeps(p);
    const struct {
        double factor;
        const char *cause;
    } known[] = {
        {-1, "the sign: impulses act on B. Where the adapter swaps the bodies, it has to turn "
             "normal and impulse too"},
        {1 / p->scene.dt, "a force in N: multiply it by the step"},
        {p->scene.dt, "an impulse that is multiplied by the step once more"},
        {1 / substeps, "the impulse of the last sub-step alone: sum those of the whole step"},
        {2, "twice the impulse: the engine has twice the mass, or reports a contact twice"},
        {0.5, "half the impulse: the engine has half the mass, or a part of the impulse is left "
              "out"},
        {substeps / p->scene.dt, "a force in N at the sub-steps: multiply each by the sub-step"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i) {
        if (known[i].factor != 1 && is_times(sum->reported, sum->needed, known[i].factor)) {
            return known[i].cause;
        }
    }
    double along = 0, normal[3], mirrored[3];
    for (int k = 0; k < 3; ++k) {
        along += sum->needed[k] * sum->normal[k];
    }
    for (int k = 0; k < 3; ++k) {
        normal[k] = along * sum->normal[k];
        mirrored[k] = 2 * normal[k] - sum->needed[k];
    }
    const bool slides = !is_times(normal, sum->needed, 1);
    if (length(sum->needed) > 0.01 * sum->scale && length(sum->reported) == 0) {
        return "impulses are not filled";
    }
    if (slides && is_times(sum->reported, normal, 1)) {
        return "the impulse of friction is left out";
    }
    if (slides && is_times(sum->reported, mirrored, 1)) {
        return "the sign of friction: the impulse opposes the sliding of the body that it acts on";
    }
    return "the impulses are not those of this step, or are not all that acts on the body";
}

/* `rotates`: the torque is compared too, with a hundredth of the radius for the place of a point. An
 * engine that sums impulses over sub-steps has one point for all of them, while its body goes on. */
static void expect_balance(pl_probe *p, const balance *sum, const char *what, bool rotates)
{
    char subject[PL_CHECK_TEXT_SIZE];
    snprintf(subject, sizeof subject, "the impulse of all contacts on %s, from its motion, N s",
             what);
    pl_probe_expect_vector(p, subject, sum->reported, sum->needed,
                           SHARE * sum->size + pl_probe_tolerance(p, 10 * sum->scale),
                           cause_of(p, sum));
    if (rotates) {
        snprintf(subject, sizeof subject,
                 "the torque of all contacts on %s about its centre, from its motion, N m s", what);
        pl_probe_expect_vector(p, subject, sum->torque, sum->spin,
                               (0.01 * RADIUS + sum->travel) * length(sum->needed) +
                                   pl_probe_tolerance(p, 10 * (sum->scale + sum->torque_scale)),
                               "the points of contacts are not where the impulses act, or torques "
                               "that act are not reported");
    }
}

/* The contacts of a sphere that rests are its weight times the time. */
static void check_weight(pl_probe *p)
{
    for (int order = 0; order < 2 && !p->over; ++order) {
        balance sum = {.size = 0};
        begin(p, 0, 0, true);
        if (order == 0) {
            pl_probe_add_floor(p);
        }
        const int ball = add_ball(p, HEAVY, (double[]){0, 0, RADIUS}, (double[]){0, 0, 0});
        if (order == 1) {
            pl_probe_add_floor(p);
        }
        const int falling = add_falling(p, (double[]){0, 0, 0});
        pl_probe_create(p);
        pl_probe_steps(p, 60);
        for (int n = 0; n < 60; ++n) {
            pl_probe_steps(p, 1);
            add_step(p, ball, falling, &sum);
        }
        expect_balance(p, &sum,
                       order == 0 ? "a sphere that rests on a plane, the second body"
                                  : "a sphere that rests on a plane, the first body",
                       false);
    }
}

/* The steps of a motion. */
typedef struct motion {
    int body, falling;
    int steps;
    bool rotates;
    const char *what;
} motion;

/* Every step by itself. */
static void expect_steps(pl_probe *p, const motion *m)
{
    for (int n = 0; n < m->steps && !p->over; ++n) {
        balance sum = {.size = 0};
        pl_probe_steps(p, 1);
        add_step(p, m->body, m->falling, &sum);
        expect_balance(p, &sum, m->what, m->rotates);
    }
}

static void check_impulse_friction(pl_probe *p)
{
    const double velocity[3] = {1.5, -0.5, 0};
    begin(p, 0.5, 0, true);
    pl_probe_add_floor(p);
    const int ball = add_ball(p, HEAVY, (double[]){0, 0, RADIUS}, velocity);
    memcpy(p->scene.bodies[ball].angular_velocity, (double[]){5, 8, 2}, 3 * sizeof(double));
    const int falling = add_falling(p, velocity);
    pl_probe_create(p);
    expect_steps(p, &(motion){ball, falling, 60, true, "a sphere that slides on a plane"});
}

/* Three bounces. Later ones last less than some steps, and engines differ in what they do then. */
static void check_impulse_bounce(pl_probe *p)
{
    const double velocity[3] = {1, 0, -SPEED};
    begin(p, 0, 0.5, true);
    const int ball = add_ball(p, HEAVY, (double[]){0, 0, RADIUS}, velocity);
    pl_probe_add_floor(p);
    const int falling = add_falling(p, velocity);
    pl_probe_create(p);
    expect_steps(p, &(motion){ball, falling, 40, false, "a sphere that bounces off a plane"});
}

/* An elastic box that bounces off a smaller one: all corners of the smaller top act together. */
static void check_impulse_box_bounce(pl_probe *p)
{
    const double velocity[3] = {0, 0, -SPEED};
    begin(p, 0, 1, true);
    pl_body pedestal = pl_body_default(), box = pl_body_default();
    pedestal.is_static = true;
    pedestal.shape = pl_shape_box(0.2, 0.2, 0.2);
    box.shape = pl_shape_box(0.5, 0.4, 0.3);
    box.mass = HEAVY;
    box.position[2] = 0.2 + 0.3 + 0.07;
    memcpy(box.velocity, velocity, sizeof box.velocity);
    (void)pl_probe_add_body(p, pedestal);
    const int index = pl_probe_add_body(p, box);
    const int falling = add_falling(p, velocity);
    pl_probe_create(p);
    expect_steps(p, &(motion){index, falling, 40, false, "a box that bounces off a smaller one"});
}

/* Spheres of the same size: engines order the two sides of such contacts in different ways. */
static void check_impulse_pair(pl_probe *p)
{
    static const struct {
        collision collision;
        int body;
        const char *what;
    } cases[] = {
        {{false, false}, 0, "a sphere that hits another, the first body"},
        {{false, false}, 1, "a sphere that is hit, the second body"},
        {{true, false}, 1, "a sphere that hits another, the second body"},
        {{true, false}, 0, "a sphere that is hit, the first body"},
        {{false, true}, 0, "a sphere that hits a static one, the first body"},
        {{true, true}, 1, "a sphere that hits a static one, the second body"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases && !p->over; ++i) {
        begin_collision(p, &cases[i].collision);
        expect_steps(p, &(motion){cases[i].body, -1, 30, false, cases[i].what});
    }
}

/* All corners of a box that falls flat on a plane count. */
static void check_impulse_box(pl_probe *p)
{
    begin(p, 0, 0, true);
    pl_probe_add_floor(p);
    pl_body box = pl_body_default();
    box.shape = pl_shape_box(0.5, 0.4, 0.3);
    box.mass = HEAVY;
    box.position[2] = 0.31;
    const int index = pl_probe_add_body(p, box);
    const int falling = add_falling(p, (double[]){0, 0, 0});
    pl_probe_create(p);
    expect_steps(p, &(motion){index, falling, 60, false, "a box that falls on a plane"});
}

enum {
    SMOOTH = PL_NEEDS_SPHERE | PL_NEEDS_PLANE,
    SLIDING = SMOOTH | PL_NEEDS_FRICTION | PL_NEEDS_ROTATION,
    REPORTED = PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES
};

const pl_check pl_impulse_checks[] = {
    {"momentum", "a collision with friction keeps both momenta",
     PL_NEEDS_SPHERE | PL_NEEDS_FRICTION | PL_NEEDS_ROTATION, 0, check_momentum},
    {"contact-pushes", "contacts push bodies apart", PL_NEEDS_SPHERE, 0, check_push},
    {"impulse-weight", "the impulses on a resting sphere are its weight", SMOOTH, REPORTED,
     check_weight},
    {"impulse-friction", "the impulses on a sliding sphere are those of its motion", SLIDING,
     REPORTED, check_impulse_friction},
    {"impulse-bounce", "the impulses on a bouncing sphere are those of its motion",
     SMOOTH | PL_NEEDS_RESTITUTION, REPORTED, check_impulse_bounce},
    {"impulse-box", "the impulses on a box are those of its motion",
     SMOOTH | PL_NEEDS_BOX | PL_NEEDS_ROTATION, REPORTED, check_impulse_box},
    {"impulse-box-bounce", "the impulses on a bouncing box are those of its motion",
     PL_NEEDS_BOX | PL_NEEDS_ROTATION | PL_NEEDS_RESTITUTION, REPORTED, check_impulse_box_bounce},
    {"impulse-pair", "the impulses of a collision are those of both motions", PL_NEEDS_SPHERE,
     REPORTED, check_impulse_pair},
    {0}};
