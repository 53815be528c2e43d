/* Pairs of surfaces. Both trees are descended together: a pair of boxes that are too far apart is
 * left out with all its triangles; of any other pair the larger box is split. */
#include "base/heap.h"
#include "surface.h"

#include <stdlib.h>

/* A descent for the distance, or for piercings with a distance of 0. */
typedef struct descent {
    const pl_surface_pair *pair;
    double distance; /* the least so far, m: farther boxes are left out */
    bool piercings;
    pl_piercing *list;
    int count;
} descent;

/* A lower bound of the squared distance of two nodes, m^2: that of their boxes, where b's box is
 * rotated into a's frame and enclosed by a box there. */
static double boxes_square(const descent *d, const pl_surface_node *a, const pl_surface_node *b)
{
    const pl_vec *axis = d->pair->axes.axis;
    pl_vec centre = pl_vec_add(d->pair->offset, pl_to_world(&d->pair->axes, b->centre));
    pl_vec h = b->half;
    pl_vec half = {fabs(axis[0].x) * h.x + fabs(axis[1].x) * h.y + fabs(axis[2].x) * h.z,
                   fabs(axis[0].y) * h.x + fabs(axis[1].y) * h.y + fabs(axis[2].y) * h.z,
                   fabs(axis[0].z) * h.x + fabs(axis[1].z) * h.y + fabs(axis[2].z) * h.z};
    pl_vec apart = {fmax(fabs(centre.x - a->centre.x) - half.x - a->half.x, 0),
                    fmax(fabs(centre.y - a->centre.y) - half.y - a->half.y, 0),
                    fmax(fabs(centre.z - a->centre.z) - half.z - a->half.z, 0)};
    return pl_vec_dot(apart, apart);
}

static double size_of(const pl_surface_node *node)
{
    return fmax(node->half.x, fmax(node->half.y, node->half.z));
}

/* Adds the piercings of a triangle `target` of the other surface by those edges of triangle `t`
 * that have `t` as their first triangle. An edge lies in the boxes of all triangles that share it,
 * so that none is missed. */
static void pierce(descent *d, int of, int t, const pl_triangle *tri, int other,
                   const pl_triangle *target)
{
    const pl_surface *s = of == 0 ? d->pair->a : d->pair->b;
    for (int k = 0; k < 3; ++k) {
        int edge = s->sides[t][k];
        bool has = s->triangles[t][k] != s->triangles[t][(k + 1) % 3];
        if (!has || s->edges[edge].triangle != t) {
            continue;
        }
        bool forward = s->edges[edge].start == s->triangles[t][k];
        pl_segment along = {tri->corner[forward ? k : (k + 1) % 3],
                            tri->corner[forward ? (k + 1) % 3 : k]};
        pl_piercing piercing = {.of = of, .edge = edge, .triangle = other};
        if (pl_triangle_pierced(target, &along, &piercing.fraction)) {
            pl_push(&d->list, &d->count, &piercing, sizeof piercing);
        }
    }
}

/* How far a triangle is on one side of a plane: a lower bound of its distance from any point of the
 * plane; <= 0 if the plane cuts it. */
static double beyond_plane(pl_vec normal, pl_vec on_plane, const pl_triangle *triangle)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        double height = pl_vec_dot(normal, pl_vec_sub(triangle->corner[k], on_plane));
        low = height < low ? height : low;
        high = height > high ? height : high;
    }
    return low > -high ? low : -high;
}

static void see_leaves(descent *d, const pl_surface_node *a, const pl_surface_node *b)
{
    const pl_surface *of_a = d->pair->a, *of_b = d->pair->b;
    for (int k = 0; k < b->count; ++k) {
        int tb = of_b->order[b->first + k];
        pl_triangle triangle_b = pl_surface_triangle(of_b, tb);
        for (int c = 0; c < 3; ++c) {
            pl_vec turned = pl_to_world(&d->pair->axes, triangle_b.corner[c]);
            triangle_b.corner[c] = pl_vec_add(d->pair->offset, turned);
        }
        pl_vec normal_b = pl_to_world(&d->pair->axes, of_b->normals[tb]);
        for (int i = 0; i < a->count; ++i) {
            int ta = of_a->order[a->first + i];
            pl_triangle triangle_a = pl_surface_triangle(of_a, ta);
            if (beyond_plane(of_a->normals[ta], triangle_a.corner[0], &triangle_b) > d->distance ||
                beyond_plane(normal_b, triangle_b.corner[0], &triangle_a) > d->distance) {
                continue;
            }
            if (d->piercings) {
                pierce(d, 0, ta, &triangle_a, tb, &triangle_b);
                pierce(d, 1, tb, &triangle_b, ta, &triangle_a);
            } else {
                d->distance = fmin(d->distance, pl_triangle_distance(&triangle_a, &triangle_b));
            }
        }
    }
}

/* The depth of the recursion is at most the sum of the depths of both trees. */
static void descend(descent *d, int index_a, int index_b)
{
    const pl_surface_node *a = &d->pair->a->nodes[index_a], *b = &d->pair->b->nodes[index_b];
    if (a->count > 0 && b->count > 0) {
        see_leaves(d, a, b);
        return;
    }
    bool open_a = b->count > 0 || (a->count == 0 && size_of(a) >= size_of(b));
    int next_a[2] = {open_a ? index_a + 1 : index_a, open_a ? a->second : index_a};
    int next_b[2] = {open_a ? index_b : index_b + 1, open_a ? index_b : b->second};
    double square[2];
    for (int k = 0; k < 2; ++k) {
        square[k] = boxes_square(d, &d->pair->a->nodes[next_a[k]], &d->pair->b->nodes[next_b[k]]);
    }
    int nearer = square[1] < square[0];
    for (int k = 0; k < 2; ++k) {
        int which = k == 0 ? nearer : 1 - nearer;
        if (square[which] <= d->distance * d->distance && (d->piercings || d->distance > 0)) {
            descend(d, next_a[which], next_b[which]);
        }
    }
}

double pl_surface_pair_distance(const pl_surface_pair *pair, double within)
{
    descent d = {.pair = pair, .distance = nextafter(fmax(within, 0), HUGE_VAL)};
    double square = boxes_square(&d, &pair->a->nodes[0], &pair->b->nodes[0]);
    if (square <= d.distance * d.distance) {
        descend(&d, 0, 0);
    }
    return d.distance <= within ? d.distance : HUGE_VAL;
}

static int compare_piercings(const void *left, const void *right)
{
    const pl_piercing *a = left, *b = right;
    if (a->of != b->of) {
        return a->of - b->of;
    }
    if (a->edge != b->edge) {
        return a->edge < b->edge ? -1 : 1;
    }
    if (a->fraction != b->fraction) {
        return a->fraction < b->fraction ? -1 : 1;
    }
    return a->triangle - b->triangle;
}

pl_piercing *pl_surface_pair_piercings(const pl_surface_pair *pair, int *count)
{
    descent d = {.pair = pair, .piercings = true};
    if (boxes_square(&d, &pair->a->nodes[0], &pair->b->nodes[0]) <= 0) {
        descend(&d, 0, 0);
    }
    if (d.count > 0) {
        qsort(d.list, (size_t)d.count, sizeof *d.list, compare_piercings);
    }
    *count = d.count;
    return d.list;
}
