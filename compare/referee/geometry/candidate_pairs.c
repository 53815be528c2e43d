/* Candidate pairs of a frame.
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

#include "base/parallel.h"
#include "gap.h"
#include "solid.h"

#include <string.h>

/* ---- Surfaces ---- */

static bool has_surface(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_BOX || shape->kind == PL_SHAPE_CAPSULE ||
           shape->kind == PL_SHAPE_HULL || shape->kind == PL_SHAPE_MESH;
}

static bool same_surface(const pl_shape *a, const pl_shape *b)
{
    return a->kind == b->kind && a->polyhedron == b->polyhedron &&
           a->half_height == b->half_height &&
           /* NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): of bits */
           memcmp(a->half_extents, b->half_extents, sizeof a->half_extents) == 0;
}

/* Makes the surfaces, (body_count), that bodies need to be measured against meshes. Equal shapes
 * share a surface. A scene without a mesh has none. */
static void make_surfaces(const pl_scene *scene, pl_arena *arena, const pl_surface **surfaces)
{
    bool any_mesh = false;
    for (int i = 0; i < scene->body_count; ++i) {
        any_mesh = any_mesh || scene->bodies[i].shape.kind == PL_SHAPE_MESH;
    }
    int *firsts = pl_arena_take(arena, (size_t)scene->body_count, sizeof *firsts);
    int count = 0; /* of different surfaces */
    for (int i = 0; i < scene->body_count && any_mesh; ++i) {
        const pl_shape *shape = &scene->bodies[i].shape;
        int k = has_surface(shape) ? 0 : count;
        while (k < count && !same_surface(&scene->bodies[firsts[k]].shape, shape)) {
            ++k;
        }
        if (k < count) {
            surfaces[i] = surfaces[firsts[k]];
        } else if (has_surface(shape)) {
            surfaces[i] = pl_surface_create(shape, arena);
            firsts[count++] = i;
        }
    }
}

/* ---- Candidate pairs ---- */

static const double RESTING_GAP = 1e-3; /* of the smaller bounding radius */

enum {
    PIECES = 64,  /* of a frame, for the threads */
    ROW_PAIRS = 8 /* for each row of the broad phase: room to begin with */
};

/* The pairs of some rows of the broad phase. */
typedef struct pair_piece {
    const pl_candidate_pairs *of;
    long begin, end;     /* rows */
    pl_near_pair *pairs; /* (capacity) */
    int count;           /* of all pairs, also of those for which there is no room */
    int capacity;
} pair_piece;

struct pl_candidate_pairs {
    const pl_scene *scene;
    pl_broad_phase *broad_phase;
    const pl_surface **surfaces; /* (body_count): NULL where none is needed */
    double *radius;              /* (body_count): bounding radii, m */
    double *margin; /* (body_count), m: a pair that meets has at most the sum of both as its gap */
    pair_piece pieces[PIECES];
    pl_arena *arena;
    pl_body_state
        *bodies; /* (body_count): the frame, but static bodies stay where the scene has them */
    bool has_frame;
    void (*meanwhile)(void *context);
    void *context;
};

pl_candidate_pairs *pl_candidate_pairs_create(const pl_scene *scene, pl_arena *arena)
{
    size_t count = (size_t)scene->body_count;
    pl_candidate_pairs *p = pl_arena_take(arena, 1, sizeof *p);
    *p = (pl_candidate_pairs){.scene = scene,
                              .broad_phase = pl_broad_phase_create(scene, arena),
                              .surfaces = pl_arena_take(arena, count, sizeof(const pl_surface *)),
                              .radius = pl_arena_take(arena, count, sizeof *p->radius),
                              .margin = pl_arena_take(arena, count, sizeof *p->margin),
                              .arena = arena,
                              .bodies = pl_arena_take(arena, count, sizeof *p->bodies)};
    make_surfaces(scene, arena, p->surfaces);
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        p->radius[i] = pl_bounding_radius(&body->shape);
        if (body->is_static) {
            memcpy(p->bodies[i].position, body->position, sizeof body->position);
            memcpy(p->bodies[i].orientation, body->orientation, sizeof body->orientation);
        }
    }
    const long rows = pl_broad_phase_rows(p->broad_phase);
    for (int i = 0; i < PIECES; ++i) {
        pair_piece *piece = &p->pieces[i];
        piece->of = p;
        piece->begin = rows * i / PIECES;
        piece->end = rows * (i + 1) / PIECES;
        pl_arena_reserve(arena, &piece->pairs, &piece->capacity,
                         ROW_PAIRS * (int)(piece->end - piece->begin), sizeof *piece->pairs);
    }
    return p;
}

static pl_placed_shape place(const pl_candidate_pairs *p, int body)
{
    const pl_body_state *state = &p->bodies[body];
    pl_placed_shape placed = {.shape = &p->scene->bodies[body].shape, .surface = p->surfaces[body]};
    memcpy(placed.position, state->position, sizeof placed.position);
    memcpy(placed.orientation, state->orientation, sizeof placed.orientation);
    return placed;
}

static double turning_speed(const pl_candidate_pairs *p, int body)
{
    return p->radius[body] * pl_vec_length(pl_vec_of(p->bodies[body].angular_velocity));
}

static pl_vec centre_of(const pl_candidate_pairs *p, int body)
{
    return pl_state_centre(&p->scene->bodies[body], &p->bodies[body]);
}

static bool is_far(const pl_candidate_pairs *p, int a, int b)
{
    pl_vec c = pl_vec_sub(centre_of(p, a), centre_of(p, b));
    return pl_vec_length(c) > p->radius[a] + p->radius[b] + p->margin[a] + p->margin[b];
}

/* The largest gap at which two bodies meet, m. A plane has no size, and its partner's counts. */
static double meeting_gap(const pl_candidate_pairs *p, int a, int b)
{
    const double size = fmin(p->radius[a] > 0 ? p->radius[a] : HUGE_VAL,
                             p->radius[b] > 0 ? p->radius[b] : HUGE_VAL);
    const pl_vec apart =
        pl_vec_sub(pl_vec_of(p->bodies[a].velocity), pl_vec_of(p->bodies[b].velocity));
    const double speed = pl_vec_length(apart) + turning_speed(p, a) + turning_speed(p, b);
    return RESTING_GAP * size + p->scene->dt * speed;
}

/* Whether the pair meets; it then gets its gap. */
static bool meet(const pl_candidate_pairs *p, int a, int b, pl_near_pair *pair)
{
    const pl_body *bodies = p->scene->bodies;
    if (!bodies[a].is_static && !bodies[b].is_static && is_far(p, a, b)) {
        return false;
    }
    const double within = meeting_gap(p, a, b);
    pl_placed_shape placed_a = place(p, a), placed_b = place(p, b);
    *pair = (pl_near_pair){.a = a, .b = b};
    pair->status = pl_gap(&placed_a, &placed_b, within, &pair->gap);
    return !(pair->status == PL_OK && pair->gap > within);
}

static void keep_pair(void *context, int a, int b)
{
    pair_piece *piece = context;
    pl_near_pair pair;
    if (meet(piece->of, a, b, &pair)) {
        if (piece->count < piece->capacity) {
            piece->pairs[piece->count] = pair;
        }
        piece->count += 1;
    }
}

static void fill_piece(pair_piece *piece)
{
    piece->count = 0;
    (void)pl_broad_phase_see(piece->of->broad_phase, piece->begin, piece->end, keep_pair, piece);
}

/* Item 0 is the caller's work. */
static void do_item(void *context, int item)
{
    pl_candidate_pairs *p = context;
    if (item > 0) {
        fill_piece(&p->pieces[item - 1]);
    } else if (p->meanwhile != NULL) {
        p->meanwhile(p->context);
    }
}

static void find_margins(pl_candidate_pairs *p)
{
    for (int i = 0; i < p->scene->body_count; ++i) {
        if (!p->scene->bodies[i].is_static) {
            const double speed =
                pl_vec_length(pl_vec_of(p->bodies[i].velocity)) + turning_speed(p, i);
            p->margin[i] = RESTING_GAP * p->radius[i] + p->scene->dt * speed;
        }
    }
}

/* Whether the frame differs from the last one. */
static bool take_frame(pl_candidate_pairs *p, const pl_body_state *bodies)
{
    bool differs = !p->has_frame;
    p->has_frame = true;
    for (int i = 0; i < p->scene->body_count; ++i) {
        if (!p->scene->bodies[i].is_static &&
            /* NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): of bits */
            memcmp(&p->bodies[i], &bodies[i], sizeof bodies[i]) != 0) {
            p->bodies[i] = bodies[i];
            differs = true;
        }
    }
    return differs;
}

void pl_candidate_pairs_find(pl_candidate_pairs *p, const pl_body_state *bodies, int threads,
                             void (*meanwhile)(void *context), void *context)
{
    p->meanwhile = meanwhile;
    p->context = context;
    if (!take_frame(p, bodies)) { /* the pieces have its pairs */
        do_item(p, 0);
        return;
    }
    find_margins(p);
    pl_broad_phase_follow(p->broad_phase, p->bodies, p->margin);
    pl_share_work(threads, 1 + PIECES, do_item, p);
    for (int i = 0; i < PIECES; ++i) {
        pair_piece *piece = &p->pieces[i];
        if (piece->count > piece->capacity) {
            pl_arena_reserve(p->arena, &piece->pairs, &piece->capacity, piece->count,
                             sizeof *piece->pairs);
            fill_piece(piece);
        }
    }
}

void pl_candidate_pairs_each(const pl_candidate_pairs *p,
                             void (*see)(void *context, const pl_near_pair *pair), void *context)
{
    for (int i = 0; i < PIECES; ++i) {
        for (int k = 0; k < p->pieces[i].count; ++k) {
            see(context, &p->pieces[i].pairs[k]);
        }
    }
}
