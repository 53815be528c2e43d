/* Energy and momentum, as the engine's integrator conserves them.
 *
 * With x the centres of mass, E = sum of m v.v/2 + w.Iw/2 - m g.(x - x0) and arms r from x at the
 * start of the step, substitution gives, exactly and for any h, I held over the step:
 *
 *   semi-implicit Euler, v' = v + h (g + F/m), x' = x + h v'
 *     energy    E + (h/2) m g.v grows by h F.(u + u')/2, u = v + w x r of the force's point
 *     momentum  p' - p = h (m g + F) + contact impulses
 *     angular   about the origin: x' x m v' = x x m v', so gravity, forces and contact impulses all
 *               count with their arms at the start: L' - L = h (x x m g + (x + r) x F) + q x J
 *   a second-order rule, x' = x + h (v + v')/2
 *     energy    E grows by h F.(u + u')/2
 *     angular   x' x m v' - x x m v = (x + x')/2 x m (v' - v): the arms, too, move by (x' - x)/2
 *     A force in the body's frame turns within the step: its impulse, moment and work are integrals
 *     over the turn, here by Simpson's rule.
 *
 * Judged by the other rule's energy a falling body would seem to gain or lose m g^2 h t / 2.
 * By substitution, as in every proof that symplectic Euler keeps a modified energy (Hairer, Lubich
 * and Wanner 2006). */
#include "mechanics.h"

#include "loads.h"
#include "referee/geometry/solid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the bodies have. Both of energy and of `outside.angular` as one integrator or the other
 * keeps them. */
typedef struct totals {
    double energy[PL_INTEGRATOR_COUNT];
    pl_vec momentum, angular;
} totals;

/* Work and impulses from outside so far. */
typedef struct outside {
    double work[PL_INTEGRATOR_COUNT];
    pl_vec momentum[PL_INTEGRATOR_COUNT], angular[PL_INTEGRATOR_COUNT];
} outside;

struct pl_mechanics {
    const pl_scene *scene;
    pl_body_state *before;               /* (body_count): the state before the step */
    pl_vec *origin;                      /* (body_count): centres of mass at the start */
    double *energy[PL_INTEGRATOR_COUNT]; /* each (body_count): of the last state */
    double *growth[PL_INTEGRATOR_COUNT]; /* each (body_count): by the last step, without work */
    totals first, last;
    outside given;
    pl_integrator_votes votes;
};

pl_mechanics *pl_mechanics_create(const pl_scene *scene)
{
    size_t count = (size_t)scene->body_count + 1;
    pl_mechanics *m = calloc(1, sizeof *m);
    if (m == NULL) {
        return NULL;
    }
    m->scene = scene;
    m->before = calloc(count, sizeof *m->before);
    m->origin = calloc(count, sizeof *m->origin);
    bool complete = m->before != NULL && m->origin != NULL;
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        m->energy[k] = calloc(count, sizeof *m->energy[k]);
        m->growth[k] = calloc(count, sizeof *m->growth[k]);
        complete = complete && m->energy[k] != NULL && m->growth[k] != NULL;
    }
    if (!complete) {
        pl_mechanics_destroy(m);
        return NULL;
    }
    return m;
}

void pl_mechanics_destroy(pl_mechanics *m)
{
    if (m == NULL) {
        return;
    }
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        free(m->energy[k]);
        free(m->growth[k]);
    }
    free(m->before);
    free(m->origin);
    free(m);
}

/* Adds to the body's growth what its energy has grown by. */
static void set_energy(pl_mechanics *m, pl_integrator integrator, int body, double energy)
{
    m->growth[integrator][body] += energy - m->energy[integrator][body];
    m->energy[integrator][body] = energy;
    m->last.energy[integrator] += energy;
}

static pl_vec centre_of(const pl_mechanics *m, const pl_body_state *bodies, int body)
{
    return pl_centre_of_mass(&m->scene->bodies[body].shape, bodies[body].position,
                             bodies[body].orientation);
}

/* Measures `last` and every body's energy and growth. */
static void measure(pl_mechanics *m, const pl_body_state *bodies)
{
    pl_vec g = pl_vec_of(m->scene->gravity);
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
        pl_vec turning =
            pl_to_world(&axes, (pl_vec){body->inertia[0] * spin.x, body->inertia[1] * spin.y,
                                        body->inertia[2] * spin.z});
        pl_vec momentum = pl_vec_scale(v, body->mass);
        double energy =
            body->mass * (pl_vec_dot(v, v) / 2 - pl_vec_dot(g, pl_vec_sub(x, m->origin[i]))) +
            pl_vec_dot(w, turning) / 2;
        set_energy(m, PL_SECOND_ORDER, i, energy);
        set_energy(m, PL_SEMI_IMPLICIT, i, energy + m->scene->dt / 2 * pl_vec_dot(g, momentum));
        m->last.momentum = pl_vec_add(m->last.momentum, momentum);
        m->last.angular =
            pl_vec_add(m->last.angular, pl_vec_add(pl_vec_cross(x, momentum), turning));
    }
}

static void give(pl_mechanics *m, pl_integrator k, pl_vec point, pl_vec impulse)
{
    outside *given = &m->given;
    given->momentum[k] = pl_vec_add(given->momentum[k], impulse);
    given->angular[k] = pl_vec_add(given->angular[k], pl_vec_cross(point, impulse));
}

/* How far the body's centre has moved in the step. */
static pl_vec way_of(const pl_mechanics *m, int body, const pl_body_state *after)
{
    return pl_vec_sub(centre_of(m, after, body), centre_of(m, m->before, body));
}

/* An impulse from outside on a body, at a world point of the start of the step. */
static void give_both(pl_mechanics *m, int body, const pl_body_state *after, pl_vec point,
                      pl_vec impulse)
{
    give(m, PL_SEMI_IMPLICIT, point, impulse);
    give(m, PL_SECOND_ORDER, pl_vec_mad(point, 0.5, way_of(m, body, after)), impulse);
}

static void give_gravity(pl_mechanics *m, const pl_body_state *after)
{
    pl_vec g = pl_vec_of(m->scene->gravity);
    for (int i = 0; i < m->scene->body_count; ++i) {
        const pl_body *body = &m->scene->bodies[i];
        if (!body->is_static) {
            give_both(m, i, after, centre_of(m, m->before, i),
                      pl_vec_scale(g, body->mass * m->scene->dt));
        }
    }
}

/* Velocity of the point at the arm, at the start, the middle and the end of the step. In the middle
 * it is what makes Simpson's rule give the way that the centre made. */
static pl_vec point_velocity(const pl_body_state *before, const pl_body_state *after, pl_vec way,
                             double dt, int node, pl_vec arm)
{
    pl_vec v = pl_vec_of(before->velocity), w = pl_vec_of(before->angular_velocity);
    pl_vec end_v = pl_vec_of(after->velocity), end_w = pl_vec_of(after->angular_velocity);
    if (node == 1) {
        v = pl_vec_mad(pl_vec_scale(way, 1.5 / dt), -0.25, pl_vec_add(v, end_v));
        w = pl_vec_scale(pl_vec_add(w, end_w), 0.5);
    } else if (node == 2) {
        v = end_v;
        w = end_w;
    }
    return pl_vec_add(v, pl_vec_cross(w, arm));
}

static void add_work(pl_mechanics *m, pl_integrator k, int body, double work)
{
    m->given.work[k] += work;
    m->growth[k][body] -= work;
}

static void give_force(pl_mechanics *m, const pl_force *force, const pl_body_state *after)
{
    static const double times[PL_LOAD_NODES] = {0, 0.5, 1}; /* of the step */
    const pl_body_state *before = &m->before[force->body], *end = &after[force->body];
    double dt = m->scene->dt;
    pl_vec centre = centre_of(m, m->before, force->body), way = way_of(m, force->body, after);
    for (int i = 0; i < PL_LOAD_NODES; ++i) {
        pl_vec impulse = pl_vec_scale(pl_vec_of(force->force), dt);
        pl_vec arm = pl_vec_of(force->at);
        if (force->frame == PL_FRAME_BODY) {
            pl_axes axes = pl_load_axes(before, end, dt, i);
            impulse = pl_to_world(&axes, impulse);
            arm = pl_to_world(&axes, arm);
        }
        if (i == 0) {
            pl_vec twice = pl_vec_add(point_velocity(before, end, way, dt, 0, arm),
                                      point_velocity(before, end, way, dt, 2, arm));
            add_work(m, PL_SEMI_IMPLICIT, force->body, pl_vec_dot(impulse, twice) / 2);
            give(m, PL_SEMI_IMPLICIT, pl_vec_add(centre, arm), impulse);
        }
        impulse = pl_vec_scale(impulse, pl_load_weights[i]);
        pl_vec velocity = point_velocity(before, end, way, dt, i, arm);
        add_work(m, PL_SECOND_ORDER, force->body, pl_vec_dot(impulse, velocity));
        give(m, PL_SECOND_ORDER, pl_vec_add(pl_vec_mad(centre, times[i], way), arm), impulse);
    }
}

/* Contacts among dynamic bodies cancel; those with static bodies come from outside. */
static void give_contact(pl_mechanics *m, const pl_contact *contact, const pl_body_state *after)
{
    bool a_static = m->scene->bodies[contact->body_a].is_static;
    bool b_static = m->scene->bodies[contact->body_b].is_static;
    if (a_static != b_static) {
        give_both(m, a_static ? contact->body_b : contact->body_a, after, pl_vec_of(contact->point),
                  pl_vec_scale(pl_vec_of(contact->impulse), a_static ? 1 : -1));
    }
}

static void remember(pl_mechanics *m, const pl_body_state *bodies)
{
    memcpy(m->before, bodies, (size_t)m->scene->body_count * sizeof *bodies);
}

void pl_mechanics_start(pl_mechanics *m, const pl_body_state *bodies)
{
    for (int i = 0; i < m->scene->body_count; ++i) {
        m->origin[i] = centre_of(m, bodies, i);
    }
    measure(m, bodies);
    m->first = m->last;
    remember(m, bodies);
}

void pl_mechanics_step(pl_mechanics *m, long step, const pl_body_state *bodies,
                       const pl_contact *contacts, int contact_count)
{
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        memset(m->growth[k], 0, (size_t)m->scene->body_count * sizeof *m->growth[k]);
    }
    pl_integrator_see(&m->votes, m->scene, m->before, bodies);
    give_gravity(m, bodies);
    for (int i = 0; i < m->scene->force_count; ++i) {
        const pl_force *force = &m->scene->forces[i];
        if (!m->scene->bodies[force->body].is_static && pl_load_acts(force, step, m->scene->dt)) {
            give_force(m, force, bodies);
        }
    }
    for (int i = 0; i < contact_count; ++i) {
        give_contact(m, &contacts[i], bodies);
    }
    measure(m, bodies);
    remember(m, bodies);
}

pl_integrator pl_mechanics_integrator(const pl_mechanics *m)
{
    return pl_integrator_of(&m->votes);
}

const pl_integrator_votes *pl_mechanics_votes(const pl_mechanics *m)
{
    return &m->votes;
}

double pl_mechanics_energy_gain(const pl_mechanics *m, const pl_scale *scale,
                                pl_integrator integrator)
{
    return (m->last.energy[integrator] - m->first.energy[integrator] - m->given.work[integrator]) /
           scale->energy;
}

const double *pl_mechanics_growth(const pl_mechanics *m, pl_integrator integrator)
{
    return m->growth[integrator];
}

static double unexplained(pl_vec last, pl_vec first, pl_vec given)
{
    return pl_vec_length(pl_vec_sub(pl_vec_sub(last, first), given));
}

double pl_mechanics_momentum_error(const pl_mechanics *m, const pl_scale *scale,
                                   pl_integrator integrator)
{
    double linear = unexplained(m->last.momentum, m->first.momentum, m->given.momentum[integrator]);
    double angular = unexplained(m->last.angular, m->first.angular, m->given.angular[integrator]);
    return fmax(linear / scale->momentum, angular / scale->angular_momentum);
}
