/* The broad phase of the referee: sort and sweep, in columns.
 *
 * Boxes are in ascending order of their lower ends along one axis, and each is compared with those
 * that follow until one begins beyond its upper end. The order is kept from frame to frame and
 * restored by insertion sort, which costs O(n + inversions); where there are many, by another sort.
 * Source: Baraff 1992; Cohen et al. 1995 (I-COLLIDE).
 *
 * In a wide scene too many boxes overlap along one axis. The plane across that axis is therefore
 * divided into square columns, about twice as wide as a body, and a box is compared only with those
 * that share a column with it. Columns repeat with a period, so that a finite table has one for
 * each place. A box in many columns is compared with all that follow. */
#include "candidate_pairs.h"

#include "solid.h"

#include <stdlib.h>
#include <string.h>

enum {
    MOST_SHARED = 128,  /* boxes that one box may find in its columns */
    MOST_COLUMNS = 64,  /* of a box that is looked up in its columns */
    COLUMN_ENTRIES = 8, /* in all columns, for each box */
    MOST_SHIFTS = 16    /* of an insertion sort, for each box */
};

/* Coordinate 0 is along the sort axis, 1 and 2 are across. */
typedef struct box {
    double low[3], high[3]; /* m */
    int body;
    bool is_static;
} box;

/* The columns of a box: `count` in either direction, from `first` on. */
typedef struct columns {
    int first[2], count[2];
} columns;

struct pl_broad_phase {
    const pl_scene *scene;
    box *boxes; /* (box_count), ascending along the sort axis */
    int box_count;
    int *planes; /* (plane_count), scene indices */
    int plane_count;
    int axis;     /* sort axis: 0, 1, 2 for x, y, z */
    int period;   /* columns in either direction; a power of 2 */
    double width; /* of a column, m */
    int *starts;  /* (period^2 + 1): column c has entries[starts[c]] to before starts[c + 1] */
    int *entries; /* indices of boxes, ascending in each column */
};

/* How far a shape reaches from its own origin along `direction`, in its frame, without the radius
 * around its core. */
static double reach(const pl_shape *shape, pl_vec direction)
{
    return pl_vec_dot(direction, pl_core_support(shape, direction));
}

/* Sets the box of a shape, enlarged by `margin` and by a little more than the rounding of poses and
 * gaps, so that no touching pair is lost. */
static void place_box(box *b, int axis, const pl_shape *shape, const double position[3],
                      const double orientation[4], double margin)
{
    const double radius = pl_core_radius(shape);
    const bool turns = shape->kind != PL_SHAPE_SPHERE; /* whose core is a point */
    const pl_axes axes = turns ? pl_axes_of(orientation) : (pl_axes){0};
    for (int k = 0; k < 3; ++k) {
        int from = (axis + k) % 3;
        const pl_vec unit = {from == 0, from == 1, from == 2};
        const pl_vec up = pl_to_local(&axes, unit);
        const double above = radius + (turns ? reach(shape, up) : 0);
        const double below = radius + (turns ? reach(shape, pl_vec_scale(up, -1)) : 0);
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

/* ---- Order along the axis ---- */

static bool comes_before(const box *a, const box *b)
{
    return a->low[0] < b->low[0] || (a->low[0] == b->low[0] && a->body < b->body);
}

static int compare_boxes(const void *a, const void *b)
{
    return comes_before(a, b) ? -1 : comes_before(b, a);
}

/* The order is the same by either sort, since no two boxes are equal. */
static void restore_order(box *boxes, int count)
{
    long shifts = 0;
    for (int i = 1; i < count; ++i) {
        const box moved = boxes[i];
        int k = i;
        for (; k > 0 && comes_before(&moved, &boxes[k - 1]); --k) {
            boxes[k] = boxes[k - 1];
        }
        boxes[k] = moved;
        shifts += i - k;
        if (shifts > (long)MOST_SHIFTS * count) {
            qsort(boxes, (size_t)count, sizeof *boxes, compare_boxes);
            return;
        }
    }
}

/* ---- Columns across it ---- */

/* Clamped, so that places beyond all numbers of columns share one. */
static double cell_of(const pl_broad_phase *bp, double coordinate)
{
    const double cell = floor(coordinate / bp->width);
    return !(cell > -1e15) ? -1e15 : cell < 1e15 ? cell : 1e15;
}

static columns columns_of(const pl_broad_phase *bp, const box *b)
{
    columns c;
    for (int k = 0; k < 2; ++k) {
        const double first = cell_of(bp, b->low[k + 1]);
        const double count = cell_of(bp, b->high[k + 1]) - first + 1;
        c.first[k] = (int)((long long)first & (bp->period - 1));
        c.count[k] = count < bp->period ? (int)count : bp->period;
    }
    return c;
}

/* The number of the column (i, k) of those. */
static int column_at(const pl_broad_phase *bp, const columns *c, int i, int k)
{
    const int mask = bp->period - 1;
    return ((c->first[0] + i) & mask) * bp->period + ((c->first[1] + k) & mask);
}

/* Twice the mean extent of the boxes that move. */
static double column_width(const pl_broad_phase *bp)
{
    double sum = 0;
    int count = 0;
    for (int i = 0; i < bp->box_count; ++i) {
        const box *b = &bp->boxes[i];
        if (!b->is_static) {
            sum += b->high[1] - b->low[1] + b->high[2] - b->low[2];
            count += 1;
        }
    }
    return count > 0 && sum / count > 0 ? sum / count : 1;
}

/* Counts the entries of each column, in starts[column + 1]. False when there are too many. */
static bool count_entries(pl_broad_phase *bp)
{
    const int column_count = bp->period * bp->period;
    long sum = 0;
    memset(bp->starts, 0, ((size_t)column_count + 1) * sizeof *bp->starts);
    for (int i = 0; i < bp->box_count; ++i) {
        const columns c = columns_of(bp, &bp->boxes[i]);
        sum += (long)c.count[0] * c.count[1];
        if (sum > (long)COLUMN_ENTRIES * bp->box_count) {
            return false;
        }
        for (int j = 0; j < c.count[0]; ++j) {
            for (int k = 0; k < c.count[1]; ++k) {
                bp->starts[column_at(bp, &c, j, k) + 1] += 1;
            }
        }
    }
    return true;
}

static void fill_columns(pl_broad_phase *bp)
{
    const int column_count = bp->period * bp->period;
    bp->width = column_width(bp);
    /* In the end every box is in four columns at most. */
    while (!count_entries(bp)) {
        bp->width *= 2;
    }
    for (int c = 0; c < column_count; ++c) {
        bp->starts[c + 1] += bp->starts[c];
    }
    const int sum = bp->starts[column_count];
    for (int i = bp->box_count - 1; i >= 0; --i) {
        const columns c = columns_of(bp, &bp->boxes[i]);
        for (int j = 0; j < c.count[0]; ++j) {
            for (int k = 0; k < c.count[1]; ++k) {
                bp->entries[--bp->starts[column_at(bp, &c, j, k) + 1]] = i;
            }
        }
    }
    /* The ends have moved to the beginnings. */
    memmove(bp->starts, bp->starts + 1, (size_t)column_count * sizeof *bp->starts);
    bp->starts[column_count] = sum;
}

/* ---- Frames ---- */

pl_broad_phase *pl_broad_phase_create(const pl_scene *scene, pl_arena *arena)
{
    size_t count = (size_t)scene->body_count;
    pl_broad_phase *bp = pl_arena_take(arena, 1, sizeof *bp);
    box *boxes = pl_arena_take(arena, count, sizeof *boxes);
    int *planes = pl_arena_take(arena, count, sizeof *planes);
    *bp = (pl_broad_phase){
        .scene = scene, .boxes = boxes, .planes = planes, .axis = widest_axis(scene), .period = 1};
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
    while (4 * bp->period * bp->period <= bp->box_count) {
        bp->period *= 2;
    }
    bp->starts = pl_arena_take(arena, (size_t)(bp->period * bp->period) + 1, sizeof *bp->starts);
    bp->entries = pl_arena_take(arena, COLUMN_ENTRIES * (size_t)bp->box_count, sizeof *bp->entries);
    return bp;
}

void pl_broad_phase_follow(pl_broad_phase *bp, const pl_body_state *bodies, const double *margin)
{
    for (int i = 0; i < bp->box_count; ++i) {
        box *b = &bp->boxes[i];
        if (!b->is_static) {
            const pl_body_state *state = &bodies[b->body];
            place_box(b, bp->axis, &bp->scene->bodies[b->body].shape, state->position,
                      state->orientation, margin == NULL ? 0 : margin[b->body]);
        }
    }
    restore_order(bp->boxes, bp->box_count);
    fill_columns(bp);
}

/* ---- Pairs ---- */

static bool overlap(const box *a, const box *b)
{
    return !(a->is_static && b->is_static) && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
           b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

/* The first entry of a column that comes after box `index`. */
static int entry_after(const pl_broad_phase *bp, int column, int index)
{
    int begin = bp->starts[column], end = bp->starts[column + 1];
    while (begin < end) {
        const int middle = begin + (end - begin) / 2;
        if (bp->entries[middle] <= index) {
            begin = middle + 1;
        } else {
            end = middle;
        }
    }
    return begin;
}

/* Adds `item` to an ascending list, unless it is there. */
static void insert(int *list, int *count, int item)
{
    int k = *count;
    while (k > 0 && list[k - 1] > item) {
        --k;
    }
    if (k == 0 || list[k - 1] != item) {
        memmove(list + k + 1, list + k, (size_t)(*count - k) * sizeof *list);
        list[k] = item;
        *count += 1;
    }
}

/* Finds the later boxes that share a column with box `index` and overlap it, in ascending order.
 * Their number, or -1 when they or the columns are too many. Adds the comparisons to *cost. */
static int find_shared(const pl_broad_phase *bp, int index, int found[MOST_SHARED], long *cost)
{
    const box *a = &bp->boxes[index];
    const columns c = columns_of(bp, a);
    int count = 0;
    if ((long)c.count[0] * c.count[1] > MOST_COLUMNS) {
        return -1;
    }
    for (int j = 0; j < c.count[0]; ++j) {
        for (int k = 0; k < c.count[1]; ++k) {
            const int column = column_at(bp, &c, j, k);
            for (int e = entry_after(bp, column, index); e < bp->starts[column + 1]; ++e) {
                const box *b = &bp->boxes[bp->entries[e]];
                *cost += 1;
                if (b->low[0] > a->high[0]) {
                    break;
                }
                if (!overlap(a, b)) {
                    continue;
                }
                if (count == MOST_SHARED) {
                    return -1;
                }
                insert(found, &count, bp->entries[e]);
            }
        }
    }
    return count;
}

/* One row of box `index`: the pairs with the boxes that follow it. */
static void see_box(const pl_broad_phase *bp, int index,
                    void (*see)(void *context, int body_a, int body_b), void *context, long *cost)
{
    int found[MOST_SHARED];
    const box *a = &bp->boxes[index];
    const int count = find_shared(bp, index, found, cost);
    for (int i = 0; i < count; ++i) {
        see(context, a->body, bp->boxes[found[i]].body);
    }
    for (int i = index + 1; count < 0 && i < bp->box_count; ++i) {
        const box *b = &bp->boxes[i];
        *cost += 1;
        if (b->low[0] > a->high[0]) {
            break;
        }
        if (overlap(a, b)) {
            see(context, a->body, b->body);
        }
    }
}

/* Whether the box has a point in the half-space of plane number `plane`. */
static bool reaches_plane(const pl_broad_phase *bp, long plane, const box *b)
{
    const pl_shape *shape = &bp->scene->bodies[bp->planes[plane]].shape;
    double lowest = -shape->offset;
    for (int k = 0; k < 3; ++k) {
        const double n = shape->normal[(bp->axis + k) % 3];
        lowest += n * (n > 0 ? b->low[k] : b->high[k]);
    }
    return !(lowest > 0);
}

long pl_broad_phase_rows(const pl_broad_phase *bp)
{
    return (long)bp->box_count * (1 + bp->plane_count);
}

long pl_broad_phase_see(const pl_broad_phase *bp, long begin, long end,
                        void (*see)(void *context, int body_a, int body_b), void *context)
{
    long cost = 0;
    for (long row = begin; row < end; ++row) {
        const int index = (int)(row % bp->box_count);
        const long plane = row / bp->box_count - 1;
        if (plane < 0) {
            see_box(bp, index, see, context, &cost);
        } else if (!bp->boxes[index].is_static && reaches_plane(bp, plane, &bp->boxes[index])) {
            see(context, bp->planes[plane], bp->boxes[index].body);
        }
    }
    return cost;
}
