/* Sort and sweep: boxes in ascending order of their lower end along one axis; each is tested
 * against those that follow until one begins beyond its upper end. The order is kept from frame to
 * frame and mended by insertion sort, which costs O(n + inversions). Source: Baraff 1992;
 * Cohen et al. 1995 (I-COLLIDE). */
#include "referee/broad_phase.h"

#include "referee/vec.h"

#include <stdlib.h>

typedef struct box {
    double low[3], high[3]; /* m, world */
    int body;
    bool is_static;
} box;

struct pl_broad_phase {
    const pl_scene *scene;
    box *boxes; /* (box_count), ascending along axis */
    int box_count;
    int *planes; /* (plane_count), scene indices */
    int plane_count;
    int axis;
    /* Where the enumeration stands: first all pairs of boxes, then planes against boxes. */
    int first, second, plane;
};

/* Widened by a little more than the rounding of poses and gaps, so that no touching pair is lost.
 */
static void place_box(box *b, const pl_shape *shape, const double position[3],
                      const double orientation[4])
{
    double half[3] = {shape->radius, shape->radius, shape->radius};
    if (shape->kind == PL_SHAPE_BOX) {
        pl_axes axes = pl_axes_of(orientation);
        const pl_vec *a = axes.axis;
        const double *h = shape->half_extents;
        half[0] = fabs(a[0].x) * h[0] + fabs(a[1].x) * h[1] + fabs(a[2].x) * h[2];
        half[1] = fabs(a[0].y) * h[0] + fabs(a[1].y) * h[1] + fabs(a[2].y) * h[2];
        half[2] = fabs(a[0].z) * h[0] + fabs(a[1].z) * h[1] + fabs(a[2].z) * h[2];
    }
    for (int k = 0; k < 3; ++k) {
        double slack = 1e-12 * (fabs(position[k]) + half[k]);
        b->low[k] = position[k] - half[k] - slack;
        b->high[k] = position[k] + half[k] + slack;
    }
}

/* The axis along which the centres of the boxes vary most. */
static int widest_axis(const pl_broad_phase *bp)
{
    int widest = 0;
    double most = -1;
    for (int k = 0; k < 3; ++k) {
        double mean = 0, square = 0;
        for (int i = 0; i < bp->box_count; ++i) {
            double delta = (bp->boxes[i].low[k] + bp->boxes[i].high[k]) / 2 - mean;
            mean += delta / (i + 1);
            square += delta * delta * i / (i + 1);
        }
        if (square > most) {
            most = square;
            widest = k;
        }
    }
    return widest;
}

static bool comes_before(const box *a, const box *b, int axis)
{
    return a->low[axis] < b->low[axis] || (a->low[axis] == b->low[axis] && a->body < b->body);
}

static int compare_along(const box *a, const box *b, int axis)
{
    return comes_before(a, b, axis) ? -1 : comes_before(b, a, axis);
}

static int compare_x(const void *a, const void *b)
{
    return compare_along(a, b, 0);
}

static int compare_y(const void *a, const void *b)
{
    return compare_along(a, b, 1);
}

static int compare_z(const void *a, const void *b)
{
    return compare_along(a, b, 2);
}

pl_broad_phase *pl_broad_phase_create(const pl_scene *scene)
{
    size_t count = (size_t)scene->body_count;
    pl_broad_phase *bp = calloc(1, sizeof *bp);
    if (bp == NULL) {
        return NULL;
    }
    bp->scene = scene;
    bp->boxes = calloc(count + 1, sizeof *bp->boxes);
    bp->planes = calloc(count + 1, sizeof *bp->planes);
    if (bp->boxes == NULL || bp->planes == NULL) {
        pl_broad_phase_destroy(bp);
        return NULL;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (body->shape.kind == PL_SHAPE_PLANE) {
            bp->planes[bp->plane_count++] = i;
        } else {
            box *b = &bp->boxes[bp->box_count++];
            *b = (box){.body = i, .is_static = body->is_static};
            place_box(b, &body->shape, body->position, body->orientation);
        }
    }
    int (*const compare[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
    bp->axis = widest_axis(bp);
    qsort(bp->boxes, (size_t)bp->box_count, sizeof *bp->boxes, compare[bp->axis]);
    bp->first = bp->box_count;
    bp->plane = bp->plane_count;
    return bp;
}

void pl_broad_phase_destroy(pl_broad_phase *bp)
{
    if (bp != NULL) {
        free(bp->boxes);
        free(bp->planes);
        free(bp);
    }
}

void pl_broad_phase_update(pl_broad_phase *bp, const pl_body_state *bodies)
{
    for (int i = 0; i < bp->box_count; ++i) {
        box moved = bp->boxes[i];
        if (!moved.is_static) {
            const pl_body_state *state = &bodies[moved.body];
            place_box(&moved, &bp->scene->bodies[moved.body].shape, state->position,
                      state->orientation);
        }
        int k = i;
        for (; k > 0 && comes_before(&moved, &bp->boxes[k - 1], bp->axis); --k) {
            bp->boxes[k] = bp->boxes[k - 1];
        }
        bp->boxes[k] = moved;
    }
    bp->first = 0;
    bp->second = 1;
    bp->plane = 0;
}

static bool boxes_overlap(const box *a, const box *b)
{
    bool overlap = true;
    for (int k = 0; k < 3; ++k) {
        overlap = overlap && a->low[k] <= b->high[k] && b->low[k] <= a->high[k];
    }
    return overlap;
}

static bool next_box_pair(pl_broad_phase *bp, int *body_a, int *body_b)
{
    for (; bp->first < bp->box_count; ++bp->first, bp->second = bp->first + 1) {
        const box *a = &bp->boxes[bp->first];
        while (bp->second < bp->box_count &&
               bp->boxes[bp->second].low[bp->axis] <= a->high[bp->axis]) {
            const box *b = &bp->boxes[bp->second++];
            if (!(a->is_static && b->is_static) && boxes_overlap(a, b)) {
                *body_a = a->body;
                *body_b = b->body;
                return true;
            }
        }
    }
    bp->second = 0;
    return false;
}

static bool next_plane_pair(pl_broad_phase *bp, int *body_a, int *body_b)
{
    for (; bp->plane < bp->plane_count; ++bp->plane, bp->second = 0) {
        while (bp->second < bp->box_count) {
            const box *b = &bp->boxes[bp->second++];
            if (!b->is_static) {
                *body_a = bp->planes[bp->plane];
                *body_b = b->body;
                return true;
            }
        }
    }
    return false;
}

bool pl_broad_phase_next(pl_broad_phase *bp, int *body_a, int *body_b)
{
    if (bp->first < bp->box_count && next_box_pair(bp, body_a, body_b)) {
        return true;
    }
    return next_plane_pair(bp, body_a, body_b);
}
