/* The velocities that each contact left, where an engine says when its contacts acted.
 *
 * From the state before the step on, the momenta of each body follow from gravity and from the
 * reported impulses in their order. An impulse over an interval [b, e] leaves
 *
 *   v = v_b + (e - b) g + J/m,    w = w_free + I_b^-1 sum r x J,
 *
 * where w_free is what free rotation makes of w_b by e, and I_b the inertia in the axes of b: the
 * velocities of time stepping (Moreau 1988; Jean 1999), which the contact law is imposed on. Then
 * the body rotates, and keeps its angular momentum. What is left to the velocities that the engine
 * reports at the step's end, by applied forces, position correction or errors, is added to those of
 * the last interval. */
#include "modules.h"
#include "referee/geometry/solid.h"

/* Parts of an interval of free rotation, each a midpoint rule. */
enum { ROTATION_PARTS = 4 };

/* Of the step: intervals that end this near to its end are the last. */
static const double LAST = 1e-9;

/* Not yet on its way. */
enum { NONE = -1 };

/* Room to begin with. */
enum { CONTACTS_PER_BODY = 8, LEAST_CONTACTS = 64 };

/* What one solve does to a body. */
typedef struct solve {
    pl_vec v, w;           /* before it, m/s, rad/s */
    pl_vec left_v, left_w; /* the velocities that it leaves, m/s, rad/s */
} solve;

/* A body on its way through the contacts of the step. */
typedef struct track {
    int run;                 /* of contacts of the same order, which are one solve; or NONE */
    int solve;               /* of that run */
    double end;              /* of that solve, s since the start of the step */
    pl_vec impulse, angular; /* of its contacts so far, N s, N m s */
    double time;             /* s since the start of the step */
    pl_vec v, momentum;      /* m/s; angular about the centre of mass, N m s, world */
    pl_axes axes;            /* principal */
    pl_vec rest_v, rest_w;   /* what the step's end has besides, m/s, rad/s */
} track;

/* A side is one body's part in a contact: 2 i for body A of contact i, 2 i + 1 for body B. */
struct pl_contact_motion {
    const pl_scene *scene;
    pl_arena *arena;
    track *bodies; /* (body_count) */
    int *solve_of; /* (solve_of_capacity): the solve of a side */
    solve *solves; /* (solve_count of solve_capacity) */
    int solve_of_capacity, solve_count, solve_capacity;
};

pl_contact_motion *pl_contact_motion_create(const pl_scene *scene, pl_arena *arena)
{
    pl_contact_motion *m = pl_arena_take(arena, 1, sizeof *m);
    m->scene = scene;
    m->arena = arena;
    m->bodies = pl_arena_take(arena, (size_t)scene->body_count, sizeof *m->bodies);
    pl_arena_reserve(arena, &m->solves, &m->solve_capacity, scene->body_count, sizeof *m->solves);
    pl_arena_reserve(arena, &m->solve_of, &m->solve_of_capacity,
                     2 * (LEAST_CONTACTS + CONTACTS_PER_BODY * scene->body_count),
                     sizeof *m->solve_of);
    return m;
}

/* ---- Rotation ---- */

/* I x or I^-1 x, world. */
static pl_vec inertia_times(const pl_axes *axes, const double inertia[3], bool inverse, pl_vec x)
{
    pl_vec local = pl_to_local(axes, x);
    const double i[3] = {inverse ? 1 / inertia[0] : inertia[0],
                         inverse ? 1 / inertia[1] : inertia[1],
                         inverse ? 1 / inertia[2] : inertia[2]};
    return pl_to_world(axes, (pl_vec){i[0] * local.x, i[1] * local.y, i[2] * local.z});
}

/* Rotates by the rotation vector `by`, rad (Rodrigues). */
static void rotate(pl_axes *axes, pl_vec by)
{
    const double angle = pl_vec_length(by);
    if (angle == 0) {
        return;
    }
    const pl_vec along = pl_vec_scale(by, 1 / angle);
    const double sine = sin(angle), versine = 1 - cos(angle);
    for (int k = 0; k < 3; ++k) {
        const pl_vec x = axes->axis[k], turned = pl_vec_cross(along, x);
        axes->axis[k] =
            pl_vec_mad(pl_vec_mad(x, sine, turned), versine, pl_vec_cross(along, turned));
    }
}

/* Rotates freely for `dt` with the angular momentum. */
static void rotate_freely(pl_axes *axes, const double inertia[3], pl_vec momentum, double dt)
{
    const double part = dt / ROTATION_PARTS;
    for (int i = 0; i < ROTATION_PARTS && dt > 0; ++i) {
        pl_axes middle = *axes;
        rotate(&middle, pl_vec_scale(inertia_times(axes, inertia, true, momentum), 0.5 * part));
        rotate(axes, pl_vec_scale(inertia_times(&middle, inertia, true, momentum), part));
    }
}

/* ---- A body ---- */

static void begin_body(const pl_body *body, const pl_body_state *before, track *t)
{
    *t = (track){.run = NONE,
                 .v = pl_vec_of(before->velocity),
                 .axes = pl_principal_axes(&body->shape, before->orientation)};
    t->momentum =
        inertia_times(&t->axes, body->inertia, false, pl_vec_of(before->angular_velocity));
}

static void advance(const pl_contact_motion *m, const pl_body *body, double to, track *t)
{
    const double dt = fmax(to - t->time, 0);
    t->v = pl_vec_mad(t->v, dt, pl_vec_of(m->scene->gravity));
    rotate_freely(&t->axes, body->inertia, t->momentum, dt);
    t->time = fmax(to, t->time);
}

/* Begins the solve of a run, whose first contact has this time. */
static void begin_solve(pl_contact_motion *m, const pl_body *body, const pl_contact_time *first,
                        int run, track *t)
{
    advance(m, body, first->begin, t);
    t->run = run;
    t->solve = m->solve_count++;
    t->end = first->end;
    t->impulse = t->angular = (pl_vec){0, 0, 0};
    pl_arena_reserve(m->arena, &m->solves, &m->solve_capacity, m->solve_count, sizeof *m->solves);
}

/* Takes a body through its solve, which has all of its contacts. */
static void end_solve(const pl_contact_motion *m, const pl_body *body, track *t)
{
    const double *inertia = body->inertia;
    const double dt = fmax(t->end - t->time, 0);
    solve *s = &m->solves[t->solve];
    pl_axes free = t->axes;
    rotate_freely(&free, inertia, t->momentum, dt);
    s->v = t->v;
    s->w = inertia_times(&t->axes, inertia, true, t->momentum);
    s->left_v =
        pl_vec_mad(pl_vec_mad(t->v, dt, pl_vec_of(m->scene->gravity)), 1 / body->mass, t->impulse);
    s->left_w = pl_vec_add(inertia_times(&free, inertia, true, t->momentum),
                           inertia_times(&t->axes, inertia, true, t->angular));
    rotate(&t->axes, pl_vec_scale(pl_vec_add(s->w, s->left_w), 0.5 * dt));
    t->v = s->left_v;
    t->momentum = pl_vec_add(t->momentum, t->angular);
    t->time = fmax(t->end, t->time);
}

/* Takes a body to the step's end, and compares the end that the impulses explain with the one
 * reported. */
static void end_body(const pl_contact_motion *m, const pl_body *body, const pl_body_state *after,
                     track *t)
{
    advance(m, body, m->scene->dt, t);
    const pl_axes axes = pl_principal_axes(&body->shape, after->orientation);
    t->rest_v = pl_vec_sub(pl_vec_of(after->velocity), t->v);
    t->rest_w = pl_vec_sub(pl_vec_of(after->angular_velocity),
                           inertia_times(&axes, body->inertia, true, t->momentum));
}

/* Adds an impulse of a contact, N s, to the solve of its body. */
static void add_side(pl_contact_motion *m, const pl_step *step, int side, int run, pl_vec impulse)
{
    const pl_contact_time *time = &step->times[side / 2];
    const bool is_b = side % 2 == 1;
    const int index = is_b ? step->contacts[side / 2].body_b : step->contacts[side / 2].body_a;
    const pl_body *body = &m->scene->bodies[index];
    track *t = &m->bodies[index];
    if (body->is_static) {
        return;
    }
    if (t->run != run) {
        if (t->run == NONE) {
            begin_body(body, &step->before[index], t);
        } else {
            end_solve(m, body, t);
        }
        begin_solve(m, body, time, run, t);
    }
    t->impulse = pl_vec_add(t->impulse, impulse);
    t->angular = pl_vec_add(
        t->angular, pl_vec_cross(pl_vec_of(is_b ? time->acts.arm_b : time->acts.arm_a), impulse));
    m->solve_of[side] = t->solve;
}

void pl_contact_motion_step(pl_contact_motion *m, const pl_step *step)
{
    int run = 0;
    m->solve_count = 0;
    pl_arena_reserve(m->arena, &m->solve_of, &m->solve_of_capacity, 2 * step->contact_count,
                     sizeof *m->solve_of);
    for (int i = 0; i < m->scene->body_count; ++i) {
        m->bodies[i].run = NONE;
    }
    for (int i = 0; i < step->contact_count; ++i) {
        const pl_vec impulse = pl_vec_of(step->contacts[i].impulse);
        run += i > 0 && step->times[i].order != step->times[i - 1].order;
        add_side(m, step, 2 * i, run, pl_vec_scale(impulse, -1));
        add_side(m, step, 2 * i + 1, run, impulse);
    }
    for (int i = 0; i < m->scene->body_count; ++i) {
        if (m->bodies[i].run != NONE) {
            end_solve(m, &m->scene->bodies[i], &m->bodies[i]);
            end_body(m, &m->scene->bodies[i], &step->after[i], &m->bodies[i]);
        }
    }
}

/* ---- A contact ---- */

/* Adds the velocities of the point of side `side`, on `body`, with a sign. `last`: the solve ends
 * with the step. */
static void add_point_velocity(const pl_contact_motion *m, int body, int side, const double acts[3],
                               const double holds[3], bool last, pl_contact_velocity *u)
{
    const track *b = &m->bodies[body];
    const double sign = side % 2 == 1 ? 1 : -1;
    if (m->scene->bodies[body].is_static) {
        return;
    }
    const solve *s = &m->solves[m->solve_of[side]];
    const pl_vec v = last ? pl_vec_add(s->left_v, b->rest_v) : s->left_v;
    const pl_vec w = last ? pl_vec_add(s->left_w, b->rest_w) : s->left_w;
    const pl_vec mean_v = pl_vec_scale(pl_vec_add(v, s->v), 0.5);
    const pl_vec mean_w = pl_vec_scale(pl_vec_add(w, s->w), 0.5);
    u->left = pl_vec_mad(u->left, sign, pl_vec_add(v, pl_vec_cross(w, pl_vec_of(holds))));
    u->mean = pl_vec_mad(u->mean, sign, pl_vec_add(mean_v, pl_vec_cross(mean_w, pl_vec_of(acts))));
}

pl_contact_velocity pl_contact_motion_velocity(const pl_contact_motion *m, const pl_step *step,
                                               int i)
{
    const pl_contact *c = &step->contacts[i];
    const pl_contact_place *acts = &step->times[i].acts, *holds = &step->times[i].holds;
    const bool last = step->times[i].end >= (1 - LAST) * m->scene->dt;
    pl_contact_velocity u = {{0, 0, 0}, {0, 0, 0}};
    add_point_velocity(m, c->body_a, 2 * i, acts->arm_a, holds->arm_a, last, &u);
    add_point_velocity(m, c->body_b, 2 * i + 1, acts->arm_b, holds->arm_b, last, &u);
    return u;
}
