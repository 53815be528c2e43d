/* Candidate pairs of a frame.
 *
 * The broad phase is sort and sweep: boxes are in ascending order of their lower ends along one
 * axis, and each is tested against those that follow until one begins beyond its upper end. The
 * order is kept from frame to frame and restored by insertion sort, which costs O(n + inversions).
 * Source: Baraff 1992; Cohen et al. 1995 (I-COLLIDE).
 *
 * Two bodies meet when their gap is at most
 *
 *   1e-3 r + h (|v_a - v_b| + r_a |w_a| + r_b |w_b|)
 *
 * with the bounding radii r, the smaller of them in the first term. The second term bounds how far
 * any two of their points can approach each other, or have moved apart, in a step of h at these
 * velocities: an engine may stop a body before it touches, or let it bounce off within the step.
 * The first term is for bodies at rest, which engines keep a little apart. */
#include "candidate_pairs.h"

#include "gap.h"
#include "solid.h"

#include <stdlib.h>
#include <string.h>

/* ---- Broad phase ---- */

/* Coordinate 0 is along the sort axis, 1 and 2 are across. */
typedef struct box {
    double low[3], high[3]; /* m */
    int body;
    bool is_static;
} box;

struct pl_broad_phase {
    const pl_scene *scene;
    box *boxes; /* (box_count), ascending along the sort axis */
    int box_count;
    int *planes; /* (plane_count), scene indices */
    int plane_count;
    int axis; /* sort axis: 0, 1, 2 for x, y, z */
};

/* Sets the box of a shape, enlarged by `margin` and by a little more than the rounding of poses and
 * gaps, so that no touching pair is lost. */
static void place_box(box *b, int axis, const pl_shape *shape, const double position[3],
                      const double orientation[4], double margin)
{
    double radius = pl_core_radius(shape);
    pl_axes axes = pl_axes_of(orientation);
    for (int k = 0; k < 3; ++k) {
        int from = (axis + k) % 3;
        const pl_vec unit = {from == 0, from == 1, from == 2};
        pl_vec up = pl_to_local(&axes, unit), down = pl_vec_scale(up, -1);
        double above = pl_vec_dot(up, pl_core_support(shape, up)) + radius;
        double below = pl_vec_dot(down, pl_core_support(shape, down)) + radius;
        double slack = margin + 1e-12 * (fabs(position[from]) + fmax(fabs(above), fabs(below)));
        b->low[k] = position[from] - below - slack;
        b->high[k] = position[from] + above + slack;
    }
}

/* The axis along which the bodies' centres vary most. */
static int widest_axis(const pl_scene *scene)
{
    int widest = 0;
    double most = -1;
    for (int k = 0; k < 3; ++k) {
        const pl_vec unit = {k == 0, k == 1, k == 2};
        double mean = 0, square = 0;
        int count = 0;
        for (int i = 0; i < scene->body_count; ++i) {
            const pl_body *body = &scene->bodies[i];
            if (body->shape.kind != PL_SHAPE_PLANE) {
                pl_vec centre = pl_centre_of_mass(&body->shape, body->position, body->orientation);
                double delta = pl_vec_dot(unit, centre) - mean;
                mean += delta / (count + 1);
                square += delta * delta * count / (count + 1);
                count += 1;
            }
        }
        if (square > most) {
            most = square;
            widest = k;
        }
    }
    return widest;
}

static bool comes_before(const box *a, const box *b)
{
    return a->low[0] < b->low[0] || (a->low[0] == b->low[0] && a->body < b->body);
}

static int compare_boxes(const void *a, const void *b)
{
    return comes_before(a, b) ? -1 : comes_before(b, a);
}

pl_broad_phase *pl_broad_phase_create(const pl_scene *scene, pl_arena *arena)
{
    size_t count = (size_t)scene->body_count;
    pl_broad_phase *bp = pl_arena_take(arena, 1, sizeof *bp);
    box *boxes = pl_arena_take(arena, count, sizeof *boxes);
    int *planes = pl_arena_take(arena, count, sizeof *planes);
    if (arena->failed) {
        return NULL;
    }
    *bp = (pl_broad_phase){
        .scene = scene, .boxes = boxes, .planes = planes, .axis = widest_axis(scene)};
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (body->shape.kind == PL_SHAPE_PLANE) {
            planes[bp->plane_count++] = i;
        } else {
            box *b = &boxes[bp->box_count++];
            *b = (box){.body = i, .is_static = body->is_static};
            place_box(b, bp->axis, &body->shape, body->position, body->orientation, 0);
        }
    }
    qsort(boxes, (size_t)bp->box_count, sizeof *boxes, compare_boxes);
    return bp;
}

/* Moves the boxes to their bodies and restores their order. */
static void follow(pl_broad_phase *bp, const pl_body_state *bodies, const double *margin)
{
    for (int i = 0; i < bp->box_count; ++i) {
        box moved = bp->boxes[i];
        if (!moved.is_static) {
            const pl_body_state *state = &bodies[moved.body];
            place_box(&moved, bp->axis, &bp->scene->bodies[moved.body].shape, state->position,
                      state->orientation, margin == NULL ? 0 : margin[moved.body]);
        }
        int k = i;
        for (; k > 0 && comes_before(&moved, &bp->boxes[k - 1]); --k) {
            bp->boxes[k] = bp->boxes[k - 1];
        }
        bp->boxes[k] = moved;
    }
}

static bool overlap_across(const box *a, const box *b)
{
    return a->low[1] <= b->high[1] && b->low[1] <= a->high[1] && a->low[2] <= b->high[2] &&
           b->low[2] <= a->high[2];
}

void pl_broad_phase_each_pair(pl_broad_phase *broad_phase, const pl_body_state *bodies,
                              const double *margin,
                              void (*see)(void *context, int body_a, int body_b), void *context)
{
    follow(broad_phase, bodies, margin);
    const box *end = broad_phase->boxes + broad_phase->box_count;
    for (const box *a = broad_phase->boxes; a < end; ++a) {
        for (const box *b = a + 1; b < end && b->low[0] <= a->high[0]; ++b) {
            if (!(a->is_static && b->is_static) && overlap_across(a, b)) {
                see(context, a->body, b->body);
            }
        }
    }
    for (int i = 0; i < broad_phase->plane_count; ++i) {
        for (const box *b = broad_phase->boxes; b < end; ++b) {
            if (!b->is_static) {
                see(context, broad_phase->planes[i], b->body);
            }
        }
    }
}

/* ---- Surfaces ---- */

static bool has_surface(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_BOX || shape->kind == PL_SHAPE_CAPSULE ||
           shape->kind == PL_SHAPE_HULL || shape->kind == PL_SHAPE_MESH;
}

static bool same_surface(const pl_shape *a, const pl_shape *b)
{
    return a->kind == b->kind && a->polyhedron == b->polyhedron &&
           a->half_height == b->half_height && a->half_extents[0] == b->half_extents[0] &&
           a->half_extents[1] == b->half_extents[1] && a->half_extents[2] == b->half_extents[2];
}

/* Makes the surfaces, (body_count), that bodies need to be measured against meshes. Equal shapes
 * share a surface. A scene without a mesh has none. */
static bool make_surfaces(const pl_scene *scene, pl_arena *arena, const pl_surface **surfaces)
{
    int *firsts = pl_arena_take(arena, (size_t)scene->body_count, sizeof *firsts);
    int count = 0; /* of firsts: the first bodies with their shapes */
    bool any_mesh = false;
    for (int i = 0; i < scene->body_count; ++i) {
        any_mesh = any_mesh || scene->bodies[i].shape.kind == PL_SHAPE_MESH;
    }
    for (int i = 0; i < scene->body_count && any_mesh && !arena->failed; ++i) {
        const pl_shape *shape = &scene->bodies[i].shape;
        if (!has_surface(shape)) {
            continue;
        }
        int k = count - 1;
        while (k >= 0 && !same_surface(&scene->bodies[firsts[k]].shape, shape)) {
            --k;
        }
        if (k >= 0) {
            surfaces[i] = surfaces[firsts[k]];
        } else {
            (void)pl_surface_create(shape, arena, &surfaces[i]);
            firsts[count++] = i;
        }
    }
    return !arena->failed;
}

/* ---- Candidate pairs ---- */

static const double RESTING_GAP = 1e-3; /* of the smaller bounding radius */

struct pl_candidate_pairs {
    const pl_scene *scene;
    pl_broad_phase *broad_phase;
    const pl_surface **surfaces; /* (body_count): NULL where none is needed */
    double *radius;              /* (body_count): bounding radii, m */
    double *margin; /* (body_count), m: a pair that meets has at most the sum of both as its gap */
};

/* One frame. */
typedef struct frame {
    const pl_candidate_pairs *pairs;
    const pl_body_state *bodies;
    void (*see)(void *context, const pl_near_pair *pair);
    void *context;
} frame;

pl_candidate_pairs *pl_candidate_pairs_create(const pl_scene *scene, pl_arena *arena)
{
    size_t count = (size_t)scene->body_count;
    pl_candidate_pairs *p = pl_arena_take(arena, 1, sizeof *p);
    if (p == NULL) {
        return NULL;
    }
    *p = (pl_candidate_pairs){.scene = scene,
                              .broad_phase = pl_broad_phase_create(scene, arena),
                              .surfaces = pl_arena_take(arena, count, sizeof(const pl_surface *)),
                              .radius = pl_arena_take(arena, count, sizeof *p->radius),
                              .margin = pl_arena_take(arena, count, sizeof *p->margin)};
    if (arena->failed || !make_surfaces(scene, arena, p->surfaces)) {
        return NULL;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        p->radius[i] = pl_bounding_radius(&scene->bodies[i].shape);
    }
    return p;
}

/* Static bodies are where the scene has them, whatever the engine reports. */
static pl_placed_shape place(const frame *f, int body)
{
    const pl_body *b = &f->pairs->scene->bodies[body];
    const pl_body_state *state = &f->bodies[body];
    pl_placed_shape placed = {.shape = &b->shape, .surface = f->pairs->surfaces[body]};
    memcpy(placed.position, b->is_static ? b->position : state->position, sizeof placed.position);
    memcpy(placed.orientation, b->is_static ? b->orientation : state->orientation,
           sizeof placed.orientation);
    return placed;
}

/* Static bodies do not move either. */
static pl_vec velocity_of(const frame *f, int body)
{
    const bool is_static = f->pairs->scene->bodies[body].is_static;
    return is_static ? (pl_vec){0, 0, 0} : pl_vec_of(f->bodies[body].velocity);
}

static double turning_speed(const frame *f, int body)
{
    const bool is_static = f->pairs->scene->bodies[body].is_static;
    const double spin = pl_vec_length(pl_vec_of(f->bodies[body].angular_velocity));
    return is_static ? 0 : f->pairs->radius[body] * spin;
}

static pl_vec centre_of(const frame *f, int body)
{
    return pl_state_centre(&f->pairs->scene->bodies[body], &f->bodies[body]);
}

static bool is_far(const frame *f, int a, int b)
{
    const pl_candidate_pairs *p = f->pairs;
    pl_vec c = pl_vec_sub(centre_of(f, a), centre_of(f, b));
    return pl_vec_length(c) > p->radius[a] + p->radius[b] + p->margin[a] + p->margin[b];
}

/* The largest gap at which two bodies meet, m. A plane has no size, and its partner's counts. */
static double meeting_gap(const frame *f, int a, int b)
{
    const pl_candidate_pairs *p = f->pairs;
    const double size = fmin(p->radius[a] > 0 ? p->radius[a] : HUGE_VAL,
                             p->radius[b] > 0 ? p->radius[b] : HUGE_VAL);
    const double speed = pl_vec_length(pl_vec_sub(velocity_of(f, a), velocity_of(f, b))) +
                         turning_speed(f, a) + turning_speed(f, b);
    return RESTING_GAP * size + p->scene->dt * speed;
}

static void see_pair(void *context, int a, int b)
{
    const frame *f = context;
    const pl_body *bodies = f->pairs->scene->bodies;
    if (!bodies[a].is_static && !bodies[b].is_static && is_far(f, a, b)) {
        return;
    }
    const double within = meeting_gap(f, a, b);
    pl_placed_shape placed_a = place(f, a), placed_b = place(f, b);
    pl_near_pair pair = {.a = a, .b = b};
    pair.status = pl_gap(&placed_a, &placed_b, within, &pair.gap);
    pair.meets = !(pair.status == PL_OK && pair.gap > within);
    f->see(f->context, &pair);
}

void pl_candidate_pairs_each(pl_candidate_pairs *p, const pl_body_state *bodies,
                             void (*see)(void *context, const pl_near_pair *pair), void *context)
{
    frame f = {.pairs = p, .bodies = bodies, .see = see, .context = context};
    for (int i = 0; i < p->scene->body_count; ++i) {
        if (!p->scene->bodies[i].is_static) {
            double speed = pl_vec_length(pl_vec_of(bodies[i].velocity)) + turning_speed(&f, i);
            p->margin[i] = RESTING_GAP * p->radius[i] + p->scene->dt * speed;
        }
    }
    pl_broad_phase_each_pair(p->broad_phase, bodies, p->margin, see_pair, &f);
}
