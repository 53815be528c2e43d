#include "transform.h"

#include "plumb/vec.h"
#include "referee/geometry/gap.h"
#include "referee/geometry/solid.h"

#include <math.h>
#include <string.h>

/* All pairs of bodies are looked at. */
enum { MOST_BODIES = 5000 };

/* Of the size of the scene: how far apart bodies that touch may be. */
static const double TOUCHES = 1e-9;

/* ---- Motion ---- */

/* Turns q by the rotation vector w (rad, world frame), in place. */
static void turn(double q[4], pl_vec w)
{
    const double angle = pl_vec_length(w);
    const double s = angle > 0 ? sin(angle / 2) / angle : 0.5, c = cos(angle / 2);
    const pl_vec v = pl_vec_of(q + 1), u = pl_vec_scale(w, s);
    const double was = q[0];
    q[0] = c * was - pl_vec_dot(u, v);
    pl_vec_store(pl_vec_add(pl_vec_mad(pl_vec_scale(v, c), was, u), pl_vec_cross(u, v)), q + 1);
}

/* Moves the state on by t (s) with these constant accelerations. */
static void advance(const pl_shape *shape, pl_body_state *state, pl_vec linear, pl_vec angular,
                    double t)
{
    const pl_vec v = pl_vec_of(state->velocity), w = pl_vec_of(state->angular_velocity);
    const pl_vec centre = pl_centre_of_mass(shape, state->position, state->orientation);
    const pl_axes before = pl_axes_of(state->orientation);
    const pl_vec arm = pl_to_local(&before, pl_vec_sub(pl_vec_of(state->position), centre));
    const pl_vec moved = pl_vec_mad(pl_vec_scale(v, t), t * t / 2, linear);
    turn(state->orientation, pl_vec_mad(pl_vec_scale(w, t), t * t / 2, angular));
    if (pl_vec_length(arm) > 0) {
        const pl_axes after = pl_axes_of(state->orientation);
        pl_vec_store(pl_vec_add(pl_vec_add(centre, moved), pl_to_world(&after, arm)),
                     state->position);
    } else {
        pl_vec_store(pl_vec_add(pl_vec_of(state->position), moved), state->position);
    }
    pl_vec_store(pl_vec_mad(v, t, linear), state->velocity);
    pl_vec_store(pl_vec_mad(w, t, angular), state->angular_velocity);
}

void pl_state_between(const pl_body *body, const pl_body_state *now, const pl_body_state *next,
                      double dt, double fraction, pl_body_state *at)
{
    const pl_vec linear =
        pl_vec_scale(pl_vec_sub(pl_vec_of(next->velocity), pl_vec_of(now->velocity)), 1 / dt);
    const pl_vec angular = pl_vec_scale(
        pl_vec_sub(pl_vec_of(next->angular_velocity), pl_vec_of(now->angular_velocity)), 1 / dt);
    *at = *now;
    advance(&body->shape, at, linear, angular, fraction * dt);
}

/* ---- Known motions ---- */

/* A scene, and what is asked of it. */
typedef struct start {
    const pl_scene *scene;
    double time;    /* s, from the start to the late start */
    double touches; /* m */
    pl_vec up;      /* against gravity, unit; zero without gravity */
} start;

typedef enum motion { MOTION_UNKNOWN, MOTION_FREE, MOTION_UNIFORM, MOTION_REST } motion;

/* The shape of a body where it starts. */
static pl_placed_shape placed(const pl_body *body)
{
    pl_placed_shape shape = {.shape = &body->shape};
    memcpy(shape.position, body->position, sizeof shape.position);
    memcpy(shape.orientation, body->orientation, sizeof shape.orientation);
    return shape;
}

/* The largest distance that a point of the body moves in the time, m. */
static double reach_of(const start *s, const pl_body *body)
{
    const double speed =
        pl_vec_length(pl_vec_of(body->velocity)) +
        pl_vec_length(pl_vec_of(body->angular_velocity)) * pl_bounding_radius(&body->shape);
    const double gravity = pl_vec_length(pl_vec_of(s->scene->gravity));
    return body->is_static ? 0 : s->time * (speed + gravity * s->time / 2);
}

/* Whether two bodies may meet in the time. A gap that cannot be found counts as 0. */
static bool is_near(const start *s, const pl_body *a, const pl_body *b)
{
    const double reach = s->touches + reach_of(s, a) + reach_of(s, b);
    const pl_placed_shape shapes[2] = {placed(a), placed(b)};
    double gap = 0;
    if (a->shape.kind != PL_SHAPE_PLANE && b->shape.kind != PL_SHAPE_PLANE) {
        const pl_vec apart = pl_vec_sub(pl_centre_of_mass(&a->shape, a->position, a->orientation),
                                        pl_centre_of_mass(&b->shape, b->position, b->orientation));
        if (pl_vec_length(apart) >
            reach + pl_bounding_radius(&a->shape) + pl_bounding_radius(&b->shape)) {
            return false;
        }
    }
    return pl_gap(&shapes[0], &shapes[1], reach, &gap) != PL_OK || gap <= reach;
}

/* The height of the body's end along `up` (sign 1) or against it (sign -1), m. */
static double height(const start *s, const pl_body *body, const pl_body_state *state, double sign)
{
    const pl_shape *shape = &body->shape;
    if (shape->kind == PL_SHAPE_PLANE) {
        const double level = pl_vec_dot(pl_vec_of(shape->normal), s->up);
        return level > 1 - 1e-12 ? shape->offset : HUGE_VAL;
    }
    const pl_axes axes = pl_axes_of(state->orientation);
    const pl_vec local = pl_core_support(shape, pl_to_local(&axes, pl_vec_scale(s->up, sign)));
    return pl_vec_dot(pl_vec_add(pl_vec_of(state->position), pl_to_world(&axes, local)), s->up) +
           sign * pl_core_radius(shape);
}

/* Whether the centre of mass stands over the top of a support that the body touches. */
static bool is_carried(const start *s, const pl_body *body, const pl_body_state *state,
                       const pl_body *support)
{
    const double foot = height(s, body, state, -1);
    const pl_vec centre = pl_state_centre(body, state);
    const pl_shape probe = pl_shape_sphere(s->touches);
    pl_placed_shape below = {.shape = &probe, .orientation = {1, 0, 0, 0}};
    const pl_placed_shape top = placed(support);
    double gap = HUGE_VAL;
    pl_vec_store(pl_vec_mad(centre, foot - pl_vec_dot(centre, s->up), s->up), below.position);
    return pl_gap(&below, &top, s->touches, &gap) == PL_OK && gap <= s->touches;
}

/* Whether the body neither spins nor slides with friction on the support, or rolls on it. */
static bool is_uniform_on(const start *s, const pl_body *body, const pl_body *support)
{
    double friction = 0, restitution = 0;
    const pl_vec v = pl_vec_of(body->velocity), w = pl_vec_of(body->angular_velocity);
    const double speed = pl_vec_length(v);
    if (fabs(pl_vec_dot(v, s->up)) > TOUCHES * speed) {
        return false;
    }
    if (body->shape.kind == PL_SHAPE_SPHERE && pl_vec_length(w) > 0) {
        const pl_vec foot = pl_vec_cross(w, pl_vec_scale(s->up, -body->shape.radius));
        return pl_vec_length(pl_vec_add(v, foot)) <= TOUCHES * speed &&
               fabs(pl_vec_dot(w, s->up)) <= TOUCHES * pl_vec_length(w);
    }
    pl_scene_pair(s->scene, body->material, support->material, &friction, &restitution);
    return pl_vec_length(w) == 0 && (friction == 0 || speed == 0);
}

/* Whether a body that has others near it moves on uniformly, on top of all of them. */
static bool is_uniform(const start *s, int b)
{
    const pl_body *body = &s->scene->bodies[b];
    const pl_body_state begin = pl_body_start(body);
    const pl_vec none = {0, 0, 0};
    pl_body_state end = begin;
    bool is_carried_at_begin = false, is_carried_at_end = false;
    advance(&body->shape, &end, none, none, s->time);
    if (pl_vec_length(s->up) == 0 || pl_vec_length(pl_vec_of(body->velocity)) == 0) {
        return false;
    }
    for (int i = 0; i < s->scene->body_count; ++i) {
        const pl_body *support = &s->scene->bodies[i];
        if (i == b || !is_near(s, body, support)) {
            continue;
        }
        const pl_body_state other = pl_body_start(support);
        const double step = height(s, support, &other, 1) - height(s, body, &begin, -1);
        if (!support->is_static || !(fabs(step) <= s->touches) ||
            !is_uniform_on(s, body, support)) {
            return false;
        }
        is_carried_at_begin = is_carried_at_begin || is_carried(s, body, &begin, support);
        is_carried_at_end = is_carried_at_end || is_carried(s, body, &end, support);
    }
    return is_carried_at_begin && is_carried_at_end;
}

/* Whether the body does not move, no body near it moves, and the scene expects it to stay. */
static bool is_at_rest(const start *s, int b)
{
    const pl_scene *scene = s->scene;
    const pl_body *body = &scene->bodies[b];
    bool is_expected = false;
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        const pl_vec off = pl_vec_sub(pl_vec_of(rest->position), pl_vec_of(body->position));
        is_expected = is_expected || (rest->body == b && pl_vec_length(off) <= s->touches);
    }
    for (int i = 0; i < scene->body_count && is_expected; ++i) {
        const pl_body *other = &scene->bodies[i];
        const bool moves =
            !other->is_static && (pl_vec_length(pl_vec_of(other->velocity)) > 0 ||
                                  pl_vec_length(pl_vec_of(other->angular_velocity)) > 0);
        is_expected = !moves || (i != b && !is_near(s, body, other));
    }
    return is_expected;
}

/* Whether a free body keeps its angular velocity. */
static bool keeps_spin(const pl_body *body)
{
    const pl_axes axes = pl_principal_axes(&body->shape, body->orientation);
    const pl_vec w = pl_to_local(&axes, pl_vec_of(body->angular_velocity));
    const double *j = body->inertia;
    const pl_vec momentum = {j[0] * w.x, j[1] * w.y, j[2] * w.z};
    const double scale = pl_vec_length(w) * pl_vec_length(momentum);
    return pl_vec_length(pl_vec_cross(w, momentum)) <= 1e-12 * scale;
}

static motion motion_of(const start *s, int b)
{
    const pl_body *body = &s->scene->bodies[b];
    bool is_free = true;
    for (int i = 0; i < s->scene->body_count && is_free; ++i) {
        is_free = i == b || !is_near(s, body, &s->scene->bodies[i]);
    }
    if (is_free) {
        return keeps_spin(body) ? MOTION_FREE : MOTION_UNKNOWN;
    }
    return is_at_rest(s, b) ? MOTION_REST : is_uniform(s, b) ? MOTION_UNIFORM : MOTION_UNKNOWN;
}

static start start_of(const pl_scene *scene, double fraction)
{
    const pl_vec g = pl_vec_of(scene->gravity);
    const double strength = pl_vec_length(g);
    return (start){.scene = scene,
                   .time = fraction * scene->dt,
                   .touches = TOUCHES * pl_scene_size(scene),
                   .up = pl_vec_scale(g, strength > 0 ? -1 / strength : 0)};
}

/* Moves all bodies of `to`, a copy of the scene, on. Returns why that is not possible; NULL: it was done. */
static const char *move_on(const start *s, pl_scene *to)
{
    const pl_vec none = {0, 0, 0};
    if (to->force_count > 0) {
        return "forces act: the motion over a fraction of a step is not known";
    }
    if (pl_scene_steps(to) < 2 || to->body_count > MOST_BODIES) {
        return "the run has fewer than 2 steps, or the scene more than 5000 bodies";
    }
    for (int b = 0; b < to->body_count; ++b) {
        pl_body *body = &to->bodies[b];
        pl_body_state state = pl_body_start(body);
        const motion kind = body->is_static ? MOTION_REST : motion_of(s, b);
        if (kind == MOTION_UNKNOWN) {
            return "the motion over a fraction of a step is not known: some body neither flies "
                   "freely, nor rests, nor slides without friction or rolls on a level top";
        }
        if (kind != MOTION_REST) {
            advance(&body->shape, &state, kind == MOTION_FREE ? pl_vec_of(s->scene->gravity) : none,
                    none, s->time);
            pl_body_set_start(body, &state);
        }
    }
    to->duration = (double)(pl_scene_steps(to) - 1) * to->dt;
    return NULL;
}

pl_status pl_late_start(const pl_scene *from, double fraction, pl_scene *to, const char **reason,
                        pl_error *error)
{
    const start s = start_of(from, fraction);
    const pl_status status = pl_scene_copy_unjudged(from, to, error);
    *reason = status == PL_OK ? move_on(&s, to) : NULL;
    if (*reason != NULL) {
        pl_scene_free(to);
    }
    return status;
}
