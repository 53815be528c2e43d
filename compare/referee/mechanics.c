/* Energy and momentum, as semi-implicit Euler conserves them.
 *
 * That integrator, v' = v + h (g + F/m), x' = x + h v', is every engine's here. Substituting it
 * gives, exactly and for any h:
 *
 *   energy    E = sum of m v.v/2 + w.Iw/2 - m g.(x - x0) + (h/2) m g.v,   E' - E = h F.(u + u')/2,
 *             u the velocity of the force's point of application: v + w x r, with the arm r of the
 *             start of the step, and I held over the step
 *   momentum  p' - p = h (m g + F) + contact impulses
 *   angular   about the origin: x' x m v' = x x m v', so gravity, forces and contact impulses all
 *             count with their arms at the start: L' - L = h (x x m g + (x + r) x F) + q x J
 *
 * Without the term (h/2) m g.v a falling body would seem to gain or lose m g^2 h t / 2.
 * By substitution, as in every proof that symplectic Euler keeps a modified energy (Hairer, Lubich
 * and Wanner 2006). */
#include "referee/mechanics.h"

#include "plumb/vec.h"

#include <stdlib.h>
#include <string.h>

typedef struct totals {
    double energy;
    pl_vec momentum, angular;
} totals;

struct pl_mechanics {
    const pl_scene *scene;
    pl_body_state *before; /* (body_count): the state before the step */
    pl_vec *origin;        /* (body_count): positions at the start */
    totals first, last;
    totals given; /* work and impulses from outside so far */
};

pl_mechanics *pl_mechanics_create(const pl_scene *scene)
{
    pl_mechanics *m = calloc(1, sizeof *m);
    if (m == NULL) {
        return NULL;
    }
    m->scene = scene;
    m->before = calloc((size_t)scene->body_count + 1, sizeof *m->before);
    m->origin = calloc((size_t)scene->body_count + 1, sizeof *m->origin);
    if (m->before == NULL || m->origin == NULL) {
        pl_mechanics_destroy(m);
        return NULL;
    }
    return m;
}

void pl_mechanics_destroy(pl_mechanics *m)
{
    if (m != NULL) {
        free(m->before);
        free(m->origin);
        free(m);
    }
}

static totals measure(const pl_mechanics *m, const pl_body_state *bodies)
{
    totals sum = {0};
    pl_vec g = pl_vec_of(m->scene->gravity);
    for (int i = 0; i < m->scene->body_count; ++i) {
        const pl_body *body = &m->scene->bodies[i];
        if (body->is_static) {
            continue;
        }
        pl_vec x = pl_vec_of(bodies[i].position), v = pl_vec_of(bodies[i].velocity);
        pl_vec w = pl_vec_of(bodies[i].angular_velocity);
        pl_axes axes = pl_axes_of(bodies[i].orientation);
        pl_vec spin = pl_to_local(&axes, w);
        pl_vec turning =
            pl_to_world(&axes, (pl_vec){body->inertia[0] * spin.x, body->inertia[1] * spin.y,
                                        body->inertia[2] * spin.z});
        pl_vec fallen = pl_vec_mad(pl_vec_sub(x, m->origin[i]), -m->scene->dt / 2, v);
        pl_vec momentum = pl_vec_scale(v, body->mass);
        sum.energy += body->mass * (pl_vec_dot(v, v) / 2 - pl_vec_dot(g, fallen)) +
                      pl_vec_dot(w, turning) / 2;
        sum.momentum = pl_vec_add(sum.momentum, momentum);
        sum.angular = pl_vec_add(sum.angular, pl_vec_add(pl_vec_cross(x, momentum), turning));
    }
    return sum;
}

/* An impulse from outside at a world point. */
static void give(totals *given, pl_vec point, pl_vec impulse)
{
    given->momentum = pl_vec_add(given->momentum, impulse);
    given->angular = pl_vec_add(given->angular, pl_vec_cross(point, impulse));
}

static void give_gravity(pl_mechanics *m)
{
    pl_vec g = pl_vec_of(m->scene->gravity);
    for (int i = 0; i < m->scene->body_count; ++i) {
        const pl_body *body = &m->scene->bodies[i];
        if (!body->is_static) {
            give(&m->given, pl_vec_of(m->before[i].position),
                 pl_vec_scale(g, body->mass * m->scene->dt));
        }
    }
}

static pl_vec point_velocity(const pl_body_state *state, pl_vec arm)
{
    return pl_vec_add(pl_vec_of(state->velocity),
                      pl_vec_cross(pl_vec_of(state->angular_velocity), arm));
}

static void give_force(pl_mechanics *m, const pl_force *force, const pl_body_state *after)
{
    const pl_body_state *before = &m->before[force->body];
    pl_vec impulse = pl_vec_scale(pl_vec_of(force->force), m->scene->dt);
    pl_vec arm = pl_vec_of(force->at);
    if (force->frame == PL_FRAME_BODY) {
        pl_axes axes = pl_axes_of(before->orientation);
        impulse = pl_to_world(&axes, impulse);
        arm = pl_to_world(&axes, arm);
    }
    pl_vec twice = pl_vec_add(point_velocity(before, arm), point_velocity(after, arm));
    m->given.energy += pl_vec_dot(impulse, twice) / 2;
    give(&m->given, pl_vec_add(pl_vec_of(before->position), arm), impulse);
}

/* Contacts among dynamic bodies cancel; those with static bodies come from outside. */
static void give_contact(pl_mechanics *m, const pl_contact *contact)
{
    bool a_static = m->scene->bodies[contact->body_a].is_static;
    bool b_static = m->scene->bodies[contact->body_b].is_static;
    if (a_static != b_static) {
        give(&m->given, pl_vec_of(contact->point),
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
        m->origin[i] = pl_vec_of(bodies[i].position);
    }
    m->first = m->last = measure(m, bodies);
    remember(m, bodies);
}

void pl_mechanics_step(pl_mechanics *m, long step, const pl_body_state *bodies,
                       const pl_contact *contacts, int contact_count)
{
    double dt = m->scene->dt;
    /* Times of start and end are met to a millionth of a step, whatever way they were rounded. */
    double time = (double)(step - 1) * dt + 1e-6 * dt;
    give_gravity(m);
    for (int i = 0; i < m->scene->force_count; ++i) {
        const pl_force *force = &m->scene->forces[i];
        if (!m->scene->bodies[force->body].is_static && time >= force->from &&
            time < force->until) {
            give_force(m, force, &bodies[force->body]);
        }
    }
    for (int i = 0; i < contact_count; ++i) {
        give_contact(m, &contacts[i]);
    }
    m->last = measure(m, bodies);
    remember(m, bodies);
}

double pl_mechanics_energy_gain(const pl_mechanics *m, const pl_scale *scale)
{
    return (m->last.energy - m->first.energy - m->given.energy) / scale->energy;
}

static double unexplained(pl_vec last, pl_vec first, pl_vec given)
{
    return pl_vec_length(pl_vec_sub(pl_vec_sub(last, first), given));
}

double pl_mechanics_momentum_error(const pl_mechanics *m, const pl_scale *scale)
{
    double linear = unexplained(m->last.momentum, m->first.momentum, m->given.momentum);
    double angular = unexplained(m->last.angular, m->first.angular, m->given.angular);
    return fmax(linear / scale->momentum, angular / scale->angular_momentum);
}
