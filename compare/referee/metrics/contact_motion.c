#include "contact_motion.h"

#include "referee/geometry/solid.h"

#include <string.h>

/* Parts of an interval of free rotation, each a midpoint rule. */
enum { ROTATION_PARTS = 4 };

/* Of the step: intervals that end this near to its end are the last. */
static const double LAST = 1e-9;

/* Room to begin with. */
enum { CONTACTS_PER_BODY = 8, LEAST_CONTACTS = 64 };

/* A side is one body's part in a contact: 2 i for body A of contact i, 2 i + 1 for body B. */
typedef struct side_of_body {
    int side;
    int run; /* of contacts of the same order, which are one solve */
} side_of_body;

/* What one solve does to a body. */
typedef struct solve {
    pl_vec v, w;           /* before it, m/s, rad/s */
    pl_vec left_v, left_w; /* the velocities that it leaves, m/s, rad/s */
} solve;

/* The contacts of a body in the step: the sides from `begin` to before `end`. */
typedef struct body_contacts {
    int begin, end;
    pl_vec rest_v, rest_w; /* what the step's end has besides, m/s, rad/s */
} body_contacts;

struct pl_contact_motion {
    const pl_scene *scene;
    pl_arena *arena;
    body_contacts *bodies; /* (body_count); none of static ones */
    side_of_body *sides;   /* (side_capacity): by bodies, in the order of the contacts */
    int *solve_of;         /* (solve_of_capacity): the solve of a side */
    solve *solves;         /* (solve_count of solve_capacity) */
    int side_capacity, solve_of_capacity, solve_count, solve_capacity;
};

/* A body on its way through the step. */
typedef struct track {
    double time;        /* s since the start of the step */
    pl_vec v, momentum; /* m/s; angular about the centre of mass, N m s, world */
    pl_axes axes;       /* principal */
} track;

/* Makes room for the contacts of a step. */
static void reserve(pl_contact_motion *m, int contacts)
{
    pl_arena_reserve(m->arena, &m->sides, &m->side_capacity, 2 * contacts, sizeof *m->sides);
    pl_arena_reserve(m->arena, &m->solve_of, &m->solve_of_capacity, 2 * contacts,
                     sizeof *m->solve_of);
}

pl_contact_motion *pl_contact_motion_create(const pl_scene *scene, pl_arena *arena)
{
    pl_contact_motion *m = pl_arena_take(arena, 1, sizeof *m);
    m->scene = scene;
    m->arena = arena;
    m->bodies = pl_arena_take(arena, (size_t)scene->body_count, sizeof *m->bodies);
    pl_arena_reserve(arena, &m->solves, &m->solve_capacity, scene->body_count, sizeof *m->solves);
    reserve(m, LEAST_CONTACTS + CONTACTS_PER_BODY * scene->body_count);
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

/* ---- The contacts of each body ---- */

static int body_of(const pl_step *step, int side)
{
    const pl_contact *contact = &step->contacts[side / 2];
    return side % 2 == 1 ? contact->body_b : contact->body_a;
}

/* Lists the sides of each body, in their order. */
static void list_sides(pl_contact_motion *m, const pl_step *step)
{
    int sum = 0, run = 0;
    reserve(m, step->contact_count);
    for (int i = 0; i < m->scene->body_count; ++i) {
        m->bodies[i].end = 0;
    }
    for (int side = 0; side < 2 * step->contact_count; ++side) {
        const int body = body_of(step, side);
        m->bodies[body].end += !m->scene->bodies[body].is_static;
    }
    for (int i = 0; i < m->scene->body_count; ++i) {
        const int count = m->bodies[i].end;
        m->bodies[i].begin = m->bodies[i].end = sum;
        sum += count;
    }
    for (int side = 0; side < 2 * step->contact_count; ++side) {
        const int i = side / 2, body = body_of(step, side);
        run += side == 2 * i && i > 0 && step->times[i].order != step->times[i - 1].order;
        if (!m->scene->bodies[body].is_static) {
            m->sides[m->bodies[body].end++] = (side_of_body){side, run};
        }
    }
}

/* The impulse of a side on its body, N s. */
static pl_vec impulse_of(const pl_step *step, int side)
{
    const pl_vec impulse = pl_vec_of(step->contacts[side / 2].impulse);
    return side % 2 == 1 ? impulse : pl_vec_scale(impulse, -1);
}

/* ---- A body ---- */

static void advance(const pl_contact_motion *m, const double inertia[3], double to, track *t)
{
    const double dt = fmax(to - t->time, 0);
    t->v = pl_vec_mad(t->v, dt, pl_vec_of(m->scene->gravity));
    rotate_freely(&t->axes, inertia, t->momentum, dt);
    t->time = fmax(to, t->time);
}

/* Takes a body through a solve of the sides from `begin` to before `end`. */
static void follow_solve(pl_contact_motion *m, const pl_step *step, const pl_body *body, int begin,
                         int end, track *t)
{
    const double *inertia = body->inertia;
    const pl_contact_time *first = &step->times[m->sides[begin].side / 2];
    pl_vec impulse = {0, 0, 0}, angular = {0, 0, 0};
    pl_arena_reserve(m->arena, &m->solves, &m->solve_capacity, m->solve_count + 1,
                     sizeof *m->solves);
    solve *s = &m->solves[m->solve_count];
    advance(m, inertia, first->begin, t);
    for (int i = begin; i < end; ++i) {
        const int side = m->sides[i].side;
        const pl_contact_place *acts = &step->times[side / 2].acts;
        const pl_vec arm = pl_vec_of(side % 2 == 1 ? acts->arm_b : acts->arm_a);
        const pl_vec part = impulse_of(step, side);
        impulse = pl_vec_add(impulse, part);
        angular = pl_vec_add(angular, pl_vec_cross(arm, part));
        m->solve_of[side] = m->solve_count;
    }
    m->solve_count += 1;
    const double dt = fmax(first->end - t->time, 0);
    pl_axes free = t->axes;
    rotate_freely(&free, inertia, t->momentum, dt);
    s->v = t->v;
    s->w = inertia_times(&t->axes, inertia, true, t->momentum);
    s->left_v =
        pl_vec_mad(pl_vec_mad(t->v, dt, pl_vec_of(m->scene->gravity)), 1 / body->mass, impulse);
    s->left_w = pl_vec_add(inertia_times(&free, inertia, true, t->momentum),
                           inertia_times(&t->axes, inertia, true, angular));
    rotate(&t->axes, pl_vec_scale(pl_vec_add(s->w, s->left_w), 0.5 * dt));
    t->v = s->left_v;
    t->momentum = pl_vec_add(t->momentum, angular);
    t->time = fmax(first->end, t->time);
}

/* Takes a body through the step, and compares the end that the impulses explain with the one
 * reported. */
static void follow_body(pl_contact_motion *m, const pl_step *step, int index)
{
    const pl_body *body = &m->scene->bodies[index];
    const pl_body_state *before = &step->before[index], *after = &step->after[index];
    body_contacts *b = &m->bodies[index];
    track t = {.v = pl_vec_of(before->velocity),
               .axes = pl_principal_axes(&body->shape, before->orientation)};
    t.momentum = inertia_times(&t.axes, body->inertia, false, pl_vec_of(before->angular_velocity));
    for (int begin = b->begin, end; begin < b->end; begin = end) {
        for (end = begin + 1; end < b->end && m->sides[end].run == m->sides[begin].run;) {
            end += 1;
        }
        follow_solve(m, step, body, begin, end, &t);
    }
    advance(m, body->inertia, m->scene->dt, &t);
    const pl_axes axes = pl_principal_axes(&body->shape, after->orientation);
    b->rest_v = pl_vec_sub(pl_vec_of(after->velocity), t.v);
    b->rest_w = pl_vec_sub(pl_vec_of(after->angular_velocity),
                           inertia_times(&axes, body->inertia, true, t.momentum));
}

void pl_contact_motion_step(pl_contact_motion *m, const pl_step *step)
{
    list_sides(m, step);
    m->solve_count = 0;
    for (int i = 0; i < m->scene->body_count; ++i) {
        if (m->bodies[i].begin < m->bodies[i].end) {
            follow_body(m, step, i);
        }
    }
}

/* ---- A contact ---- */

/* Adds the velocities of the point of side `side`, on `body`, with a sign. `last`: the solve ends
 * with the step. */
static void add_point_velocity(const pl_contact_motion *m, int body, int side, const double acts[3],
                               const double holds[3], bool last, pl_contact_velocity *u)
{
    const body_contacts *b = &m->bodies[body];
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
