/* Sort and sweep: boxes in ascending order of their lower end along one axis; each is tested
 * against those that follow until one begins beyond its upper end. The order is kept from frame to
 * frame and mended by insertion sort, which costs O(n + inversions). Source: Baraff 1992;
 * Cohen et al. 1995 (I-COLLIDE). */
#include "sweep_and_prune.h"

#include "solid.h"

#include <stdlib.h>

/* Coordinates begin with that of the sweep's axis: 0 is along it, 1 and 2 across. */
typedef struct box {
    double low[3], high[3]; /* m */
    int body;
    bool is_static;
} box;

struct pl_broad_phase {
    const pl_scene *scene;
    box *boxes; /* (box_count), ascending along the sweep's axis */
    int box_count;
    int *planes; /* (plane_count), scene indices */
    int plane_count;
    int axis; /* of the sweep: 0, 1, 2 for x, y, z */
};

/* Widened by `reach`, and by a little more than the rounding of poses and gaps, so that no touching
 * pair is lost. */
static void place_box(box *b, int axis, const pl_shape *shape, const double position[3],
                      const double orientation[4], double reach)
{
    double radius = pl_core_radius(shape);
    pl_axes axes = pl_axes_of(orientation);
    for (int k = 0; k < 3; ++k) {
        int from = (axis + k) % 3;
        const pl_vec unit = {from == 0, from == 1, from == 2};
        pl_vec up = pl_to_local(&axes, unit), down = pl_vec_scale(up, -1);
        double above = pl_vec_dot(up, pl_core_support(shape, up)) + radius;
        double below = pl_vec_dot(down, pl_core_support(shape, down)) + radius;
        double slack = reach + 1e-12 * (fabs(position[from]) + fmax(fabs(above), fabs(below)));
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
    bp->axis = widest_axis(scene);
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (body->shape.kind == PL_SHAPE_PLANE) {
            bp->planes[bp->plane_count++] = i;
        } else {
            box *b = &bp->boxes[bp->box_count++];
            *b = (box){.body = i, .is_static = body->is_static};
            place_box(b, bp->axis, &body->shape, body->position, body->orientation, 0);
        }
    }
    qsort(bp->boxes, (size_t)bp->box_count, sizeof *bp->boxes, compare_boxes);
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

/* Moves the boxes to their bodies and mends their order. */
static void follow(pl_broad_phase *bp, const pl_body_state *bodies, const double *reach)
{
    for (int i = 0; i < bp->box_count; ++i) {
        box moved = bp->boxes[i];
        if (!moved.is_static) {
            const pl_body_state *state = &bodies[moved.body];
            place_box(&moved, bp->axis, &bp->scene->bodies[moved.body].shape, state->position,
                      state->orientation, reach == NULL ? 0 : reach[moved.body]);
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

void pl_broad_phase_each_pair(pl_broad_phase *bp, const pl_body_state *bodies, const double *reach,
                              void (*see)(void *context, int body_a, int body_b), void *context)
{
    follow(bp, bodies, reach);
    const box *end = bp->boxes + bp->box_count;
    for (const box *a = bp->boxes; a < end; ++a) {
        for (const box *b = a + 1; b < end && b->low[0] <= a->high[0]; ++b) {
            if (!(a->is_static && b->is_static) && overlap_across(a, b)) {
                see(context, a->body, b->body);
            }
        }
    }
    for (int i = 0; i < bp->plane_count; ++i) {
        for (const box *b = bp->boxes; b < end; ++b) {
            if (!b->is_static) {
                see(context, bp->planes[i], b->body);
            }
        }
    }
}
