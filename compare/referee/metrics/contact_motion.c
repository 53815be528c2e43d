#include "contact_motion.h"

#include "referee/geometry/solid.h"

#include <string.h>

/* Parts of an interval of free rotation, each a midpoint rule. */
enum { ROTATION_PARTS = 4 };

/* Of the step: intervals that end this near to its end are the last. */
static const double LAST = 1e-9;

/* A body on its way through the step. */
typedef struct track {
    double time;        /* s since the start of the step */
    pl_vec v, momentum; /* m/s; angular about the centre of mass, N m s, world */
    pl_axes axes;       /* principal */

    bool open;               /* has a contact in the solve at hand */
    bool found;              /* left_v and left_w are those of the solve */
    double end;              /* s, of the solve */
    pl_vec impulse, angular; /* N s, N m s: of the solve, so far */
    pl_vec left_v, left_w;   /* the velocities that it leaves, m/s, rad/s */

    pl_vec rest_v, rest_w; /* what the step's end has besides, m/s, rad/s */
} track;

struct pl_contact_motion {
    const pl_scene *scene;
    pl_vec gravity;
    track *tracks; /* (body_count) */
};

pl_contact_motion *pl_contact_motion_create(const pl_scene *scene, pl_arena *arena)
{
    pl_contact_motion *m = pl_arena_take(arena, 1, sizeof *m);
    if (m == NULL) {
        return NULL;
    }
    m->scene = scene;
    m->gravity = pl_vec_of(scene->gravity);
    m->tracks = pl_arena_take(arena, (size_t)scene->body_count, sizeof *m->tracks);
    return m->tracks != NULL ? m : NULL;
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

/* ---- A solve ---- */

static void advance(const pl_contact_motion *m, int body, double to)
{
    track *t = &m->tracks[body];
    const double dt = fmax(to - t->time, 0);
    t->v = pl_vec_mad(t->v, dt, m->gravity);
    rotate_freely(&t->axes, m->scene->bodies[body].inertia, t->momentum, dt);
    t->time = fmax(to, t->time);
}

/* Adds one body's part of a contact's impulse to the solve. */
static void add_impulse(const pl_contact_motion *m, int body, const pl_contact_time *time,
                        const double arm[3], pl_vec impulse)
{
    track *t = &m->tracks[body];
    if (m->scene->bodies[body].is_static) {
        return;
    }
    if (!t->open) {
        advance(m, body, time->begin);
        t->open = true;
        t->found = false;
        t->end = time->end;
        t->impulse = t->angular = (pl_vec){0, 0, 0};
    }
    t->impulse = pl_vec_add(t->impulse, impulse);
    t->angular = pl_vec_add(t->angular, pl_vec_cross(pl_vec_of(arm), impulse));
}

/* Sets the velocities that the solve leaves to a body, without what the step's end has besides. */
static void find_left(const pl_contact_motion *m, int index)
{
    const pl_body *body = &m->scene->bodies[index];
    track *t = &m->tracks[index];
    if (!t->open || t->found) {
        return;
    }
    t->found = true;
    const double dt = fmax(t->end - t->time, 0);
    pl_axes free = t->axes;
    rotate_freely(&free, body->inertia, t->momentum, dt);
    t->left_v = pl_vec_mad(pl_vec_mad(t->v, dt, m->gravity), 1 / body->mass, t->impulse);
    t->left_w = pl_vec_add(inertia_times(&free, body->inertia, true, t->momentum),
                           inertia_times(&t->axes, body->inertia, true, t->angular));
}

/* Takes the body to the end of the solve. */
static void close_solve(const pl_contact_motion *m, int index)
{
    const double *inertia = m->scene->bodies[index].inertia;
    track *t = &m->tracks[index];
    if (t->open) {
        const pl_vec before = inertia_times(&t->axes, inertia, true, t->momentum);
        const double dt = fmax(t->end - t->time, 0);
        rotate(&t->axes, pl_vec_scale(pl_vec_add(before, t->left_w), 0.5 * dt));
        t->v = t->left_v;
        t->momentum = pl_vec_add(t->momentum, t->angular);
        t->time = fmax(t->end, t->time);
        t->open = false;
    }
}

/* Adds the velocities of one body's point, with a sign. `last`: the solve ends with the step. */
static void add_point_velocity(const pl_contact_motion *m, int index, double sign,
                               const double acts[3], const double holds[3], bool last,
                               pl_contact_velocity *u)
{
    const pl_body *body = &m->scene->bodies[index];
    const track *t = &m->tracks[index];
    if (body->is_static) {
        return;
    }
    const pl_vec v = last ? pl_vec_add(t->left_v, t->rest_v) : t->left_v;
    const pl_vec w = last ? pl_vec_add(t->left_w, t->rest_w) : t->left_w;
    const pl_vec before = inertia_times(&t->axes, body->inertia, true, t->momentum);
    const pl_vec mean_v = pl_vec_scale(pl_vec_add(v, t->v), 0.5);
    const pl_vec mean_w = pl_vec_scale(pl_vec_add(w, before), 0.5);
    u->left = pl_vec_mad(u->left, sign, pl_vec_add(v, pl_vec_cross(w, pl_vec_of(holds))));
    u->mean = pl_vec_mad(u->mean, sign, pl_vec_add(mean_v, pl_vec_cross(mean_w, pl_vec_of(acts))));
}

/* ---- A step ---- */

static void begin_step(pl_contact_motion *m, const pl_step *step)
{
    for (int i = 0; i < m->scene->body_count; ++i) {
        const pl_body *body = &m->scene->bodies[i];
        const pl_body_state *before = &step->before[i];
        track *t = &m->tracks[i];
        t->time = 0;
        t->open = false;
        if (!body->is_static) {
            t->v = pl_vec_of(before->velocity);
            t->axes = pl_principal_axes(&body->shape, before->orientation);
            t->momentum =
                inertia_times(&t->axes, body->inertia, false, pl_vec_of(before->angular_velocity));
        }
    }
}

/* Follows the step, and visits its contacts unless `visit` is NULL. */
static void follow(pl_contact_motion *m, const pl_step *step, pl_contact_visit *visit,
                   void *context)
{
    const double last = (1 - LAST) * m->scene->dt;
    begin_step(m, step);
    for (int first = 0, end; first < step->contact_count; first = end) {
        for (end = first;
             end < step->contact_count && step->times[end].order == step->times[first].order;
             ++end) {
            const pl_contact *c = &step->contacts[end];
            const pl_contact_time *time = &step->times[end];
            const pl_vec impulse = pl_vec_of(c->impulse);
            add_impulse(m, c->body_a, time, time->acts.arm_a, pl_vec_scale(impulse, -1));
            add_impulse(m, c->body_b, time, time->acts.arm_b, impulse);
        }
        for (int i = first; i < end; ++i) {
            find_left(m, step->contacts[i].body_a);
            find_left(m, step->contacts[i].body_b);
        }
        for (int i = first; i < end && visit != NULL; ++i) {
            const pl_contact *c = &step->contacts[i];
            const pl_contact_place *acts = &step->times[i].acts, *holds = &step->times[i].holds;
            const bool at_end = step->times[i].end >= last;
            pl_contact_velocity u = {{0, 0, 0}, {0, 0, 0}};
            add_point_velocity(m, c->body_a, -1, acts->arm_a, holds->arm_a, at_end, &u);
            add_point_velocity(m, c->body_b, 1, acts->arm_b, holds->arm_b, at_end, &u);
            visit(context, i, &u);
        }
        for (int i = first; i < end; ++i) {
            close_solve(m, step->contacts[i].body_a);
            close_solve(m, step->contacts[i].body_b);
        }
    }
}

/* Compares the end of the step that the impulses explain with the one reported. */
static void find_rest(pl_contact_motion *m, const pl_step *step)
{
    for (int i = 0; i < m->scene->body_count; ++i) {
        const pl_body *body = &m->scene->bodies[i];
        track *t = &m->tracks[i];
        if (!body->is_static) {
            advance(m, i, m->scene->dt);
            const pl_body_state *after = &step->after[i];
            const pl_axes axes = pl_principal_axes(&body->shape, after->orientation);
            t->rest_v = pl_vec_sub(pl_vec_of(after->velocity), t->v);
            t->rest_w = pl_vec_sub(pl_vec_of(after->angular_velocity),
                                   inertia_times(&axes, body->inertia, true, t->momentum));
        }
    }
}

void pl_contact_motion_step(pl_contact_motion *motion, const pl_step *step, pl_contact_visit *visit,
                            void *context)
{
    follow(motion, step, NULL, NULL);
    find_rest(motion, step);
    follow(motion, step, visit, context);
}
