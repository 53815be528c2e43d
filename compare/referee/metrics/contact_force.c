/* For a contact with impulse r on body B, normal n from A to B, and u the velocity of B's point
 * relative to A's after the step; h is the step, g gravity, F the scene's forces:
 *
 *   force_balance       |sum r + h m g + sum h F - m (v' - v)| / (h m |g|) of each body
 *   cone_violation      max(0, |r_t| - mu r_n) / (mu r_n)
 *   friction_effective  |r_t| / r_n where the contact slides
 *   signorini           |r_n u_n| / h
 *   natural_map         |r - P_K(r - rho (u + mu |u_t| n))| / rho,  K = {|r_t| <= mu r_n}
 *
 * The law of contact has the form of De Saxce and Feng 1998. Arms lead from the centres of mass
 * before the step, where engines find their contacts, to the reported points. With W the operator
 * from r to the change of u if both bodies were free, 1/rho = tr W / 3. If a contact was open by a
 * gap, gap / h is added to u_n: no force is due until the gap is closed (Stewart and Trinkle 1996).
 * Where an engine says when its contacts acted, u is the velocity that each left then, at the arms
 * that it states (contact_motion.h), and h the length of its interval.
 * A correct bounce has r_n > 0 and u_n > 0, so the last two metrics leave out pairs with
 * restitution. */
#include "contact_motion.h"
#include "modules.h"
#include "referee/geometry/solid.h"
#include "series.h"

/* In units of the lighter body's weight: friction is not measured at contacts that bear less. */
static const double LIGHT = 1e-3;

typedef enum series_id {
    OF_BALANCE, /* one for each integrator */
    OF_CONE = OF_BALANCE + PL_POSITION_RULE_COUNT,
    OF_FRICTION,
    OF_SIGNORINI,
    OF_NATURAL_MAP,
    SERIES_COUNT
} series_id;

/* Largest over the contacts of a step; below 0 if no contact has one. */
typedef struct worst {
    double cone, signorini, natural_map;
} worst;

typedef struct contact_force {
    const pl_scene *scene;
    pl_contact_motion *motion;
    pl_arena *arena;
    double gravity;                         /* m/s^2 */
    pl_vec *excess[PL_POSITION_RULE_COUNT]; /* each (body_count): impulses less their effect, N s */
    pl_axes *axes;                          /* (body_count): principal, before the step */
    double *slides; /* (capacity): friction_effective of a contact; NAN: it does not slide */
    worst *most;    /* (capacity / PIECE + 1): of the contacts of a piece */
    int capacity;   /* contacts */
    pl_series series[SERIES_COUNT];
    bool unreported; /* in some step the engine reported no contacts */
} contact_force;

enum { PIECE = 512 /* bodies, or contacts, that are judged together */ };

/* Room to begin with. */
enum { CONTACTS_PER_BODY = 8, LEAST_CONTACTS = 64 };

/* One contact with all that the metrics need of it; impulses in N s, velocities in m/s. */
typedef struct touch {
    double friction, restitution;
    double normal_impulse, normal_velocity;
    pl_vec tangent_impulse, tangent_velocity;
    bool has_mean_slip;
    pl_vec mean_slip;    /* the mean of both ends of the interval, where friction may act by it */
    double inverse_mass; /* 1/rho, 1/kg */
    double weight;       /* of the lighter body, times the step: N s */
} touch;

/* The memory of smaller arrays is the arena's until its end. */
static void reserve(contact_force *f, int count)
{
    if (count <= f->capacity) {
        return;
    }
    f->capacity = 2 * f->capacity > count ? 2 * f->capacity : count;
    f->slides = pl_arena_take(f->arena, (size_t)f->capacity, sizeof *f->slides);
    f->most = pl_arena_take(f->arena, (size_t)f->capacity / PIECE + 1, sizeof *f->most);
}

static void *create(const pl_scene *scene, pl_arena *arena)
{
    contact_force *f = pl_arena_take(arena, 1, sizeof *f);
    f->scene = scene;
    f->arena = arena;
    f->gravity = pl_vec_length(pl_vec_of(scene->gravity));
    f->axes = pl_arena_take(arena, (size_t)scene->body_count, sizeof *f->axes);
    f->motion = pl_contact_motion_create(scene, arena);
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        f->excess[k] = pl_arena_take(arena, (size_t)scene->body_count, sizeof *f->excess[k]);
    }
    for (int i = 0; i < SERIES_COUNT; ++i) {
        pl_series_init(&f->series[i], arena);
    }
    reserve(f, LEAST_CONTACTS + CONTACTS_PER_BODY * scene->body_count);
    return f;
}

/* The larger of both; a NaN in `b` counts as infinite, so that it is not lost. */
static double larger(double a, double b)
{
    return isnan(b) ? HUGE_VAL : fmax(a, b);
}

/* ---- The balance of each body ---- */

static void add_applied_forces(contact_force *f, const pl_step *step)
{
    double dt = f->scene->dt;
    for (int i = 0; i < f->scene->force_count; ++i) {
        const pl_force *force = &f->scene->forces[i];
        for (int k = 0;
             k < PL_POSITION_RULE_COUNT && pl_applied_force_acts(force, step->number, dt); ++k) {
            pl_vec impulse =
                pl_applied_force_impulse(force, (pl_position_rule)k, &step->before[force->body],
                                         &step->after[force->body], dt);
            f->excess[k][force->body] = pl_vec_add(f->excess[k][force->body], impulse);
        }
    }
}

/* Finds the impulses on a body by gravity and contacts, less their effect. */
static pl_vec excess_of(const contact_force *f, const pl_step *step, int body)
{
    const pl_vec change =
        pl_vec_sub(pl_vec_of(step->after[body].velocity), pl_vec_of(step->before[body].velocity));
    const pl_vec due = pl_vec_mad(change, -f->scene->dt, pl_vec_of(f->scene->gravity));
    return pl_contact_motion_add_impulses(f->motion, step, body,
                                          pl_vec_scale(due, -f->scene->bodies[body].mass));
}

/* A step on its way to its worst values. */
typedef struct judging {
    contact_force *force;
    const pl_step *step;
} judging;

static void see_bodies(void *context, int begin, int end)
{
    const judging *j = context;
    const contact_force *f = j->force;
    for (int i = begin; i < end; ++i) {
        const pl_body *body = &f->scene->bodies[i];
        if (!body->is_static) {
            f->axes[i] = pl_principal_axes(&body->shape, j->step->before[i].orientation);
            f->excess[0][i] = excess_of(f, j->step, i);
            for (int k = 1; k < PL_POSITION_RULE_COUNT; ++k) {
                f->excess[k][i] = f->excess[0][i];
            }
        }
    }
}

static void see_balance(contact_force *f, const pl_step *step)
{
    const pl_scene *scene = f->scene;
    double fall = scene->dt * f->gravity;
    if (fall == 0) {
        return;
    }
    add_applied_forces(f, step);
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        double largest = -1;
        for (int i = 0; i < scene->body_count; ++i) {
            if (!scene->bodies[i].is_static) {
                double excess = pl_vec_length(f->excess[k][i]);
                largest = larger(largest, excess / (scene->bodies[i].mass * fall));
            }
        }
        if (largest >= 0) {
            pl_series_add(&f->series[OF_BALANCE + k], largest, step->number);
        }
    }
}

/* ---- The law of each contact ---- */

/* From the body's centre of mass to the contact's point, m, both at the start of the step. */
static pl_vec arm_of(const pl_scene *scene, int body, const pl_contact *contact,
                     const pl_step *step)
{
    return pl_vec_sub(pl_vec_of(contact->point),
                      pl_state_centre(&scene->bodies[body], &step->before[body]));
}

/* The velocity of the body's point after the step, m/s. */
static pl_vec point_velocity(const pl_scene *scene, int index, const pl_contact *contact,
                             const pl_step *step)
{
    const pl_body_state *after = &step->after[index];
    if (scene->bodies[index].is_static) {
        return (pl_vec){0, 0, 0};
    }
    pl_vec turning =
        pl_vec_cross(pl_vec_of(after->angular_velocity), arm_of(scene, index, contact, step));
    return pl_vec_add(pl_vec_of(after->velocity), turning);
}

/* Adds one body's part in a contact at `arm` to `t`. */
static void add_side(const contact_force *f, int index, pl_vec arm, touch *t)
{
    const pl_body *body = &f->scene->bodies[index];
    if (body->is_static) {
        return;
    }
    t->inverse_mass += 1 / body->mass;
    for (int k = 0; k < 3; ++k) {
        pl_vec lever = pl_vec_cross(f->axes[index].axis[k], arm);
        t->inverse_mass += pl_vec_dot(lever, lever) / (3 * body->inertia[k]);
    }
    t->weight = fmin(t->weight, body->mass * f->gravity * f->scene->dt);
}

/* Whether the impulse acted at the middle of its interval. */
static bool acts_at_middle(const pl_contact_time *time)
{
    if (time == NULL) {
        return false;
    }
    const pl_contact_place *acts = &time->acts, *holds = &time->holds;
    bool differ = false;
    for (int k = 0; k < 3; ++k) {
        differ |= acts->arm_a[k] != holds->arm_a[k] || acts->arm_b[k] != holds->arm_b[k] ||
                  acts->normal[k] != holds->normal[k];
    }
    return differ;
}

/* Contact i of the step. */
static touch touch_of(const contact_force *f, int i, const pl_contact_velocity *velocity,
                      const pl_step *step)
{
    const pl_scene *scene = f->scene;
    const pl_contact *contact = &step->contacts[i];
    const pl_contact_time *time = step->times != NULL ? &step->times[i] : NULL;
    const int a = contact->body_a, b = contact->body_b;
    touch t = {.weight = HUGE_VAL};
    pl_scene_pair(scene, scene->bodies[a].material, scene->bodies[b].material, &t.friction,
                  &t.restitution);
    add_side(f, a, time != NULL ? pl_vec_of(time->acts.arm_a) : arm_of(scene, a, contact, step),
             &t);
    add_side(f, b, time != NULL ? pl_vec_of(time->acts.arm_b) : arm_of(scene, b, contact, step),
             &t);
    const pl_vec n = pl_vec_of(time != NULL ? time->acts.normal : contact->normal);
    const pl_vec at_end = pl_vec_of(time != NULL ? time->holds.normal : contact->normal);
    const double dt = time != NULL ? time->end - time->begin : scene->dt;
    const pl_vec r = pl_vec_of(contact->impulse);
    t.normal_impulse = pl_vec_dot(r, n);
    t.tangent_impulse = pl_vec_reject(r, n);
    t.normal_velocity = pl_vec_dot(velocity->left, at_end);
    /* A gap closes over an interval, not in the instant of an impact. */
    t.normal_velocity += dt > 0 ? fmax(contact->separation, 0) / dt : 0;
    t.tangent_velocity = pl_vec_reject(pl_vec_reject(velocity->left, at_end), n);
    t.has_mean_slip = acts_at_middle(time);
    t.mean_slip = pl_vec_reject(velocity->mean, n);
    return t;
}

/* |r - P_K(r - rho (u + mu |u_t| n))| / rho, m/s, at the slip u_t. */
static double natural_map_at(const touch *t, pl_vec slip)
{
    double mu = t->friction, rho = 1 / t->inverse_mass;
    double opening = t->normal_velocity + mu * pl_vec_length(slip);
    double normal = t->normal_impulse - rho * opening;
    pl_vec tangent = pl_vec_mad(t->tangent_impulse, -rho, slip);
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

/* Friction opposes the slip at the end of the interval or, of a contact that acts at its middle, the
 * mean slip: the one is due where the slip stops, the other where it goes on. */
static double natural_map(const touch *t)
{
    const double at_end = natural_map_at(t, t->tangent_velocity);
    return t->has_mean_slip ? fmin(at_end, natural_map_at(t, t->mean_slip)) : at_end;
}

/* Friction of a contact that bears a load, in a scene with gravity. Returns its ratio to the normal
 * impulse where the contact slides, and NAN elsewhere. */
static double see_friction(const contact_force *f, const touch *t, worst *most)
{
    double normal = t->normal_impulse, tangent = pl_vec_length(t->tangent_impulse);
    if (!(t->friction > 0 && t->weight > 0 && normal > LIGHT * t->weight)) {
        return (double)NAN;
    }
    double limit = t->friction * normal;
    most->cone = larger(most->cone, fmax(tangent - limit, 0) / limit);
    /* A contact that sticks may creep, but no faster than by what gravity adds in a step. */
    const bool slides = pl_vec_length(t->tangent_velocity) > f->scene->dt * f->gravity;
    return slides ? tangent / normal : (double)NAN;
}

static double see_contact(const contact_force *f, const pl_step *step, int i,
                          const pl_contact_velocity *velocity, worst *most)
{
    const touch t = touch_of(f, i, velocity, step);
    if (!(t.inverse_mass > 0)) {
        return (double)NAN; /* both are static */
    }
    const double slide = see_friction(f, &t, most);
    if (t.restitution == 0) {
        double power = fabs(t.normal_impulse * t.normal_velocity) / f->scene->dt;
        most->signorini = larger(most->signorini, power);
        most->natural_map = larger(most->natural_map, natural_map(&t));
    }
    return slide;
}

static pl_contact_velocity velocity_of(const contact_force *f, const pl_step *step, int i)
{
    if (step->times != NULL) {
        return pl_contact_motion_velocity(f->motion, step, i);
    }
    const pl_contact *c = &step->contacts[i];
    return (pl_contact_velocity){.left = pl_vec_sub(point_velocity(f->scene, c->body_b, c, step),
                                                    point_velocity(f->scene, c->body_a, c, step))};
}

static void see_contacts(void *context, int begin, int end)
{
    const judging *j = context;
    const contact_force *f = j->force;
    worst most = {-1, -1, -1};
    for (int i = begin; i < end; ++i) {
        const pl_contact_velocity velocity = velocity_of(f, j->step, i);
        f->slides[i] = see_contact(f, j->step, i, &velocity, &most);
    }
    f->most[begin / PIECE] = most;
}

static void add_worst(contact_force *f, series_id id, double value, long step)
{
    if (value >= 0) {
        pl_series_add(&f->series[id], value, step);
    }
}

/* After a step whose contacts are not reported, none of the metrics applies. */
static void see(void *state, const pl_run_view *view)
{
    contact_force *f = state;
    const pl_step *step = &view->step;
    if (step->number == 0) {
        return;
    }
    f->unreported = f->unreported || step->contact_count < 0;
    if (f->unreported) {
        return;
    }
    judging j = {f, step};
    if (!step->repeats) {
        pl_contact_motion_step(f->motion, step);
        reserve(f, step->contact_count);
    }
    pl_thread_pool_run(step->pool, f->scene->body_count, PIECE, see_bodies, &j);
    see_balance(f, step);
    if (!step->repeats) {
        pl_thread_pool_run(step->pool, step->contact_count, PIECE, see_contacts, &j);
    }
    worst most = {-1, -1, -1};
    for (int i = 0; i < step->contact_count; i += PIECE) {
        const worst *piece = &f->most[i / PIECE];
        most.cone = fmax(most.cone, piece->cone);
        most.signorini = fmax(most.signorini, piece->signorini);
        most.natural_map = fmax(most.natural_map, piece->natural_map);
    }
    for (int i = 0; i < step->contact_count; ++i) {
        pl_series_add(&f->series[OF_FRICTION], f->slides[i], step->number);
    }
    add_worst(f, OF_CONE, most.cone, step->number);
    add_worst(f, OF_SIGNORINI, most.signorini, step->number);
    add_worst(f, OF_NATURAL_MAP, most.natural_map, step->number);
}

/* ---- The metrics ---- */

static pl_metric metric_of(const contact_force *f, const pl_series *series, double value)
{
    bool applies = !f->unreported && series->count > 0;
    return applies ? pl_series_metric(series, value) : (pl_metric){0};
}

static void collect(void *state, const pl_run_view *view, pl_metric *item)
{
    const contact_force *f = state;
    const pl_series *s = f->series, *balance = &s[OF_BALANCE + (int)view->integrator];
    item[PL_METRIC_FORCE_BALANCE] = metric_of(f, balance, balance->max);
    item[PL_METRIC_CONE_VIOLATION] = metric_of(f, &s[OF_CONE], s[OF_CONE].max);
    item[PL_METRIC_FRICTION_EFFECTIVE] =
        metric_of(f, &s[OF_FRICTION], pl_series_mean(&s[OF_FRICTION]));
    item[PL_METRIC_SIGNORINI] = metric_of(f, &s[OF_SIGNORINI], s[OF_SIGNORINI].max);
    item[PL_METRIC_NATURAL_MAP] = metric_of(f, &s[OF_NATURAL_MAP], s[OF_NATURAL_MAP].max);
}

const pl_module pl_contact_force_module = {create, see, collect, .needs_no_motion = false};
