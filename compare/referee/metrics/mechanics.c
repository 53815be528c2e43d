/* Energy and momentum, as the engine's integrator conserves them: energy_gain, energy_step_gain,
 * momentum_error and energy_lost.
 *
 * Let x be the centres of mass, E = sum of m v.v/2 + w.Iw/2 - m g.(x - x0), and r arms from x at
 * the start of the step. Substitution gives, exactly and for any h, with I constant over the step:
 *
 *   semi-implicit Euler, v' = v + h (g + F/m), x' = x + h v'
 *     energy    E + (h/2) m g.v grows by h F.(u + u')/2, u = v + w x r of the force's point
 *     momentum  p' - p = h (m g + F) + contact impulses
 *     angular   about the origin: x' x m v' = x x m v', so gravity, forces and contact impulses all
 *               count with their arms at the start: L' - L = h (x x m g + (x + r) x F) + q x J + K,
 *               where J and K are the impulse and the torque impulse of a contact at q
 *   a second-order integrator, x' = x + h (v + v')/2
 *     energy    E grows by h F.(u + u')/2
 *     angular   x' x m v' - x x m v = (x + x')/2 x m (v' - v): the arms move by (x' - x)/2 too
 *     A force in the body's frame turns within the step: its impulse, moment and work are integrals
 *     over the turn, here by Simpson's rule, and x' = x + h (v + v')/2 + h^2 (F - F')/(12 m).
 *
 *   semi-implicit Euler with n sub-steps of h / n
 *     energy    E + (h/2n) m g.v
 *     angular   the arms are at the start of each sub-step: they have moved by (n - 1)/(2n) of
 *               x' - x in the mean, which is exact under gravity alone. Which sub-steps a
 *               contact's impulse is of is not known, and so neither is its arm
 *
 * An engine may let impulses on a body act at another time of the step: an impact at its own time, or
 * at the start of a step that is of second order otherwise. Then x' = x + h (v + c (v' - v)) with
 * another c than 1 or 1/2, and the arms of gravity and contacts on that body move by (1 - c)(x' - x).
 * So c is fitted to each body's step.
 *
 * By the energy of the other integrator a falling body would seem to gain or lose m g^2 h t / 2.
 *
 * Rounding of an engine that declares floats. With c of pl_step_rounding, a step may change
 *
 *   energy    by c (m s^2 + m |g.x|' + 3 |w| |I w|), s = |v| + h |g|, |g.x|' = sum |g_k x_k|
 *   momentum  by c (m |v| + sum of |J| over gravity, forces and contacts)
 *   angular   by c (2 |x| m |v| + 3 |I w| + 2 sum of |q| |J|)
 *
 * because each number is off by c times its size: the velocities, which are sums of v and h g, the
 * positions from the origin of the world, and the orientation, which turns I w. These add up over
 * the steps, and are not charged.
 *
 * Source: the substitution of every proof that symplectic Euler conserves a modified energy
 * (Hairer, Lubich and Wanner 2006).
 */
#include "modules.h"
#include "referee/geometry/solid.h"

#include <string.h>

/* Of all dynamic bodies. */
typedef struct totals {
    double energy[PL_POSITION_RULE_COUNT];
    pl_vec momentum, angular;
} totals;

/* What rounding explains: J, N s, N m s. */
typedef struct rounding {
    double energy, momentum, angular;
} rounding;

/* Work and impulses from outside, and what rounding explains. */
typedef struct external {
    double work[PL_POSITION_RULE_COUNT];
    pl_vec momentum[PL_POSITION_RULE_COUNT], angular[PL_POSITION_RULE_COUNT];
    rounding blur;
    bool has_contact; /* with a static body */
} external;

/* How far the arms of impulses on a body move in a step, by each rule: share x moved, m. */
typedef struct arm_shift {
    pl_vec moved;
    double share[PL_POSITION_RULE_COUNT];
} arm_shift;

typedef struct moving_body {
    pl_vec origin;                         /* centre of mass at the start */
    double energy[PL_POSITION_RULE_COUNT]; /* of the last state */
    arm_shift arm;                         /* of a dynamic body, in the step */
    bool has_own_time; /* a contact acted on it at its own time; then this is the mean of x over */
    pl_vec mean_shift; /* the step less x before it */
} moving_body;

struct pl_mechanics {
    const pl_scene *scene;
    moving_body *bodies;                    /* (body_count) */
    double *growth[PL_POSITION_RULE_COUNT]; /* each (body_count): in the last step, without work */
    pl_vec *turned;                         /* (body_count): of the last step; see find_turned */
    totals first, last;
    external given; /* so far */
    pl_integrator_votes votes;
    external of_contacts; /* of the last step */
};

pl_mechanics *pl_mechanics_create(const pl_scene *scene, pl_arena *arena)
{
    size_t count = (size_t)scene->body_count;
    pl_mechanics *m = pl_arena_take(arena, 1, sizeof *m);
    m->scene = scene;
    m->bodies = pl_arena_take(arena, count, sizeof *m->bodies);
    m->turned = pl_arena_take(arena, count, sizeof *m->turned);
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        m->growth[k] = pl_arena_take(arena, count, sizeof *m->growth[k]);
    }
    return m;
}

static pl_vec centre_of(const pl_mechanics *m, const pl_body_state *bodies, int body)
{
    return pl_state_centre(&m->scene->bodies[body], &bodies[body]);
}

/* Sets a body's energy and adds the difference to its growth. */
static void set_energy(pl_mechanics *m, pl_position_rule integrator, int body, double energy)
{
    m->growth[integrator][body] += energy - m->bodies[body].energy[integrator];
    m->bodies[body].energy[integrator] = energy;
    m->last.energy[integrator] += energy;
}

/* Adds what rounding explains of one body in a step, apart from impulses. `spin_momentum` is |I w|.
 */
static void add_rounding(pl_mechanics *m, int index, const pl_body_state *state, pl_vec x,
                         double spin_momentum)
{
    const double c = pl_step_rounding(&m->votes.engine), mass = m->scene->bodies[index].mass;
    const double *g = m->scene->gravity;
    const double speed = pl_vec_length(pl_vec_of(state->velocity));
    const double reached = speed + m->scene->dt * pl_vec_length(pl_vec_of(g));
    const double potential = fabs(g[0] * x.x) + fabs(g[1] * x.y) + fabs(g[2] * x.z);
    const double spin = pl_vec_length(pl_vec_of(state->angular_velocity));
    const double energy = c * (mass * (reached * reached + potential) + 3 * spin * spin_momentum);
    m->given.blur.energy += energy;
    m->given.blur.momentum += c * mass * speed;
    m->given.blur.angular += c * (2 * pl_vec_length(x) * mass * speed + 3 * spin_momentum);
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        m->growth[k][index] -= energy;
    }
}

/* Measures `last` and every body's energy and growth. */
static void measure(pl_mechanics *m, const pl_body_state *bodies)
{
    pl_vec g = pl_vec_of(m->scene->gravity);
    const int substeps = pl_substeps_of(&m->votes.engine);
    m->last = (totals){.energy = {0}};
    for (int i = 0; i < m->scene->body_count; ++i) {
        const pl_body *body = &m->scene->bodies[i];
        if (body->is_static) {
            continue;
        }
        pl_vec x = centre_of(m, bodies, i), v = pl_vec_of(bodies[i].velocity);
        pl_vec w = pl_vec_of(bodies[i].angular_velocity);
        pl_axes axes = pl_principal_axes(&body->shape, bodies[i].orientation);
        pl_vec spin = pl_to_local(&axes, w);
        pl_vec angular =
            pl_to_world(&axes, (pl_vec){body->inertia[0] * spin.x, body->inertia[1] * spin.y,
                                        body->inertia[2] * spin.z});
        pl_vec momentum = pl_vec_scale(v, body->mass);
        double energy = body->mass * (pl_vec_dot(v, v) / 2 -
                                      pl_vec_dot(g, pl_vec_sub(x, m->bodies[i].origin))) +
                        pl_vec_dot(w, angular) / 2;
        set_energy(m, PL_SECOND_ORDER, i, energy);
        set_energy(m, PL_SEMI_IMPLICIT, i,
                   energy + m->scene->dt / (2 * substeps) * pl_vec_dot(g, momentum));
        add_rounding(m, i, &bodies[i], x, pl_vec_length(angular));
        m->last.momentum = pl_vec_add(m->last.momentum, momentum);
        m->last.angular =
            pl_vec_add(m->last.angular, pl_vec_add(pl_vec_cross(x, momentum), angular));
    }
}

/* Adds what rounding explains of an impulse. */
static void add_impulse_rounding(const pl_mechanics *m, pl_vec point, pl_vec impulse,
                                 rounding *blur)
{
    const double size = pl_step_rounding(&m->votes.engine) * pl_vec_length(impulse);
    blur->momentum += size;
    blur->angular += 2 * pl_vec_length(point) * size;
}

static void add_impulse(external *to, pl_position_rule k, pl_vec point, pl_vec impulse)
{
    to->momentum[k] = pl_vec_add(to->momentum[k], impulse);
    to->angular[k] = pl_vec_add(to->angular[k], pl_vec_cross(point, impulse));
}

/* The displacement of the body's centre in the step, m. */
static pl_vec displacement(const pl_mechanics *m, int body, const pl_step *step)
{
    return pl_vec_sub(centre_of(m, step->after, body), centre_of(m, step->before, body));
}

/* In units of a step's gravity and of the speed: by less a velocity does not change visibly. */
static const double UNCHANGED_BY_GRAVITY = 1e-3, UNCHANGED_SPEED = 1e-9;

/* The part of the body's displacement by which the arms of gravity and contacts on it move in the
 * step: 1 - c, where c in [0, 1] fits moved = h (v + c (v' - v)) best. Where v hardly changes it is
 * `usual`, that of the integrator. */
static double arm_share(const pl_mechanics *m, int body, const pl_step *step, pl_vec moved,
                        double usual)
{
    const double dt = m->scene->dt;
    const pl_vec v = pl_vec_of(step->before[body].velocity);
    const pl_vec change = pl_vec_sub(pl_vec_of(step->after[body].velocity), v);
    const pl_vec more = pl_vec_mad(moved, -dt, v);
    const double unclear = UNCHANGED_BY_GRAVITY * dt * pl_vec_length(pl_vec_of(m->scene->gravity)) +
                           UNCHANGED_SPEED * pl_vec_length(v);
    const double weight = unclear * unclear, size = weight + pl_vec_dot(change, change);
    const double c = (weight * (1 - usual) + pl_vec_dot(more, change) / dt) / size;
    return size > 0 ? 1 - fmin(fmax(c, 0), 1) : usual;
}

static arm_shift arm_shift_of(const pl_mechanics *m, int body, const pl_step *step)
{
    const double usual[PL_POSITION_RULE_COUNT] = {
        [PL_SEMI_IMPLICIT] = pl_later_share(&m->votes.engine), [PL_SECOND_ORDER] = 0.5};
    arm_shift arm = {.moved = displacement(m, body, step)};
    const pl_vec straight[PL_POSITION_RULE_COUNT] = {
        [PL_SEMI_IMPLICIT] = arm.moved, [PL_SECOND_ORDER] = pl_vec_sub(arm.moved, m->turned[body])};
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        arm.share[k] = arm_share(m, body, step, straight[k], usual[k]);
    }
    return arm;
}

/* Adds an impulse of gravity or of a static body. It acts on a body that is at `point` at the start of
 * the step, whose arm moves by `arm`; NULL: it acted at `point`. */
static void add_external(external *to, pl_vec point, const arm_shift *arm, pl_vec impulse,
                         pl_vec torque)
{
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        const pl_vec at = arm == NULL ? point : pl_vec_mad(point, arm->share[k], arm->moved);
        add_impulse(to, (pl_position_rule)k, at, impulse);
        to->angular[k] = pl_vec_add(to->angular[k], torque);
    }
}

static void add_sums(external *to, const external *sums)
{
    to->has_contact = to->has_contact || sums->has_contact;
    to->blur.momentum += sums->blur.momentum;
    to->blur.angular += sums->blur.angular;
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        to->momentum[k] = pl_vec_add(to->momentum[k], sums->momentum[k]);
        to->angular[k] = pl_vec_add(to->angular[k], sums->angular[k]);
    }
}

/* In units of the step: an interval shorter by less is the whole step. */
static const double WHOLE_STEP = 1e-9;

/* Whether the contact's point is where its impulse acted, and not where the bodies had it at the
 * start of the step. */
static bool is_at_own_time(const pl_contact_time *time, double dt)
{
    return time->end - time->begin < (1 - WHOLE_STEP) * dt;
}

/* Adds what an impulse, spread evenly over its interval, adds to the mean of x over the step. */
static void add_mean_shift(pl_mechanics *m, int body, const pl_contact_time *time, pl_vec impulse)
{
    const double dt = m->scene->dt, b = dt - time->begin, e = dt - time->end;
    const double share = (b * b + b * e + e * e) / (6 * dt); /* (b^3 - e^3) / (b - e) / (6 dt) */
    m->bodies[body].mean_shift =
        pl_vec_mad(m->bodies[body].mean_shift, share / m->scene->bodies[body].mass, impulse);
}

/* Finds the bodies with contacts at their own time, and the mean of their places over the step:
 * gravity acts all the time, whatever the time of an impact. */
static void find_mean_shifts(pl_mechanics *m, const pl_step *step)
{
    const double dt = m->scene->dt;
    const pl_vec fallen = pl_vec_scale(pl_vec_of(m->scene->gravity), dt * dt / 6);
    for (int i = 0; i < m->scene->body_count; ++i) {
        m->bodies[i].has_own_time = false;
        m->bodies[i].mean_shift = pl_vec_mad(fallen, 0.5 * dt, pl_vec_of(step->before[i].velocity));
    }
    for (int i = 0; i < step->contact_count && step->times != NULL; ++i) {
        const pl_contact *c = &step->contacts[i];
        const int bodies[2] = {c->body_a, c->body_b};
        for (int k = 0; k < 2; ++k) {
            if (is_at_own_time(&step->times[i], dt) && !m->scene->bodies[bodies[k]].is_static) {
                m->bodies[bodies[k]].has_own_time = true;
                add_mean_shift(m, bodies[k], &step->times[i],
                               pl_vec_scale(pl_vec_of(c->impulse), k == 0 ? -1 : 1));
            }
        }
    }
}

/* Finds the shift of each body's arms too, which its contacts use. */
static void add_gravity(pl_mechanics *m, const pl_step *step)
{
    external sums = {.has_contact = false};
    for (int i = 0; i < m->scene->body_count; ++i) {
        const pl_body *body = &m->scene->bodies[i];
        if (body->is_static) {
            continue;
        }
        const pl_vec impulse =
            pl_vec_scale(pl_vec_of(m->scene->gravity), body->mass * m->scene->dt);
        pl_vec point = centre_of(m, step->before, i);
        m->bodies[i].arm = arm_shift_of(m, i, step);
        if (m->bodies[i].has_own_time) {
            point = pl_vec_add(point, m->bodies[i].mean_shift);
        }
        add_external(&sums, point, m->bodies[i].has_own_time ? NULL : &m->bodies[i].arm, impulse,
                     (pl_vec){0, 0, 0});
        add_impulse_rounding(m, point, impulse, &sums.blur);
    }
    add_sums(&m->given, &sums);
}

/* Velocity of the point at `arm` at a node of the step. At the midpoint it is chosen so that
 * Simpson's rule gives the displacement of the centre. */
static pl_vec point_velocity(const pl_body_state *before, const pl_body_state *after, pl_vec moved,
                             double dt, int node, pl_vec arm)
{
    pl_vec v = pl_vec_of(before->velocity), w = pl_vec_of(before->angular_velocity);
    pl_vec end_v = pl_vec_of(after->velocity), end_w = pl_vec_of(after->angular_velocity);
    if (node == 1) {
        v = pl_vec_mad(pl_vec_scale(moved, 1.5 / dt), -0.25, pl_vec_add(v, end_v));
        w = pl_vec_scale(pl_vec_add(w, end_w), 0.5);
    } else if (node == 2) {
        v = end_v;
        w = end_w;
    }
    return pl_vec_add(v, pl_vec_cross(w, arm));
}

static void add_work(pl_mechanics *m, pl_position_rule k, int body, double work)
{
    m->given.work[k] += work;
    m->growth[k][body] -= work;
}

static void add_force(pl_mechanics *m, const pl_force *force, const pl_step *step)
{
    const pl_body_state *before = &step->before[force->body], *after = &step->after[force->body];
    double dt = m->scene->dt;
    pl_vec centre = centre_of(m, step->before, force->body);
    pl_vec moved = displacement(m, force->body, step);
    for (int i = 0; i < PL_NODES; ++i) {
        const pl_applied_force f = pl_applied_force_at(force, before, after, dt, i);
        pl_vec impulse = f.impulse;
        const pl_vec arm = f.arm;
        if (i == 0) {
            pl_vec twice = pl_vec_add(point_velocity(before, after, moved, dt, 0, arm),
                                      point_velocity(before, after, moved, dt, 2, arm));
            add_work(m, PL_SEMI_IMPLICIT, force->body, pl_vec_dot(impulse, twice) / 2);
            const pl_vec mean = pl_vec_mad(centre, pl_later_share(&m->votes.engine), moved);
            add_impulse_rounding(m, pl_vec_add(mean, arm), impulse, &m->given.blur);
            add_impulse(&m->given, PL_SEMI_IMPLICIT, pl_vec_add(mean, arm), impulse);
        }
        impulse = pl_vec_scale(impulse, pl_node_weights[i]);
        pl_vec velocity = point_velocity(before, after, moved, dt, i, arm);
        add_work(m, PL_SECOND_ORDER, force->body, pl_vec_dot(impulse, velocity));
        pl_vec point = pl_vec_add(pl_vec_mad(centre, pl_node_times[i], moved), arm);
        add_impulse(&m->given, PL_SECOND_ORDER, point, impulse);
    }
}

/* Impulses and torques between dynamic bodies cancel; those of static bodies are external. */
static external sums_of_contacts(const pl_mechanics *m, const pl_step *step)
{
    external sums = {.has_contact = false};
    for (int i = 0; i < step->contact_count; ++i) {
        const pl_contact *contact = &step->contacts[i];
        const bool a_static = m->scene->bodies[contact->body_a].is_static;
        const bool b_static = m->scene->bodies[contact->body_b].is_static;
        const double sign = a_static ? 1 : -1;
        const pl_vec point = pl_vec_of(contact->point);
        const pl_vec impulse = pl_vec_scale(pl_vec_of(contact->impulse), sign);
        add_impulse_rounding(m, point, impulse, &sums.blur);
        if (a_static != b_static) {
            const bool there = step->times != NULL && is_at_own_time(&step->times[i], m->scene->dt);
            const arm_shift *arm = &m->bodies[a_static ? contact->body_b : contact->body_a].arm;
            sums.has_contact = true;
            add_external(&sums, point, there ? NULL : arm, impulse,
                         pl_vec_scale(pl_vec_of(contact->torque), sign));
        }
    }
    return sums;
}

void pl_mechanics_start(pl_mechanics *m, const pl_body_state *bodies)
{
    for (int i = 0; i < m->scene->body_count; ++i) {
        m->bodies[i].origin = centre_of(m, bodies, i);
    }
    measure(m, bodies);
    m->first = m->last;
}

/* What forces that turn within the step add to the displacements of a second-order integrator:
 * h^2 (F - F') / (12 m), with F at the start and F' at the end, beyond h (v + v') / 2. */
static void find_turned(pl_mechanics *m, const pl_step *step)
{
    const double dt = m->scene->dt;
    memset(m->turned, 0, (size_t)m->scene->body_count * sizeof *m->turned);
    for (int i = 0; i < m->scene->force_count; ++i) {
        const pl_force *force = &m->scene->forces[i];
        const pl_body *body = &m->scene->bodies[force->body];
        if (!body->is_static && force->frame == PL_FRAME_BODY &&
            pl_applied_force_acts(force, step->number, dt)) {
            const pl_axes first = pl_axes_of(step->before[force->body].orientation);
            const pl_axes last = pl_axes_of(step->after[force->body].orientation);
            const pl_vec f = pl_vec_of(force->force);
            const pl_vec change = pl_vec_sub(pl_to_world(&first, f), pl_to_world(&last, f));
            pl_vec *turned = &m->turned[force->body];
            *turned = pl_vec_mad(*turned, dt * dt / (12 * body->mass), change);
        }
    }
}

void pl_mechanics_step(pl_mechanics *m, const pl_step *step)
{
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        memset(m->growth[k], 0, (size_t)m->scene->body_count * sizeof *m->growth[k]);
    }
    find_turned(m, step);
    pl_integrator_see(&m->votes, m->scene, step->before, step->after, m->turned);
    find_mean_shifts(m, step);
    add_gravity(m, step);
    for (int i = 0; i < m->scene->force_count; ++i) {
        const pl_force *force = &m->scene->forces[i];
        if (!m->scene->bodies[force->body].is_static &&
            pl_applied_force_acts(force, step->number, m->scene->dt)) {
            add_force(m, force, step);
        }
    }
    if (!step->repeats) {
        m->of_contacts = sums_of_contacts(m, step);
    }
    add_sums(&m->given, &m->of_contacts);
    measure(m, step->after);
}

pl_integrator_votes *pl_mechanics_votes(pl_mechanics *m)
{
    return &m->votes;
}

double pl_mechanics_energy_gain(const pl_mechanics *m, const pl_scale *scale,
                                pl_position_rule integrator)
{
    return (m->last.energy[integrator] - m->first.energy[integrator] - m->given.work[integrator]) /
           scale->energy;
}

static double unexplained(pl_vec last, pl_vec first, pl_vec given)
{
    return pl_vec_length(pl_vec_sub(pl_vec_sub(last, first), given));
}

double pl_mechanics_momentum_error(const pl_mechanics *m, const pl_scale *scale,
                                   pl_position_rule integrator)
{
    double linear =
        unexplained(m->last.momentum, m->first.momentum, m->given.momentum[integrator]) -
        m->given.blur.momentum;
    double angular = unexplained(m->last.angular, m->first.angular, m->given.angular[integrator]) -
                     m->given.blur.angular;
    const bool knows_arms = pl_substeps_of(&m->votes.engine) == 1 || !m->given.has_contact;
    const double error =
        fmax(linear / scale->momentum, knows_arms ? angular / scale->angular_momentum : 0);
    return isnan(linear + angular) ? (double)NAN : fmax(error, 0);
}

/* ---- The metrics ---- */

static void *create(const pl_run_view *view, pl_arena *arena)
{
    (void)arena;
    view->series[PL_METRIC_ENERGY_GAIN]->applies = true;
    view->series[PL_METRIC_ENERGY_STEP_GAIN]->applies = true;
    view->series[PL_METRIC_MOMENTUM_ERROR]->applies = true;
    return NULL;
}

/* The engine's integrator is detected only when something has accelerated. So each integrator has its
 * own series. */
static void see(void *state, const pl_run_view *view)
{
    (void)state;
    const pl_mechanics *m = view->mechanics;
    const pl_scale *scale = &view->scale;
    for (pl_position_rule k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        const double gain =
            pl_mechanics_energy_gain(m, scale, k) - m->given.blur.energy / scale->energy;
        const double error = pl_mechanics_momentum_error(m, scale, k);
        const double growth = pl_touching_island_max(view->touching, m->growth[k]);
        pl_see_value_by(view, PL_METRIC_ENERGY_GAIN, k, fmax(pl_or_infinity(gain), 0));
        pl_see_value_by(view, PL_METRIC_MOMENTUM_ERROR, k, pl_or_infinity(error));
        pl_see_value_by(view, PL_METRIC_ENERGY_STEP_GAIN, k, fmax(growth / scale->energy, 0));
    }
}

static void collect(void *state, const pl_run_view *view, pl_metric *item)
{
    (void)state;
    const double gain = pl_mechanics_energy_gain(view->mechanics, &view->scale, view->integrator);
    item[PL_METRIC_ENERGY_LOST] = pl_metric_value(-gain * view->scale.energy);
}

const pl_module pl_mechanics_module = {.create = create, .see = see, .collect = collect};
