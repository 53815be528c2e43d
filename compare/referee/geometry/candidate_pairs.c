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

#include "box_sweep.h"
#include "gap.h"
#include "solid.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---- Surfaces ---- */

static bool has_surface(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_BOX || shape->kind == PL_SHAPE_CAPSULE ||
           shape->kind == PL_SHAPE_HULL || shape->kind == PL_SHAPE_MESH;
}

/* A body's shape, to be sorted. */
typedef struct shape_of_body {
    const pl_shape *shape;
    int body;
} shape_of_body;

static int compare_numbers(double a, double b)
{
    return (a > b) - (a < b);
}

/* 0 for shapes that have the same surface. */
static int compare_surfaces(const pl_shape *a, const pl_shape *b)
{
    int order = (a->kind > b->kind) - (a->kind < b->kind);
    if (order == 0) {
        const uintptr_t p = (uintptr_t)a->polyhedron, q = (uintptr_t)b->polyhedron;
        order = (p > q) - (p < q);
    }
    order = order == 0 ? compare_numbers(a->half_height, b->half_height) : order;
    for (int k = 0; k < 3 && order == 0; ++k) {
        order = compare_numbers(a->half_extents[k], b->half_extents[k]);
    }
    return order;
}

static int compare_shapes(const void *a, const void *b)
{
    return compare_surfaces(((const shape_of_body *)a)->shape, ((const shape_of_body *)b)->shape);
}

/* Makes the surfaces, (body_count), that bodies need to be measured against meshes. Equal shapes
 * share a surface. A scene without a mesh has none. */
static void make_surfaces(const pl_scene *scene, pl_arena *arena, const pl_surface **surfaces)
{
    bool any_mesh = false;
    for (int i = 0; i < scene->body_count; ++i) {
        any_mesh = any_mesh || scene->bodies[i].shape.kind == PL_SHAPE_MESH;
    }
    if (!any_mesh) {
        return;
    }
    shape_of_body *list = pl_arena_take(arena, (size_t)scene->body_count, sizeof *list);
    int count = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        if (has_surface(&scene->bodies[i].shape)) {
            list[count++] = (shape_of_body){&scene->bodies[i].shape, i};
        }
    }
    qsort(list, (size_t)count, sizeof *list, compare_shapes);
    for (int i = 0; i < count; ++i) {
        if (i > 0 && compare_surfaces(list[i - 1].shape, list[i].shape) == 0) {
            surfaces[list[i].body] = surfaces[list[i - 1].body];
        } else {
            surfaces[list[i].body] = pl_surface_create(list[i].shape, arena);
        }
    }
}

/* ---- Candidate pairs ---- */

static const double RESTING_GAP = 1e-3; /* of the smaller bounding radius */

enum {
    PIECES = 64,     /* that are worked on together */
    MOST_ROWS = 256, /* of the broad phase in a piece */
    ROW_PAIRS = 8    /* that fit into a piece, for each row */
};

/* Some rows of the broad phase and their pairs. */
typedef struct pair_piece {
    pl_near_pair *pairs; /* (ROW_PAIRS x rows_per_piece) */
    int count;
    long begin, end; /* rows */
    long next;       /* rows before it are in `pairs`; the others did not fit */
    bool full;
} pair_piece;

struct pl_candidate_pairs {
    const pl_scene *scene;
    pl_broad_phase *broad_phase;
    const pl_surface **surfaces; /* (body_count): NULL where none is needed */
    double *radius;              /* (body_count): bounding radii, m */
    double *margin; /* (body_count), m: a pair that meets has at most the sum of both as its gap */
    int rows_per_piece;
    pair_piece pieces[PIECES];
    pl_arena *arena;
    pl_body_state *bodies; /* (body_count): the last frame */
    pl_near_pair *seen;    /* (seen_count of seen_capacity): its pairs, in their order */
    int seen_count, seen_capacity;
    bool has_seen; /* there is a last frame */
};

/* One frame. */
typedef struct frame {
    pl_candidate_pairs *pairs;
    const pl_body_state *bodies;
    void (*see)(void *context, const pl_near_pair *pair);
    void *context;
} frame;

/* A piece of a frame, at work. */
typedef struct piece_of_frame {
    const frame *frame;
    pair_piece *piece;
} piece_of_frame;

/* Divides the rows into the pieces. They are as small as there are rows for all. */
static void make_pieces(pl_candidate_pairs *p, pl_arena *arena)
{
    const long rows = (pl_broad_phase_rows(p->broad_phase) + PIECES - 1) / PIECES;
    p->rows_per_piece = rows < 1 ? 1 : rows < MOST_ROWS ? (int)rows : MOST_ROWS;
    for (int i = 0; i < PIECES; ++i) {
        p->pieces[i].pairs =
            pl_arena_take(arena, ROW_PAIRS * (size_t)p->rows_per_piece, sizeof *p->pieces[i].pairs);
    }
}

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
        p->radius[i] = pl_bounding_radius(&scene->bodies[i].shape);
    }
    make_pieces(p, arena);
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

/* Whether the pair may meet or touch; it then gets its gap. */
static bool is_near(const frame *f, int a, int b, pl_near_pair *pair)
{
    const pl_body *bodies = f->pairs->scene->bodies;
    if (!bodies[a].is_static && !bodies[b].is_static && is_far(f, a, b)) {
        return false;
    }
    const double within = meeting_gap(f, a, b);
    pl_placed_shape placed_a = place(f, a), placed_b = place(f, b);
    *pair = (pl_near_pair){.a = a, .b = b};
    pair->status = pl_gap(&placed_a, &placed_b, within, &pair->gap);
    pair->meets = !(pair->status == PL_OK && pair->gap > within);
    return true;
}

static void keep_pair(void *context, int a, int b)
{
    const piece_of_frame *work = context;
    pair_piece *piece = work->piece;
    if (piece->count == ROW_PAIRS * work->frame->pairs->rows_per_piece) {
        piece->full = true;
    } else if (is_near(work->frame, a, b, &piece->pairs[piece->count])) {
        piece->count += 1;
    }
}

/* Keeps the pairs of a piece as long as those of whole rows fit. */
static void fill_piece(const frame *f, pair_piece *piece)
{
    piece_of_frame work = {f, piece};
    piece->count = 0;
    piece->full = false;
    for (piece->next = piece->begin; piece->next < piece->end; ++piece->next) {
        const int before = piece->count;
        pl_broad_phase_see(f->pairs->broad_phase, piece->next, piece->next + 1, keep_pair, &work);
        if (piece->full) {
            piece->count = before;
            return;
        }
    }
}

static void fill_pieces(void *context, int begin, int end)
{
    const frame *f = context;
    for (int i = begin; i < end; ++i) {
        fill_piece(f, &f->pairs->pieces[i]);
    }
}

/* The memory of smaller arrays is the arena's until its end. */
static void reserve_seen(pl_candidate_pairs *p)
{
    if (p->seen_count < p->seen_capacity) {
        return;
    }
    const int capacity = 2 * p->seen_capacity + PIECES;
    pl_near_pair *seen = pl_arena_take(p->arena, (size_t)capacity, sizeof *seen);
    if (p->seen_count > 0) {
        memcpy(seen, p->seen, (size_t)p->seen_count * sizeof *seen);
    }
    p->seen = seen;
    p->seen_capacity = capacity;
}

/* Hands a pair out, and keeps it for a frame that is the same. */
static void hand_out(const frame *f, const pl_near_pair *pair)
{
    pl_candidate_pairs *p = f->pairs;
    reserve_seen(p);
    p->seen[p->seen_count++] = *pair;
    f->see(f->context, pair);
}

static void see_pair(void *context, int a, int b)
{
    const frame *f = context;
    pl_near_pair pair;
    if (is_near(f, a, b, &pair)) {
        hand_out(f, &pair);
    }
}

static void find_margins(const frame *f)
{
    pl_candidate_pairs *p = f->pairs;
    for (int i = 0; i < p->scene->body_count; ++i) {
        if (!p->scene->bodies[i].is_static) {
            const double speed =
                pl_vec_length(pl_vec_of(f->bodies[i].velocity)) + turning_speed(f, i);
            p->margin[i] = RESTING_GAP * p->radius[i] + p->scene->dt * speed;
        }
    }
}

static void find_pairs(frame *f, pl_thread_pool *pool)
{
    pl_candidate_pairs *p = f->pairs;
    find_margins(f);
    pl_broad_phase_follow(p->broad_phase, f->bodies, p->margin, pool);
    const long rows = pl_broad_phase_rows(p->broad_phase);
    for (long row = 0; row < rows;) {
        for (int i = 0; i < PIECES; ++i) {
            p->pieces[i].begin = row;
            row = rows - row < p->rows_per_piece ? rows : row + p->rows_per_piece;
            p->pieces[i].end = row;
        }
        pl_thread_pool_run(pool, PIECES, 1, fill_pieces, f);
        for (int i = 0; i < PIECES; ++i) {
            const pair_piece *piece = &p->pieces[i];
            for (int k = 0; k < piece->count; ++k) {
                hand_out(f, &piece->pairs[k]);
            }
            pl_broad_phase_see(p->broad_phase, piece->next, piece->end, see_pair, f);
        }
    }
}

void pl_candidate_pairs_each(pl_candidate_pairs *p, const pl_body_state *bodies,
                             pl_thread_pool *pool,
                             void (*see)(void *context, const pl_near_pair *pair), void *context)
{
    const size_t size = (size_t)p->scene->body_count * sizeof *bodies;
    frame f = {.pairs = p, .bodies = bodies, .see = see, .context = context};
    if (p->has_seen && memcmp(p->bodies, bodies, size) == 0) {
        for (int i = 0; i < p->seen_count; ++i) {
            see(context, &p->seen[i]);
        }
        return;
    }
    memcpy(p->bodies, bodies, size);
    p->seen_count = 0;
    p->has_seen = true;
    find_pairs(&f, pool);
}
