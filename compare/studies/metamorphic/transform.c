/* Transforms of scenes, restarts and the offset of far copies. */
#include "transform.h"

#include "base/heap.h"
#include "plumb/vec.h"
#include "referee/geometry/solid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Transforms ---- */

pl_transform pl_transform_identity(void)
{
    return (pl_transform){
        .matrix = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .turn = {1, 0, 0, 0}, .scale = 1};
}

/* The cosine of so many sixteenths of a turn, from square roots only. */
static double cosine(int sixteenths)
{
    const double half = sqrt(0.5);
    const double quarter[5] = {1, sqrt((1 + half) / 2), half, sqrt((1 - half) / 2), 0};
    int k = ((sixteenths % 16) + 16) % 16;
    k = k > 8 ? 16 - k : k;
    return k <= 4 ? quarter[k] : -quarter[8 - k];
}

pl_transform pl_transform_rotation(int axis, int eighths)
{
    pl_transform t = pl_transform_identity();
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const double c = cosine(2 * eighths), s = cosine(2 * eighths - 4);
    t.matrix[a][a] = c;
    t.matrix[a][b] = -s;
    t.matrix[b][a] = s;
    t.matrix[b][b] = c;
    t.turn[0] = cosine(eighths);
    t.turn[1 + axis] = cosine(eighths - 4);
    return t;
}

pl_transform pl_transform_mirror(void)
{
    pl_transform t = pl_transform_identity();
    t.matrix[1][1] = -1;
    t.mirrored = true;
    return t;
}

static int greatest_common_divisor(int a, int b)
{
    while (b != 0) {
        int rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* The shuffled order is i -> (k i + k) mod n, a permutation because k, near 0.62 n, and n are
 * coprime. */
int pl_transform_index(const pl_transform *transform, int body, int body_count)
{
    if (transform->order == PL_ORDER_REVERSED) {
        return body_count - 1 - body;
    }
    if (transform->order == PL_ORDER_SAME || body_count < 2) {
        return body;
    }
    int k = (int)(0.62 * body_count) + 1;
    while (greatest_common_divisor(k, body_count) != 1) {
        ++k;
    }
    return (int)(((long long)k * body + k) % body_count);
}

/* ---- Vectors and orientations ---- */

/* factor M v, in place. */
static void apply(const pl_transform *t, double factor, double v[3])
{
    const double was[3] = {v[0], v[1], v[2]};
    for (int i = 0; i < 3; ++i) {
        const double *row = t->matrix[i];
        v[i] = factor * (row[0] * was[0] + row[1] * was[1] + row[2] * was[2]);
    }
}

/* M^T v / divisor */
static void apply_inverse(const pl_transform *t, double divisor, const double v[3], double out[3])
{
    for (int i = 0; i < 3; ++i) {
        out[i] =
            (t->matrix[0][i] * v[0] + t->matrix[1][i] * v[1] + t->matrix[2][i] * v[2]) / divisor;
    }
}

/* The components along the body's own axes times s, and -s along y in the mirror, in place. */
static void stretch(const pl_transform *t, double s, double v[3])
{
    v[0] *= s;
    v[1] *= t->mirrored ? -s : s;
    v[2] *= s;
}

/* Hamilton's product a b. */
static void multiply(const double a[4], const double b[4], double out[4])
{
    out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

/* The mirror image of a rotation R is S R S with S = diag(1, -1, 1): its axis is a pseudovector. */
static void mirror_orientation(double q[4])
{
    q[1] = -q[1];
    q[3] = -q[3];
}

void pl_transform_state_back(const pl_transform *transform, const pl_body_state *from,
                             pl_body_state *to)
{
    const pl_transform *t = transform;
    const double time = sqrt(t->scale);
    const double place[3] = {from->position[0] - t->shift[0], from->position[1] - t->shift[1],
                             from->position[2] - t->shift[2]};
    apply_inverse(t, t->scale, place, to->position);
    apply_inverse(t, time, from->velocity, to->velocity);
    apply_inverse(t, (t->mirrored ? -1 : 1) / time, from->angular_velocity, to->angular_velocity);
    if (t->mirrored) {
        memcpy(to->orientation, from->orientation, sizeof to->orientation);
        mirror_orientation(to->orientation);
    } else {
        const double back[4] = {t->turn[0], -t->turn[1], -t->turn[2], -t->turn[3]};
        multiply(back, from->orientation, to->orientation);
    }
}

pl_body_state pl_body_start(const pl_body *body)
{
    pl_body_state state;
    memcpy(state.position, body->position, sizeof state.position);
    memcpy(state.orientation, body->orientation, sizeof state.orientation);
    memcpy(state.velocity, body->velocity, sizeof state.velocity);
    memcpy(state.angular_velocity, body->angular_velocity, sizeof state.angular_velocity);
    return state;
}

void pl_body_set_start(pl_body *body, const pl_body_state *state)
{
    memcpy(body->position, state->position, sizeof body->position);
    memcpy(body->orientation, state->orientation, sizeof body->orientation);
    memcpy(body->velocity, state->velocity, sizeof body->velocity);
    memcpy(body->angular_velocity, state->angular_velocity, sizeof body->angular_velocity);
}

/* ---- Scenes ---- */

pl_status pl_scene_copy_unjudged(const pl_scene *from, pl_scene *to, pl_error *error)
{
    pl_scene test_case = *from;
    test_case.rest_count = 0;
    test_case.travel_count = 0;
    test_case.value_count = 0;
    test_case.statistic_count = 0;
    test_case.same_bits = false;
    test_case.primary_error[0] = '\0';
    test_case.collapse_distance = test_case.acceptance = (double)INFINITY;
    *to = pl_scene_default();
    char *text = pl_scene_to_text(&test_case);
    if (text == NULL) {
        pl_out_of_memory();
    }
    const pl_status status = pl_scene_read_text(text, strlen(text), from->name, to, error);
    free(text);
    return status;
}

static void multiply_all(double v[3], double factor)
{
    for (int i = 0; i < 3; ++i) {
        v[i] *= factor;
    }
}

static void transform_shape(const pl_transform *t, pl_shape *shape)
{
    shape->radius *= t->scale;
    shape->half_height *= t->scale;
    multiply_all(shape->half_extents, t->scale);
    if (shape->kind == PL_SHAPE_PLANE) {
        apply(t, 1, shape->normal);
        shape->offset *= t->scale;
        for (int i = 0; i < 3; ++i) {
            shape->offset += shape->normal[i] * t->shift[i];
        }
    }
}

/* The frame of a hull or a mesh is mirrored with the world, but does not turn with it. The other
 * shapes are their own mirror images in their own frames. */
static void transform_polyhedron(const pl_transform *t, pl_polyhedron *p)
{
    const double s = t->scale;
    for (int i = 0; i < p->vertex_count; ++i) {
        stretch(t, s, p->vertices[i]);
    }
    for (int i = 0; i < p->triangle_count && t->mirrored; ++i) {
        int second = p->triangles[i][1];
        p->triangles[i][1] = p->triangles[i][2];
        p->triangles[i][2] = second;
    }
    stretch(t, s, p->centre);
    multiply_all(p->inertia, s * s);
    p->volume *= s * s * s;
    p->radius *= s;
    if (t->mirrored) {
        mirror_orientation(p->axes);
    }
}

static void transform_body(const pl_transform *t, pl_body *body)
{
    const double s = t->scale, time = sqrt(s), *q = body->orientation;
    transform_shape(t, &body->shape);
    if (body->shape.kind == PL_SHAPE_PLANE) {
        return;
    }
    body->mass *= s * s * s;
    multiply_all(body->inertia, s * s * s * s * s);
    apply(t, s, body->position);
    pl_vec_store(pl_vec_add(pl_vec_of(body->position), pl_vec_of(t->shift)), body->position);
    if (t->mirrored) {
        mirror_orientation(body->orientation);
    } else {
        multiply(t->turn, (const double[]){q[0], q[1], q[2], q[3]}, body->orientation);
    }
    apply(t, time, body->velocity);
    apply(t, (t->mirrored ? -1 : 1) / time, body->angular_velocity);
}

static void transform_force(const pl_transform *t, pl_force *force)
{
    const double s = t->scale, time = sqrt(s);
    void (*const carry)(const pl_transform *, double, double *) =
        force->frame == PL_FRAME_WORLD ? apply : stretch;
    carry(t, s * s * s, force->force);
    carry(t, s, force->at);
    force->from *= time;
    force->until *= time;
}

static void transform_scene(const pl_transform *t, pl_scene *scene)
{
    const double time = sqrt(t->scale);
    apply(t, 1, scene->gravity);
    scene->dt *= time;
    scene->duration *= time;
    for (int i = 0; i < scene->polyhedron_count; ++i) {
        transform_polyhedron(t, scene->polyhedra[i]);
    }
    for (int i = 0; i < scene->body_count; ++i) {
        transform_body(t, &scene->bodies[i]);
    }
    for (int i = 0; i < scene->force_count; ++i) {
        transform_force(t, &scene->forces[i]);
    }
}

/* ---- Copies, other orders of the bodies ---- */

/* Adds a copy of every body except planes, and of their forces. */
static pl_status add_copies(const pl_transform *t, pl_scene *scene, pl_error *error)
{
    const int body_count = scene->body_count, force_count = scene->force_count;
    int *copy_of = pl_heap_new((size_t)body_count, sizeof *copy_of);
    pl_status status = PL_OK;
    for (int i = 0; i < body_count && status == PL_OK; ++i) {
        pl_body body = scene->bodies[i];
        if (body.shape.kind != PL_SHAPE_PLANE) {
            snprintf(body.name, sizeof body.name, "copy of body %d", i);
            for (int k = 0; k < 3; ++k) {
                body.position[k] += t->copy_offset[k];
            }
            status = pl_scene_add_body(scene, &body, &copy_of[i], error);
        }
    }
    for (int i = 0; i < force_count && status == PL_OK; ++i) {
        pl_force force = scene->forces[i];
        force.body = copy_of[force.body];
        status = pl_scene_add_force(scene, &force, error);
    }
    free(copy_of);
    return status == PL_OK ? pl_scene_validate(scene, error) : status;
}

static void reorder(const pl_transform *t, pl_scene *scene)
{
    const int count = scene->body_count;
    pl_body *bodies = pl_heap_new((size_t)count, sizeof *bodies);
    memcpy(bodies, scene->bodies, (size_t)count * sizeof *bodies);
    for (int i = 0; i < count; ++i) {
        scene->bodies[pl_transform_index(t, i, count)] = bodies[i];
    }
    free(bodies);
    for (int i = 0; i < scene->force_count; ++i) {
        scene->forces[i].body = pl_transform_index(t, scene->forces[i].body, count);
    }
}

pl_status pl_transform_scene(const pl_transform *transform, const pl_scene *from, pl_scene *to,
                             pl_error *error)
{
    pl_status status = pl_scene_copy_unjudged(from, to, error);
    if (status == PL_OK && transform->has_copy) {
        status = add_copies(transform, to, error);
    }
    if (status == PL_OK && transform->order != PL_ORDER_SAME) {
        reorder(transform, to);
    }
    if (status == PL_OK) {
        transform_scene(transform, to);
    } else {
        pl_scene_free(to);
    }
    return status;
}

/* ---- Restarts ---- */

/* A force counts as ended by the same millionth of a step that decides whether it acts. */
static void move_forces(pl_scene *scene, double time)
{
    int kept = 0;
    for (int i = 0; i < scene->force_count; ++i) {
        pl_force force = scene->forces[i];
        force.from = fmax(force.from - time, 0);
        force.until -= time;
        if (force.until > 1e-6 * scene->dt) {
            scene->forces[kept++] = force;
        }
    }
    scene->force_count = kept;
}

pl_status pl_restart_scene(const pl_scene *from, const pl_body_state *states, long step,
                           pl_scene *to, pl_error *error)
{
    pl_status status = pl_scene_copy_unjudged(from, to, error);
    if (status != PL_OK) {
        return status;
    }
    for (int i = 0; i < to->body_count; ++i) {
        if (!to->bodies[i].is_static) {
            pl_body_set_start(&to->bodies[i], &states[i]);
        }
    }
    move_forces(to, (double)step * to->dt);
    to->duration = (double)(pl_scene_steps(from) - step) * to->dt;
    return PL_OK;
}

/* ---- Far copies ---- */

/* The sine up to which a normal counts as orthogonal to a direction. */
static const double ORTHOGONAL = 1e-12;

double pl_scene_size(const pl_scene *scene)
{
    pl_vec low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (!body->is_static) {
            double r = pl_bounding_radius(&body->shape);
            pl_vec c = pl_centre_of_mass(&body->shape, body->position, body->orientation);
            low = (pl_vec){fmin(low.x, c.x - r), fmin(low.y, c.y - r), fmin(low.z, c.z - r)};
            high = (pl_vec){fmax(high.x, c.x + r), fmax(high.y, c.y + r), fmax(high.z, c.z + r)};
        }
    }
    return high.x > low.x ? pl_vec_length(pl_vec_sub(high, low)) : 1;
}

static bool fits(const pl_scene *scene, pl_vec direction)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_shape *shape = &scene->bodies[i].shape;
        if (shape->kind == PL_SHAPE_PLANE &&
            fabs(pl_vec_dot(pl_vec_of(shape->normal), direction)) > ORTHOGONAL) {
            return false;
        }
    }
    return true;
}

/* The axes are tried first, because along them the copy's positions are rounded least. Otherwise at
 * most one direction is orthogonal to the normals of two planes; with one plane, it is the
 * horizontal line in it. */
static bool find_direction(const pl_scene *scene, pl_vec *direction)
{
    static const pl_vec axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    pl_vec first = {0, 0, 0};
    for (int i = 0; i < 3; ++i) {
        *direction = axes[i];
        if (fits(scene, *direction)) {
            return true;
        }
    }
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_shape *shape = &scene->bodies[i].shape;
        if (shape->kind == PL_SHAPE_PLANE) {
            pl_vec n = pl_vec_of(shape->normal);
            pl_vec other = pl_vec_length(first) > 0 ? first : axes[2];
            pl_vec across = pl_vec_cross(n, other);
            double length = pl_vec_length(across);
            *direction = pl_vec_scale(across, length > 0 ? 1 / length : 0);
            if (length > ORTHOGONAL && fits(scene, *direction)) {
                return true;
            }
            first = pl_vec_length(first) > 0 ? first : n;
        }
    }
    return false;
}

bool pl_far_offset(const pl_scene *scene, double sizes, double offset[3])
{
    pl_vec direction = {0, 0, 0};
    bool found = find_direction(scene, &direction);
    pl_vec_store(pl_vec_scale(direction, sizes * pl_scene_size(scene)), offset);
    return found;
}
