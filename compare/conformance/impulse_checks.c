/* Impulses: contacts push, what one body gains the other loses, and the impulses that are reported
 * are those that moved the bodies. */
#include "probe.h"

#include <math.h>

static const double DT = 1.0 / 120;   /* s */
static const double LIGHT = 1;        /* kg */
static const double HEAVY = 3;        /* kg */
static const double SPEED = 2;        /* m/s, of an impact */
static const double LEAST_SHARE = .1; /* of the speed that an impact is to change */
static const pl_vec STILL = {0, 0, 0};

/* Of the impulses: solvers that stop at a tolerance report what they have by then. */
static const double SHARE = 1e-4;

static void begin(pl_probe *p, double friction, double restitution, bool has_gravity)
{
    pl_scene *scene = has_gravity ? pl_probe_scene(p, DT) : pl_probe_floating(p, DT);
    scene->materials[0].friction = friction;
    scene->materials[0].restitution = restitution;
}

static void spin(pl_probe *p, int body, pl_vec angular_velocity)
{
    pl_vec_store(angular_velocity, p->scene.bodies[body].angular_velocity);
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
            pl_probe_add_ball(p, LIGHT, (pl_vec){0, 0, 2}, (pl_vec){SPEED, 0, 0});
        } else {
            const int other = pl_probe_add_ball(p, HEAVY, (pl_vec){0.8, 0.6, 2}, STILL);
            p->scene.bodies[other].is_static = c->other_is_static;
        }
    }
    pl_probe_create(p);
}

/* ---- What the motion shows ---- */

/* The angular momentum of a body whose principal axes are the world's. */
static pl_vec spin_momentum(const pl_body *body, const double spin[3])
{
    return (pl_vec){body->inertia[0] * spin[0], body->inertia[1] * spin[1],
                    body->inertia[2] * spin[2]};
}

/* The momentum of the two bodies of the scene, and their angular momentum about the origin. */
static void momentum_of(const pl_probe *p, const pl_body_state states[2], pl_vec *linear,
                        pl_vec *angular)
{
    *linear = *angular = (pl_vec){0, 0, 0};
    for (int i = 0; i < 2; ++i) {
        const pl_body *body = &p->scene.bodies[i];
        const pl_vec momentum = pl_vec_scale(pl_vec_of(states[i].velocity), body->mass);
        *linear = pl_vec_add(*linear, momentum);
        *angular = pl_vec_add(*angular, spin_momentum(body, states[i].angular_velocity));
        *angular = pl_vec_add(*angular, pl_vec_cross(pl_vec_of(states[i].position), momentum));
    }
}

/* Two spheres that spin meet. The step is short, so that it does not matter at which of its ends
 * the impulse is thought to act. The angular momentum has a hundredth of the radius for that and for
 * the place of the point between two bodies that overlap. */
static void check_momentum(pl_probe *p)
{
    pl_vec linear[2], angular[2];
    begin(p, 0.5, 0, false);
    p->scene.dt = 1e-3;
    pl_probe_add_ball(p, LIGHT, (pl_vec){0, 0, 1}, (pl_vec){SPEED, 0, 0});
    pl_probe_add_ball(p, HEAVY, (pl_vec){0.8, 0.6, 1}, STILL);
    spin(p, 0, (pl_vec){3, -4, 20});
    spin(p, 1, (pl_vec){0, 5, -8});
    pl_probe_run(p, 60);
    momentum_of(p, p->start, &linear[0], &angular[0]);
    momentum_of(p, p->now, &linear[1], &angular[1]);
    const double change =
        pl_vec_length(pl_vec_sub(pl_vec_of(p->now[0].velocity), pl_vec_of(p->start[0].velocity)));
    pl_probe_require(p, change > LEAST_SHARE * SPEED,
                     "a sphere that meets another at 2 m/s changes its velocity",
                     pl_probe_text(p, "it changed by %g m/s", change),
                     "the two spheres do not touch: sizes, positions, or a filter of pairs");
    pl_probe_expect_vector(p, "the momentum of two spheres after they met, kg m/s", linear[1],
                           linear[0], pl_probe_tolerance(p, 10 * HEAVY * SPEED),
                           "the impulse on one body, or its friction, is not the opposite of that "
                           "on the other, or the masses are not those of the scene");
    pl_probe_expect_vector(
        p, "the angular momentum of two spheres about the origin after they met, kg m^2/s",
        angular[1], angular[0],
        0.01 * PL_BALL_RADIUS * LIGHT * change + pl_probe_tolerance(p, 10 * HEAVY * SPEED),
        "friction turns one of the two bodies alone, or by another arm or another moment of "
        "inertia "
        "than the scene's");
}

static void check_push(pl_probe *p)
{
    begin_collision(p, &(collision){false, false});
    pl_probe_steps(p, 60);
    const pl_body_state *a = &p->now[0], *b = &p->now[1];
    const pl_vec apart = pl_vec_sub(pl_vec_of(b->position), pl_vec_of(a->position));
    const pl_vec relative = pl_vec_sub(pl_vec_of(b->velocity), pl_vec_of(a->velocity));
    const double between = pl_vec_length(apart);
    const double approach = -pl_vec_dot(relative, apart) / between;
    pl_probe_require(p, between > 1.9 * PL_BALL_RADIUS,
                     "the centres of two spheres that met are 1 m apart or more, less 5 %",
                     pl_probe_text(p, "%g m", between),
                     "the impulse draws the bodies together, or it acts on the wrong body");
    pl_probe_require(p, approach < LEAST_SHARE * SPEED,
                     "two spheres that met at 2 m/s no longer approach each other",
                     pl_probe_text(p, "%g m/s", approach),
                     "the impulse draws the bodies together, or it is too small");
}

/* ---- What is reported ---- */

/* The reported impulses on one body and their torque about its centre, and what its motion shows,
 * summed over steps. */
typedef struct balance {
    pl_vec reported, needed;    /* N s */
    pl_vec torque, spin;        /* N m s */
    double size;                /* N s, of the impulses */
    double scale, torque_scale; /* sizes of all that is added up, for rounding */
    pl_vec normal;              /* of the last contact, on the body */
    double travel; /* m: the way of the body from the first to the last sub-step of a step */
} balance;

static void add_contact(balance *sum, const pl_contact *contact, int body, const double centre[3])
{
    const double sign = contact->body_b == body ? 1 : -1;
    const pl_vec impulse = pl_vec_of(contact->impulse);
    const pl_vec arm = pl_vec_sub(pl_vec_of(contact->point), pl_vec_of(centre));
    sum->reported = pl_vec_mad(sum->reported, sign, impulse);
    sum->torque = pl_vec_mad(sum->torque, sign, pl_vec_of(contact->torque));
    sum->torque = pl_vec_mad(sum->torque, sign, pl_vec_cross(arm, impulse));
    sum->normal = pl_vec_scale(pl_vec_of(contact->normal), sign);
    sum->size += pl_vec_length(impulse);
    sum->scale += pl_vec_length(impulse);
}

static pl_vec change_of(const double before[3], const double now[3])
{
    return pl_vec_sub(pl_vec_of(now), pl_vec_of(before));
}

/* Adds the last step of a body; `falling` is the one that falls freely, or -1 without gravity. */
static void add_step(pl_probe *p, int index, int falling, balance *sum)
{
    const pl_body *body = &p->scene.bodies[index];
    const pl_body_state *before = &p->before[index], *now = &p->now[index];
    pl_vec change = change_of(before->velocity, now->velocity);
    const pl_vec turn = change_of(before->angular_velocity, now->angular_velocity);
    if (falling >= 0) {
        const double *fall = p->now[falling].velocity;
        change = pl_vec_sub(change, change_of(p->before[falling].velocity, fall));
        sum->scale += body->mass * pl_vec_length(pl_vec_of(fall));
    }
    sum->needed = pl_vec_mad(sum->needed, body->mass, change);
    sum->spin = pl_vec_add(sum->spin, spin_momentum(body, (double[]){turn.x, turn.y, turn.z}));
    sum->scale += body->mass * pl_vec_length(pl_vec_of(now->velocity));
    sum->torque_scale += body->inertia[0] * pl_vec_length(pl_vec_of(now->angular_velocity));
    sum->travel =
        pl_vec_length(pl_vec_of(before->velocity)) * p->scene.dt * (1 - 1.0 / pl_probe_substeps(p));
    for (int i = 0; i < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[i]); ++i) {
        if (p->contacts[i].body_a == index || p->contacts[i].body_b == index) {
            add_contact(sum, &p->contacts[i], index, before->position);
        }
    }
}

/* Whether `found` is `expected` times a factor, to 2 %. */
static bool is_times(pl_vec found, pl_vec expected, double factor)
{
    return pl_vec_length(pl_vec_mad(found, -factor, expected)) <=
           0.02 * fabs(factor) * pl_vec_length(expected);
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
    const pl_vec normal = pl_vec_scale(sum->normal, pl_vec_dot(sum->needed, sum->normal));
    const pl_vec mirrored = pl_vec_sub(pl_vec_scale(normal, 2), sum->needed);
    const bool slides = !is_times(normal, sum->needed, 1);
    if (pl_vec_length(sum->needed) > 0.01 * sum->scale && pl_vec_length(sum->reported) == 0) {
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
    pl_probe_expect_vector(
        p, pl_probe_text(p, "the impulse of all contacts on %s, from its motion, N s", what),
        sum->reported, sum->needed, SHARE * sum->size + pl_probe_tolerance(p, 10 * sum->scale),
        cause_of(p, sum));
    if (rotates) {
        pl_probe_expect_vector(
            p,
            pl_probe_text(
                p, "the torque of all contacts on %s about its centre, from its motion, N m s",
                what),
            sum->torque, sum->spin,
            (0.01 * PL_BALL_RADIUS + sum->travel) * pl_vec_length(sum->needed) +
                pl_probe_tolerance(p, 10 * (sum->scale + sum->torque_scale)),
            "the points of contacts are not where the impulses act, or torques that act are not "
            "reported");
    }
}

/* ---- Motions ---- */

/* Adds a sphere that falls freely from far above, with the velocity of another one at the start, which
 * shows what gravity does in a step, and creates the scene. */
static int create_with_falling(pl_probe *p, pl_vec velocity)
{
    const int falling = pl_probe_add_ball(p, LIGHT, (pl_vec){0, 0, 40}, velocity);
    pl_probe_create(p);
    return falling;
}

/* Every step by itself; `falling` as for add_step. */
static void expect_steps(pl_probe *p, int body, int falling, int steps, const char *what)
{
    const bool rotates = p->scene.materials[0].friction > 0;
    for (int n = 0; n < steps && !p->over; ++n) {
        balance sum = {.size = 0};
        pl_probe_steps(p, 1);
        add_step(p, body, falling, &sum);
        expect_balance(p, &sum, what, rotates);
    }
}

/* The contacts of a sphere that rests are its weight times the time. */
static void check_weight(pl_probe *p)
{
    static const char *const what[] = {"a sphere that rests on a plane, the second body",
                                       "a sphere that rests on a plane, the first body"};
    for (int order = 0; order < 2 && !p->over; ++order) {
        balance sum = {.size = 0};
        begin(p, 0, 0, true);
        if (order == 0) {
            pl_probe_add_floor(p);
        }
        const int ball = pl_probe_add_ball(p, HEAVY, (pl_vec){0, 0, PL_BALL_RADIUS}, STILL);
        if (order == 1) {
            pl_probe_add_floor(p);
        }
        const int falling = create_with_falling(p, STILL);
        pl_probe_steps(p, 60);
        for (int n = 0; n < 60; ++n) {
            pl_probe_steps(p, 1);
            add_step(p, ball, falling, &sum);
        }
        expect_balance(p, &sum, what[order], false);
    }
}

static void check_impulse_friction(pl_probe *p)
{
    const pl_vec velocity = {1.5, -0.5, 0};
    begin(p, 0.5, 0, true);
    pl_probe_add_floor(p);
    const int ball = pl_probe_add_ball(p, HEAVY, (pl_vec){0, 0, PL_BALL_RADIUS}, velocity);
    spin(p, ball, (pl_vec){5, 8, 2});
    const int falling = create_with_falling(p, velocity);
    expect_steps(p, ball, falling, 60, "a sphere that slides on a plane");
}

/* Three bounces. Later ones last less than some steps, and engines differ in what they do then. */
static void check_impulse_bounce(pl_probe *p)
{
    const pl_vec velocity = {1, 0, -SPEED};
    begin(p, 0, 0.5, true);
    const int ball = pl_probe_add_ball(p, HEAVY, (pl_vec){0, 0, PL_BALL_RADIUS}, velocity);
    pl_probe_add_floor(p);
    const int falling = create_with_falling(p, velocity);
    expect_steps(p, ball, falling, 40, "a sphere that bounces off a plane");
}

/* An elastic box that bounces off a smaller one: all corners of the smaller top act together. */
static void check_impulse_box_bounce(pl_probe *p)
{
    begin(p, 0, 1, true);
    pl_probe_add_body(p, (pl_body){.is_static = true, .shape = pl_shape_box(0.2, 0.2, 0.2)});
    const int index = pl_probe_add_body(p, (pl_body){.shape = pl_shape_box(0.5, 0.4, 0.3),
                                                     .mass = HEAVY,
                                                     .position = {0, 0, 0.2 + 0.3 + 0.07},
                                                     .velocity = {0, 0, -SPEED}});
    const int falling = create_with_falling(p, (pl_vec){0, 0, -SPEED});
    expect_steps(p, index, falling, 40, "a box that bounces off a smaller one");
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
        expect_steps(p, cases[i].body, -1, 30, cases[i].what);
    }
}

/* All corners of a box that falls flat on a plane count. */
static void check_impulse_box(pl_probe *p)
{
    begin(p, 0, 0, true);
    pl_probe_add_floor(p);
    const int index = pl_probe_add_body(
        p,
        (pl_body){.shape = pl_shape_box(0.5, 0.4, 0.3), .mass = HEAVY, .position = {0, 0, 0.31}});
    const int falling = create_with_falling(p, STILL);
    expect_steps(p, index, falling, 60, "a box that falls on a plane");
}

enum {
    SMOOTH = PL_NEEDS_SPHERE | PL_NEEDS_PLANE,
    SLIDING = SMOOTH | PL_NEEDS_FRICTION | PL_NEEDS_ROTATION,
    REPORTED = PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES
};

const pl_check pl_impulse_checks[] = {
    {"momentum", "a collision with friction keeps both momenta",
     PL_NEEDS_SPHERE | PL_NEEDS_FRICTION | PL_NEEDS_ROTATION, 0, check_momentum, 0},
    {"contact-pushes", "contacts push bodies apart", PL_NEEDS_SPHERE, 0, check_push, 0},
    {"impulse-weight", "the impulses on a resting sphere are its weight", SMOOTH, REPORTED,
     check_weight, 0},
    {"impulse-friction", "the impulses on a sliding sphere are those of its motion", SLIDING,
     REPORTED, check_impulse_friction, 0},
    {"impulse-bounce", "the impulses on a bouncing sphere are those of its motion",
     SMOOTH | PL_NEEDS_RESTITUTION, REPORTED, check_impulse_bounce, 0},
    {"impulse-box", "the impulses on a box are those of its motion",
     SMOOTH | PL_NEEDS_BOX | PL_NEEDS_ROTATION, REPORTED, check_impulse_box, 0},
    {"impulse-box-bounce", "the impulses on a bouncing box are those of its motion",
     PL_NEEDS_BOX | PL_NEEDS_ROTATION | PL_NEEDS_RESTITUTION, REPORTED, check_impulse_box_bounce,
     0},
    {"impulse-pair", "the impulses of a collision are those of both motions", PL_NEEDS_SPHERE,
     REPORTED, check_impulse_pair, 0},
    {0}};
