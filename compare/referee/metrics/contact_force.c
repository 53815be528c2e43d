/* For a contact with impulse r on B, normal n from A to B, and u the velocity of B's point against
 * A's after the step; h is the step, g gravity:
 *
 *   force_balance       |sum r + h m g + sum h F - m (v' - v)| / (h m |g|) of each body
 *   cone_violation      (|r_t| - mu r_n)+ / (mu r_n)
 *   friction_effective  |r_t| / r_n where it slides
 *   signorini           |r_n u_n| / h
 *   natural_map         |r - P_K(r - rho (u + mu |u_t| n))| / rho,  K = {|r_t| <= mu r_n}
 *
 * (the law of contact in the form of De Saxce and Feng 1998). Arms lead from the centres of mass
 * before the step, where engines find their contacts, to the reported points. With W the operator
 * that takes r to the change of u if both bodies were free, 1/rho = tr W / 3. A contact that was
 * open by a gap counts it in u_n as gap / h: until it is closed no force is due (Stewart and
 * Trinkle 1996). A bounce leaves with r_n and u_n both above 0, as it should, so that the last two
 * leave out pairs with restitution. */
#include "contact_force.h"

#include "loads.h"
#include "referee/geometry/solid.h"
#include "series.h"

#include <stdlib.h>
#include <string.h>

/* Of the weight of the lighter body: contacts that carry less say nothing of friction. */
static const double LIGHT = 1e-3;

typedef enum series_id {
    OF_BALANCE, /* one for each integrator */
    OF_CONE = OF_BALANCE + PL_INTEGRATOR_COUNT,
    OF_FRICTION,
    OF_SIGNORINI,
    OF_NATURAL_MAP,
    SERIES_COUNT
} series_id;

struct pl_contact_force {
    const pl_scene *scene;
    pl_body_state *before;               /* (body_count): the state before the step */
    pl_vec *excess[PL_INTEGRATOR_COUNT]; /* each (body_count): impulses less what they did, N s */
    pl_series series[SERIES_COUNT];
    bool unreported; /* in some step */
};

/* One contact with all that the metrics take of it; impulses in N s, velocities in m/s. */
typedef struct touch {
    double friction, restitution;
    double normal_impulse, normal_velocity;
    pl_vec tangent_impulse, tangent_velocity;
    double inverse_mass; /* 1/rho, 1/kg */
    double weight;       /* of the lighter body, over the step: N s */
} touch;

/* Largest over the contacts of a step; below 0: of none. */
typedef struct worst {
    double cone, signorini, natural_map;
} worst;

pl_contact_force *pl_contact_force_create(const pl_scene *scene)
{
    size_t count = (size_t)scene->body_count + 1;
    pl_contact_force *f = calloc(1, sizeof *f);
    if (f == NULL) {
        return NULL;
    }
    f->scene = scene;
    f->before = calloc(count, sizeof *f->before);
    bool complete = f->before != NULL;
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        f->excess[k] = calloc(count, sizeof *f->excess[k]);
        complete = complete && f->excess[k] != NULL;
    }
    for (int i = 0; i < SERIES_COUNT; ++i) {
        complete = pl_series_init(&f->series[i]) && complete;
    }
    if (!complete) {
        pl_contact_force_destroy(f);
        return NULL;
    }
    return f;
}

void pl_contact_force_destroy(pl_contact_force *f)
{
    if (f == NULL) {
        return;
    }
    for (int i = 0; i < SERIES_COUNT; ++i) {
        pl_series_free(&f->series[i]);
    }
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        free(f->excess[k]);
    }
    free(f->before);
    free(f);
}

static void remember(pl_contact_force *f, const pl_body_state *bodies)
{
    memcpy(f->before, bodies, (size_t)f->scene->body_count * sizeof *bodies);
}

void pl_contact_force_start(pl_contact_force *f, const pl_body_state *bodies)
{
    remember(f, bodies);
}

static double gravity_of(const pl_scene *scene)
{
    return pl_vec_length(pl_vec_of(scene->gravity));
}

/* A NaN of the engine's must not pass for nothing. */
static double larger(double a, double b)
{
    return isnan(b) ? HUGE_VAL : fmax(a, b);
}

/* ---- The balance of each body */

static void give(pl_contact_force *f, int body, double sign, pl_vec impulse)
{
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        f->excess[k][body] = pl_vec_mad(f->excess[k][body], sign, impulse);
    }
}

static void give_loads(pl_contact_force *f, long step, const pl_body_state *after)
{
    double dt = f->scene->dt;
    for (int i = 0; i < f->scene->force_count; ++i) {
        const pl_force *force = &f->scene->forces[i];
        for (int k = 0; k < PL_INTEGRATOR_COUNT && pl_load_acts(force, step, dt); ++k) {
            pl_vec impulse = pl_load_impulse(force, (pl_integrator)k, &f->before[force->body],
                                             &after[force->body], dt);
            f->excess[k][force->body] = pl_vec_add(f->excess[k][force->body], impulse);
        }
    }
}

static void see_balance(pl_contact_force *f, long step, const pl_body_state *after,
                        const pl_contact *contacts, int contact_count)
{
    const pl_scene *scene = f->scene;
    double fall = scene->dt * gravity_of(scene);
    if (fall == 0) {
        return;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        pl_vec change = pl_vec_sub(pl_vec_of(after[i].velocity), pl_vec_of(f->before[i].velocity));
        pl_vec due = pl_vec_mad(change, -scene->dt, pl_vec_of(scene->gravity));
        for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
            f->excess[k][i] = pl_vec_scale(due, -scene->bodies[i].mass);
        }
    }
    for (int i = 0; i < contact_count; ++i) {
        pl_vec impulse = pl_vec_of(contacts[i].impulse);
        give(f, contacts[i].body_a, -1, impulse);
        give(f, contacts[i].body_b, 1, impulse);
    }
    give_loads(f, step, after);
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        double largest = -1;
        for (int i = 0; i < scene->body_count; ++i) {
            if (!scene->bodies[i].is_static) {
                double excess = pl_vec_length(f->excess[k][i]);
                largest = larger(largest, excess / (scene->bodies[i].mass * fall));
            }
        }
        if (largest >= 0) {
            pl_series_add(&f->series[OF_BALANCE + k], largest, step);
        }
    }
}

/* ---- The law of each contact */

/* Adds one body's part in a contact; `side` is 1 for B and -1 for A. */
static void add_side(const pl_contact_force *f, int index, double side, const pl_contact *contact,
                     const pl_body_state *after, pl_vec *velocity, touch *t)
{
    const pl_body *body = &f->scene->bodies[index];
    if (body->is_static) {
        return;
    }
    const pl_body_state *before = &f->before[index];
    pl_vec centre = pl_centre_of_mass(&body->shape, before->position, before->orientation);
    pl_vec arm = pl_vec_sub(pl_vec_of(contact->point), centre);
    pl_vec turning = pl_vec_cross(pl_vec_of(after[index].angular_velocity), arm);
    pl_vec own = pl_vec_add(pl_vec_of(after[index].velocity), turning);
    *velocity = pl_vec_mad(*velocity, side, own);
    pl_axes axes = pl_principal_axes(&body->shape, before->orientation);
    t->inverse_mass += 1 / body->mass;
    for (int k = 0; k < 3; ++k) {
        pl_vec lever = pl_vec_cross(axes.axis[k], arm);
        t->inverse_mass += pl_vec_dot(lever, lever) / (3 * body->inertia[k]);
    }
    t->weight = fmin(t->weight, body->mass * gravity_of(f->scene) * f->scene->dt);
}

static touch touch_of(const pl_contact_force *f, const pl_contact *contact,
                      const pl_body_state *after)
{
    const pl_scene *scene = f->scene;
    touch t = {.weight = HUGE_VAL};
    pl_scene_pair(scene, scene->bodies[contact->body_a].material,
                  scene->bodies[contact->body_b].material, &t.friction, &t.restitution);
    pl_vec velocity = {0, 0, 0};
    add_side(f, contact->body_a, -1, contact, after, &velocity, &t);
    add_side(f, contact->body_b, 1, contact, after, &velocity, &t);
    pl_vec n = pl_vec_of(contact->normal), r = pl_vec_of(contact->impulse);
    t.normal_impulse = pl_vec_dot(r, n);
    t.tangent_impulse = pl_vec_reject(r, n);
    t.normal_velocity = pl_vec_dot(velocity, n) + fmax(contact->separation, 0) / scene->dt;
    t.tangent_velocity = pl_vec_reject(velocity, n);
    return t;
}

/* Of r - rho (u + mu |u_t| n) to its projection on the cone, less r; over rho. */
static double natural_map(const touch *t)
{
    double mu = t->friction, rho = 1 / t->inverse_mass;
    double lifted = t->normal_velocity + mu * pl_vec_length(t->tangent_velocity);
    double normal = t->normal_impulse - rho * lifted;
    pl_vec tangent = pl_vec_mad(t->tangent_impulse, -rho, t->tangent_velocity);
    double along = pl_vec_length(tangent);
    if (mu * along <= -normal) {
        normal = 0;
        tangent = (pl_vec){0, 0, 0};
    } else if (along > mu * normal) {
        double on_cone = (normal + mu * along) / (1 + mu * mu);
        normal = on_cone;
        tangent = pl_vec_scale(tangent, mu * on_cone / along);
    }
    pl_vec apart = pl_vec_sub(t->tangent_impulse, tangent);
    double off = t->normal_impulse - normal;
    return sqrt(off * off + pl_vec_dot(apart, apart)) / rho;
}

/* Friction of what bears a load in a scene with gravity. */
static void see_friction(pl_contact_force *f, long step, const touch *t, worst *most)
{
    double carried = t->normal_impulse, rubbed = pl_vec_length(t->tangent_impulse);
    if (!(t->friction > 0 && t->weight > 0 && carried > LIGHT * t->weight)) {
        return;
    }
    double held = t->friction * carried;
    most->cone = larger(most->cone, fmax(rubbed - held, 0) / held);
    /* A contact that holds may creep, by no more than gravity gives in the step where its friction
     * was not solved at all. */
    if (pl_vec_length(t->tangent_velocity) > f->scene->dt * gravity_of(f->scene)) {
        pl_series_add(&f->series[OF_FRICTION], rubbed / carried, step);
    }
}

static void see_contact(pl_contact_force *f, long step, const pl_contact *contact,
                        const pl_body_state *after, worst *most)
{
    const touch t = touch_of(f, contact, after);
    if (!(t.inverse_mass > 0)) {
        return; /* both are static */
    }
    see_friction(f, step, &t, most);
    if (t.restitution == 0) {
        double power = fabs(t.normal_impulse * t.normal_velocity) / f->scene->dt;
        most->signorini = larger(most->signorini, power);
        most->natural_map = larger(most->natural_map, natural_map(&t));
    }
}

static void add_worst(pl_contact_force *f, series_id id, double value, long step)
{
    if (value >= 0) {
        pl_series_add(&f->series[id], value, step);
    }
}

void pl_contact_force_step(pl_contact_force *f, long step, const pl_body_state *bodies,
                           const pl_contact *contacts, int contact_count)
{
    f->unreported = f->unreported || contact_count < 0;
    if (!f->unreported) {
        worst most = {-1, -1, -1};
        see_balance(f, step, bodies, contacts, contact_count);
        for (int i = 0; i < contact_count; ++i) {
            see_contact(f, step, &contacts[i], bodies, &most);
        }
        add_worst(f, OF_CONE, most.cone, step);
        add_worst(f, OF_SIGNORINI, most.signorini, step);
        add_worst(f, OF_NATURAL_MAP, most.natural_map, step);
    }
    remember(f, bodies);
}

/* ---- What is found */

static pl_metric metric_of(const pl_contact_force *f, const pl_series *series, double value)
{
    bool applies = !f->unreported && series->count > 0;
    return applies ? pl_series_metric(series, value) : (pl_metric){0};
}

void pl_contact_force_metrics(const pl_contact_force *f, pl_integrator integrator, pl_metric *item)
{
    const pl_series *s = f->series, *balance = &s[OF_BALANCE + (int)integrator];
    item[PL_METRIC_FORCE_BALANCE] = metric_of(f, balance, balance->max);
    item[PL_METRIC_CONE_VIOLATION] = metric_of(f, &s[OF_CONE], s[OF_CONE].max);
    item[PL_METRIC_FRICTION_EFFECTIVE] =
        metric_of(f, &s[OF_FRICTION], pl_series_mean(&s[OF_FRICTION]));
    item[PL_METRIC_SIGNORINI] = metric_of(f, &s[OF_SIGNORINI], s[OF_SIGNORINI].max);
    item[PL_METRIC_NATURAL_MAP] = metric_of(f, &s[OF_NATURAL_MAP], s[OF_NATURAL_MAP].max);
}

pl_vec pl_contact_force_between(const pl_contact *contacts, int count, int a, int b, double dt)
{
    pl_vec sum = {0, 0, 0};
    for (int i = 0; i < count; ++i) {
        const pl_contact *c = &contacts[i];
        if ((c->body_a == a && c->body_b == b) || (c->body_a == b && c->body_b == a)) {
            sum = pl_vec_mad(sum, (c->body_b == b ? 1 : -1) / dt, pl_vec_of(c->impulse));
        }
    }
    return sum;
}
