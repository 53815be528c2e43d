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
 * that it states (contact_motion.c), and h the length of its interval.
 * A correct bounce has r_n > 0 and u_n > 0, so the last two metrics leave out pairs with
 * restitution. */
#include "modules.h"
#include "referee/geometry/solid.h"

#include <string.h>

/* In units of the lighter body's weight: friction is not measured at contacts that bear less. */
static const double LIGHT = 1e-3;

/* Largest over the contacts of a step; NAN if no contact has one. */
typedef struct worst {
    double cone, signorini, natural_map;
} worst;

typedef struct contact_force {
    const pl_scene *scene;
    pl_contact_motion *motion;
    pl_arena *arena;
    double gravity; /* m/s^2 */
    pl_vec *excess; /* (body_count): impulses less their effect, N s */
    pl_axes *axes;  /* (body_count): principal, before the step */
    double *slides; /* (capacity): friction_effective of a contact; NAN: it does not slide */
    worst most;
    int capacity; /* contacts */
} contact_force;

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

static void *create(const pl_run_view *view, pl_arena *arena)
{
    const pl_scene *scene = view->scene;
    contact_force *f = pl_arena_take(arena, 1, sizeof *f);
    f->scene = scene;
    f->arena = arena;
    f->gravity = pl_vec_length(pl_vec_of(scene->gravity));
    f->axes = pl_arena_take(arena, (size_t)scene->body_count, sizeof *f->axes);
    f->motion = pl_contact_motion_create(scene, arena);
    f->excess = pl_arena_take(arena, (size_t)scene->body_count, sizeof *f->excess);
    pl_arena_reserve(arena, &f->slides, &f->capacity,
                     LEAST_CONTACTS + CONTACTS_PER_BODY * scene->body_count, sizeof *f->slides);
    return f;
}

/* The larger of both; a NaN in `b` counts as infinite, so that it is not lost. */
static double larger(double a, double b)
{
    return isnan(b) ? HUGE_VAL : fmax(a, b);
}

/* ---- The balance of each body ---- */

static void add_impulse(contact_force *f, int body, pl_vec impulse)
{
    f->excess[body] = pl_vec_add(f->excess[body], impulse);
}

/* Finds the impulses on each body by gravity, contacts and applied forces, less their effect. */
static void find_excess(contact_force *f, const pl_step *step, pl_position_rule k)
{
    const double dt = f->scene->dt;
    for (int i = 0; i < f->scene->body_count; ++i) {
        const pl_vec change =
            pl_vec_sub(pl_vec_of(step->after[i].velocity), pl_vec_of(step->before[i].velocity));
        const pl_vec due = pl_vec_mad(change, -dt, pl_vec_of(f->scene->gravity));
        f->excess[i] = pl_vec_scale(due, -f->scene->bodies[i].mass);
    }
    for (int i = 0; i < step->contact_count; ++i) {
        const pl_contact *contact = &step->contacts[i];
        const pl_vec impulse = pl_vec_of(contact->impulse);
        add_impulse(f, contact->body_a, pl_vec_scale(impulse, -1));
        add_impulse(f, contact->body_b, impulse);
    }
    for (int i = 0; i < f->scene->force_count; ++i) {
        const pl_force *force = &f->scene->forces[i];
        if (pl_applied_force_acts(force, step->number, dt)) {
            add_impulse(f, force->body,
                        pl_applied_force_impulse(force, k, &step->before[force->body],
                                                 &step->after[force->body], dt));
        }
    }
}

/* There is none without gravity. */
static void see_balance(contact_force *f, const pl_run_view *view)
{
    const pl_scene *scene = f->scene;
    const double fall = scene->dt * f->gravity;
    for (pl_position_rule k = 0; fall > 0 && k < PL_POSITION_RULE_COUNT; ++k) {
        double largest = 0;
        find_excess(f, &view->step, k);
        for (int i = 0; i < scene->body_count; ++i) {
            if (!scene->bodies[i].is_static) {
                double excess = pl_vec_length(f->excess[i]);
                largest = larger(largest, excess / (scene->bodies[i].mass * fall));
            }
        }
        pl_see_value_by(view, PL_METRIC_FORCE_BALANCE, k, largest);
    }
}

/* ---- The law of each contact ---- */

/* Stores the way from the body's centre of mass to the contact's point, m, both at the start of the
 * step. */
static void store_arm(const pl_scene *scene, int body, const pl_contact *contact,
                      const pl_step *step, double arm[3])
{
    const pl_vec centre = pl_state_centre(&scene->bodies[body], &step->before[body]);
    pl_vec_store(pl_vec_sub(pl_vec_of(contact->point), centre), arm);
}

/* When and where contact i acted: over the whole step, unless the engine says otherwise. */
static pl_contact_time time_of(const contact_force *f, const pl_step *step, int i)
{
    if (step->times != NULL) {
        return step->times[i];
    }
    const pl_contact *c = &step->contacts[i];
    pl_contact_time whole = {.end = f->scene->dt};
    store_arm(f->scene, c->body_a, c, step, whole.acts.arm_a);
    store_arm(f->scene, c->body_b, c, step, whole.acts.arm_b);
    memcpy(whole.acts.normal, c->normal, sizeof c->normal);
    whole.holds = whole.acts;
    return whole;
}

/* The velocity after the step of the body's point at `arm`, m/s. */
static pl_vec point_velocity(const pl_scene *scene, int index, const double arm[3],
                             const pl_step *step)
{
    const pl_body_state *after = &step->after[index];
    if (scene->bodies[index].is_static) {
        return (pl_vec){0, 0, 0};
    }
    return pl_vec_add(pl_vec_of(after->velocity),
                      pl_vec_cross(pl_vec_of(after->angular_velocity), pl_vec_of(arm)));
}

static pl_contact_velocity velocity_of(const contact_force *f, const pl_step *step, int i,
                                       const pl_contact_place *acts)
{
    if (step->times != NULL) {
        return pl_contact_motion_velocity(f->motion, step, i);
    }
    const pl_contact *c = &step->contacts[i];
    return (pl_contact_velocity){
        .left = pl_vec_sub(point_velocity(f->scene, c->body_b, acts->arm_b, step),
                           point_velocity(f->scene, c->body_a, acts->arm_a, step))};
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

static bool same_place(const pl_contact_place *a, const pl_contact_place *b)
{
    bool same = true;
    for (int k = 0; k < 3; ++k) {
        same &= a->arm_a[k] == b->arm_a[k] && a->arm_b[k] == b->arm_b[k] &&
                a->normal[k] == b->normal[k];
    }
    return same;
}

/* Contact i of the step. */
static touch touch_of(const contact_force *f, const pl_step *step, int i)
{
    const pl_scene *scene = f->scene;
    const pl_contact *contact = &step->contacts[i];
    const pl_contact_time time = time_of(f, step, i);
    const pl_contact_velocity velocity = velocity_of(f, step, i, &time.acts);
    const int a = contact->body_a, b = contact->body_b;
    touch t = {.weight = HUGE_VAL};
    pl_scene_pair(scene, scene->bodies[a].material, scene->bodies[b].material, &t.friction,
                  &t.restitution);
    add_side(f, a, pl_vec_of(time.acts.arm_a), &t);
    add_side(f, b, pl_vec_of(time.acts.arm_b), &t);
    const pl_vec n = pl_vec_of(time.acts.normal), at_end = pl_vec_of(time.holds.normal);
    const double dt = time.end - time.begin;
    const pl_vec r = pl_vec_of(contact->impulse);
    t.normal_impulse = pl_vec_dot(r, n);
    t.tangent_impulse = pl_vec_reject(r, n);
    t.normal_velocity = pl_vec_dot(velocity.left, at_end);
    /* A gap closes over an interval, not in the instant of an impact. */
    t.normal_velocity += dt > 0 ? fmax(contact->separation, 0) / dt : 0;
    t.tangent_velocity = pl_vec_reject(pl_vec_reject(velocity.left, at_end), n);
    /* Where the places differ, the impulse acted at the middle of its interval. */
    t.has_mean_slip = !same_place(&time.acts, &time.holds);
    t.mean_slip = pl_vec_reject(velocity.mean, n);
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

static double see_contact(const contact_force *f, const touch *t, worst *most)
{
    if (!(t->inverse_mass > 0)) {
        return (double)NAN; /* both are static */
    }
    const double slide = see_friction(f, t, most);
    if (t->restitution == 0) {
        double power = fabs(t->normal_impulse * t->normal_velocity) / f->scene->dt;
        most->signorini = larger(most->signorini, power);
        most->natural_map = larger(most->natural_map, natural_map(t));
    }
    return slide;
}

static void see_contacts(contact_force *f, const pl_step *step)
{
    for (int i = 0; i < f->scene->body_count; ++i) {
        f->axes[i] = pl_principal_axes(&f->scene->bodies[i].shape, step->before[i].orientation);
    }
    if (step->times != NULL) {
        pl_contact_motion_step(f->motion, step);
    }
    pl_arena_reserve(f->arena, &f->slides, &f->capacity, step->contact_count, sizeof *f->slides);
    f->most = (worst){(double)NAN, (double)NAN, (double)NAN};
    for (int i = 0; i < step->contact_count; ++i) {
        const touch t = touch_of(f, step, i);
        f->slides[i] = see_contact(f, &t, &f->most);
    }
}

static void see(void *state, const pl_run_view *view)
{
    contact_force *f = state;
    const pl_step *step = &view->step;
    if (step->contact_count < 0) {
        return;
    }
    see_balance(f, view);
    if (!step->repeats) {
        see_contacts(f, step);
    }
    for (int i = 0; i < step->contact_count; ++i) {
        pl_see_value(view, PL_METRIC_FRICTION_EFFECTIVE, f->slides[i]);
    }
    pl_see_value(view, PL_METRIC_CONE_VIOLATION, f->most.cone);
    pl_see_value(view, PL_METRIC_SIGNORINI, f->most.signorini);
    pl_see_value(view, PL_METRIC_NATURAL_MAP, f->most.natural_map);
}

const pl_module pl_contact_force_module = {.create = create, .see = see, .needs_no_pairs = true};
