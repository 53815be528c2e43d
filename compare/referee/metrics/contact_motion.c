#include "contact_motion.h"

#include "referee/geometry/solid.h"

#include <string.h>

/* Parts of an interval of free rotation, each a midpoint rule. */
enum { ROTATION_PARTS = 4 };

/* Of the step: intervals that end this near to its end are the last. */
static const double LAST = 1e-9;

/* No side, or no solve. */
enum { NONE = -1 };

/* Room to begin with. */
enum { CONTACTS_PER_BODY = 8, LEAST_CONTACTS = 64 };

enum { PIECE = 512 /* bodies that are followed together */ };

/* A body's part in the contacts that one solve has of it. A side is one body's part in a contact:
 * 2 i for body A of contact i, 2 i + 1 for body B. */
typedef struct solve {
    int first;             /* side */
    int next;              /* solve of the body */
    pl_vec v, w;           /* before it, m/s, rad/s */
    pl_vec left_v, left_w; /* the velocities that it leaves, m/s, rad/s */
} solve;

/* The contacts of a body in the step. */
typedef struct body_contacts {
    int first_side, last_side;
    int first_solve, last_solve;
    int run;               /* of contacts of the same order: that of the last side */
    pl_vec rest_v, rest_w; /* what the step's end has besides, m/s, rad/s */
} body_contacts;

struct pl_contact_motion {
    const pl_scene *scene;
    pl_arena *arena;
    pl_vec gravity;
    body_contacts *bodies; /* (body_count); none of static ones */
    int *next;             /* (2 x contact_capacity): the next side of the same body */
    int *solve_of;         /* (2 x contact_capacity): the solve of a side */
    int contact_capacity;
    solve *solves; /* (solve_count) */
    int solve_count, solve_capacity;
};

/* A body on its way through the step. */
typedef struct track {
    double time;        /* s since the start of the step */
    pl_vec v, momentum; /* m/s; angular about the centre of mass, N m s, world */
    pl_axes axes;       /* principal */
} track;

/* ---- Memory ---- */

/* The memory of smaller arrays is the arena's until its end. */
static void reserve_contacts(pl_contact_motion *m, int count)
{
    if (count <= m->contact_capacity) {
        return;
    }
    const int doubled = 2 * m->contact_capacity;
    m->contact_capacity = doubled > count ? doubled : count;
    m->next = pl_arena_take(m->arena, 2 * (size_t)m->contact_capacity, sizeof *m->next);
    m->solve_of = pl_arena_take(m->arena, 2 * (size_t)m->contact_capacity, sizeof *m->solve_of);
}

static void reserve_solve(pl_contact_motion *m)
{
    if (m->solve_count < m->solve_capacity) {
        return;
    }
    const int capacity = 2 * m->solve_capacity + 1;
    solve *solves = pl_arena_take(m->arena, (size_t)capacity, sizeof *solves);
    memcpy(solves, m->solves, (size_t)m->solve_count * sizeof *solves);
    m->solves = solves;
    m->solve_capacity = capacity;
}

pl_contact_motion *pl_contact_motion_create(const pl_scene *scene, pl_arena *arena)
{
    pl_contact_motion *m = pl_arena_take(arena, 1, sizeof *m);
    m->scene = scene;
    m->arena = arena;
    m->gravity = pl_vec_of(scene->gravity);
    m->solve_capacity = scene->body_count;
    m->bodies = pl_arena_take(arena, (size_t)scene->body_count, sizeof *m->bodies);
    m->solves = pl_arena_take(arena, (size_t)scene->body_count, sizeof *m->solves);
    reserve_contacts(m, LEAST_CONTACTS + CONTACTS_PER_BODY * scene->body_count);
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

/* Adds a side to its body's solves: to the last one if that is of the same run. */
static void add_to_solve(pl_contact_motion *m, body_contacts *b, int side, int run)
{
    if (b->first_solve != NONE && b->run == run) {
        m->solve_of[side] = b->last_solve;
        return;
    }
    reserve_solve(m);
    const int added = m->solve_count++;
    m->solves[added].first = side;
    m->solves[added].next = NONE;
    if (b->first_solve == NONE) {
        b->first_solve = added;
    } else {
        m->solves[b->last_solve].next = added;
    }
    b->last_solve = added;
    b->run = run;
    m->solve_of[side] = added;
}

static void add_side(pl_contact_motion *m, int body, int side, int run, bool has_times)
{
    body_contacts *b = &m->bodies[body];
    if (m->scene->bodies[body].is_static) {
        return;
    }
    m->next[side] = NONE;
    if (b->first_side == NONE) {
        b->first_side = side;
    } else {
        m->next[b->last_side] = side;
    }
    b->last_side = side;
    if (has_times) {
        add_to_solve(m, b, side, run);
    }
}

/* Lists the sides and the solves of each body, in their order. */
static void list_sides(pl_contact_motion *m, const pl_step *step)
{
    int run = 0;
    reserve_contacts(m, step->contact_count);
    m->solve_count = 0;
    for (int i = 0; i < m->scene->body_count; ++i) {
        m->bodies[i].first_side = m->bodies[i].first_solve = NONE;
    }
    for (int i = 0; i < step->contact_count; ++i) {
        const bool has_times = step->times != NULL;
        run += has_times && i > 0 && step->times[i].order != step->times[i - 1].order;
        add_side(m, step->contacts[i].body_a, 2 * i, run, has_times);
        add_side(m, step->contacts[i].body_b, 2 * i + 1, run, has_times);
    }
}

/* The impulse of a side on its body, N s. */
static pl_vec impulse_of(const pl_step *step, int side)
{
    const pl_vec impulse = pl_vec_of(step->contacts[side / 2].impulse);
    return side % 2 == 1 ? impulse : pl_vec_scale(impulse, -1);
}

pl_vec pl_contact_motion_add_impulses(const pl_contact_motion *m, const pl_step *step, int body,
                                      pl_vec sum)
{
    for (int side = m->bodies[body].first_side; side != NONE; side = m->next[side]) {
        sum = pl_vec_add(sum, impulse_of(step, side));
    }
    return sum;
}

/* ---- A body ---- */

static void advance(const pl_contact_motion *m, const double inertia[3], double to, track *t)
{
    const double dt = fmax(to - t->time, 0);
    t->v = pl_vec_mad(t->v, dt, m->gravity);
    rotate_freely(&t->axes, inertia, t->momentum, dt);
    t->time = fmax(to, t->time);
}

/* Takes a body through a solve. */
static void follow_solve(const pl_contact_motion *m, const pl_step *step, const pl_body *body,
                         solve *s, track *t)
{
    const double *inertia = body->inertia;
    const pl_contact_time *first = &step->times[s->first / 2];
    const int end = s->next == NONE ? NONE : m->solves[s->next].first;
    pl_vec impulse = {0, 0, 0}, angular = {0, 0, 0};
    advance(m, inertia, first->begin, t);
    for (int side = s->first; side != end; side = m->next[side]) {
        const pl_contact_place *acts = &step->times[side / 2].acts;
        const pl_vec arm = pl_vec_of(side % 2 == 1 ? acts->arm_b : acts->arm_a);
        const pl_vec part = impulse_of(step, side);
        impulse = pl_vec_add(impulse, part);
        angular = pl_vec_add(angular, pl_vec_cross(arm, part));
    }
    const double dt = fmax(first->end - t->time, 0);
    pl_axes free = t->axes;
    rotate_freely(&free, inertia, t->momentum, dt);
    s->v = t->v;
    s->w = inertia_times(&t->axes, inertia, true, t->momentum);
    s->left_v = pl_vec_mad(pl_vec_mad(t->v, dt, m->gravity), 1 / body->mass, impulse);
    s->left_w = pl_vec_add(inertia_times(&free, inertia, true, t->momentum),
                           inertia_times(&t->axes, inertia, true, angular));
    rotate(&t->axes, pl_vec_scale(pl_vec_add(s->w, s->left_w), 0.5 * dt));
    t->v = s->left_v;
    t->momentum = pl_vec_add(t->momentum, angular);
    t->time = fmax(first->end, t->time);
}

/* Takes a body through the step, and compares the end that the impulses explain with the one
 * reported. */
static void follow_body(const pl_contact_motion *m, const pl_step *step, int index)
{
    const pl_body *body = &m->scene->bodies[index];
    const pl_body_state *before = &step->before[index], *after = &step->after[index];
    body_contacts *b = &m->bodies[index];
    track t = {.v = pl_vec_of(before->velocity),
               .axes = pl_principal_axes(&body->shape, before->orientation)};
    t.momentum = inertia_times(&t.axes, body->inertia, false, pl_vec_of(before->angular_velocity));
    for (int s = b->first_solve; s != NONE; s = m->solves[s].next) {
        follow_solve(m, step, body, &m->solves[s], &t);
    }
    advance(m, body->inertia, m->scene->dt, &t);
    const pl_axes axes = pl_principal_axes(&body->shape, after->orientation);
    b->rest_v = pl_vec_sub(pl_vec_of(after->velocity), t.v);
    b->rest_w = pl_vec_sub(pl_vec_of(after->angular_velocity),
                           inertia_times(&axes, body->inertia, true, t.momentum));
}

/* A step at work. */
typedef struct work {
    const pl_contact_motion *motion;
    const pl_step *step;
} work;

static void follow_bodies(void *context, int begin, int end)
{
    const work *w = context;
    for (int i = begin; i < end; ++i) {
        if (w->motion->bodies[i].first_solve != NONE) {
            follow_body(w->motion, w->step, i);
        }
    }
}

void pl_contact_motion_step(pl_contact_motion *m, const pl_step *step)
{
    list_sides(m, step);
    if (step->times != NULL) {
        pl_thread_pool_run(step->pool, m->scene->body_count, PIECE, follow_bodies,
                           &(work){m, step});
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
