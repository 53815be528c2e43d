#include "surface.h"

#include <stddef.h>

static double clamp(double value)
{
    return fmin(fmax(value, 0), 1);
}

static pl_vec nearest_on_segment(const pl_segment *segment, pl_vec point)
{
    pl_vec along = pl_vec_sub(segment->end, segment->start);
    double square = pl_vec_dot(along, along);
    double t = pl_vec_dot(pl_vec_sub(point, segment->start), along);
    return pl_vec_mad(segment->start, square > 0 ? clamp(t / square) : 0, along);
}

/* The nearest points lie in the interiors of both segments, or one of them is an end. So the
 * candidates are each end against the other segment, and the pair of interior points if there is
 * one. No case is lost by rounding when the segments are nearly parallel. */
double pl_segment_distance(const pl_segment *a, const pl_segment *b)
{
    pl_vec of_a[5] = {a->start, a->end, nearest_on_segment(a, b->start),
                      nearest_on_segment(a, b->end)};
    pl_vec of_b[5] = {nearest_on_segment(b, a->start), nearest_on_segment(b, a->end), b->start,
                      b->end};
    int count = 4;
    pl_vec u = pl_vec_sub(a->end, a->start), v = pl_vec_sub(b->end, b->start);
    pl_vec n = pl_vec_cross(u, v), c = pl_vec_sub(b->start, a->start);
    double square = pl_vec_dot(n, n);
    if (square > 0) {
        double s = pl_vec_dot(pl_vec_cross(c, v), n) / square;
        double t = pl_vec_dot(pl_vec_cross(c, u), n) / square;
        if (s > 0 && s < 1 && t > 0 && t < 1) {
            of_a[count] = pl_vec_mad(a->start, s, u);
            of_b[count++] = pl_vec_mad(b->start, t, v);
        }
    }
    double least = HUGE_VAL;
    for (int i = 0; i < count; ++i) {
        pl_vec d = pl_vec_sub(of_a[i], of_b[i]);
        least = fmin(least, pl_vec_dot(d, d));
    }
    return sqrt(least);
}

static pl_vec nearest_on_edges(const pl_triangle *triangle, pl_vec point, pl_feature *feature)
{
    pl_vec best = triangle->corner[0];
    double least = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        const pl_segment edge = {triangle->corner[k], triangle->corner[(k + 1) % 3]};
        pl_vec along = pl_vec_sub(edge.end, edge.start);
        double square = pl_vec_dot(along, along);
        double t = pl_vec_dot(pl_vec_sub(point, edge.start), along);
        pl_vec q = t <= 0        ? edge.start
                   : t >= square ? edge.end
                                 : pl_vec_mad(edge.start, t / square, along);
        pl_vec d = pl_vec_sub(q, point);
        if (pl_vec_dot(d, d) < least) {
            least = pl_vec_dot(d, d);
            best = q;
            int on = t <= 0        ? PL_CORNER_0 + k
                     : t >= square ? PL_CORNER_0 + (k + 1) % 3
                                   : PL_EDGE_0 + k;
            *feature = (pl_feature)on;
        }
    }
    return best;
}

pl_vec pl_triangle_nearest(const pl_triangle *triangle, pl_vec point, pl_feature *feature)
{
    const pl_vec *corner = triangle->corner;
    pl_feature on = PL_FACE;
    pl_vec n = pl_vec_cross(pl_vec_sub(corner[1], corner[0]), pl_vec_sub(corner[2], corner[0]));
    double square = pl_vec_dot(n, n);
    bool inside = square > 0;
    for (int k = 0; k < 3 && inside; ++k) {
        pl_vec edge = pl_vec_sub(corner[(k + 1) % 3], corner[k]);
        inside = pl_vec_dot(pl_vec_cross(edge, pl_vec_sub(point, corner[k])), n) > 0;
    }
    double height = inside ? pl_vec_dot(pl_vec_sub(point, corner[0]), n) / square : 0;
    pl_vec nearest =
        inside ? pl_vec_mad(point, -height, n) : nearest_on_edges(triangle, point, &on);
    if (feature != NULL) {
        *feature = on;
    }
    return nearest;
}

/* By signed volumes: the segment's ends are on different sides of the plane, and its line is on the
 * same side of all three edges. */
bool pl_triangle_pierced(const pl_triangle *triangle, const pl_segment *segment, double *fraction)
{
    const pl_vec *corner = triangle->corner;
    pl_vec n = pl_vec_cross(pl_vec_sub(corner[1], corner[0]), pl_vec_sub(corner[2], corner[0]));
    double start = pl_vec_dot(n, pl_vec_sub(segment->start, corner[0]));
    double end = pl_vec_dot(n, pl_vec_sub(segment->end, corner[0]));
    if ((start > 0 && end > 0) || (start < 0 && end < 0) || start == end) {
        return false;
    }
    pl_vec along = pl_vec_sub(segment->end, segment->start);
    bool left = false, right = false;
    for (int k = 0; k < 3; ++k) {
        /* Two triangles that share this edge get exactly opposite numbers, so that no segment
         * passes between them. */
        pl_vec from = pl_vec_sub(corner[k], segment->start);
        pl_vec to = pl_vec_sub(corner[(k + 1) % 3], segment->start);
        double side = pl_vec_dot(pl_vec_cross(from, to), along);
        left = left || side > 0;
        right = right || side < 0;
    }
    *fraction = start / (start - end);
    return !(left && right);
}

static pl_segment edge_of(const pl_triangle *triangle, int k)
{
    return (pl_segment){triangle->corner[k], triangle->corner[(k + 1) % 3]};
}

/* The distance of a triangle and a segment, m; 0 if they meet. */
static double triangle_segment_distance(const pl_triangle *triangle, const pl_segment *segment)
{
    double fraction;
    if (pl_triangle_pierced(triangle, segment, &fraction)) {
        return 0;
    }
    double least = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        pl_segment edge = edge_of(triangle, k);
        least = fmin(least, pl_segment_distance(&edge, segment));
    }
    const pl_vec ends[2] = {segment->start, segment->end};
    for (int k = 0; k < 2; ++k) {
        pl_vec q = pl_triangle_nearest(triangle, ends[k], NULL);
        least = fmin(least, pl_vec_length(pl_vec_sub(q, ends[k])));
    }
    return least;
}

double pl_triangle_distance(const pl_triangle *a, const pl_triangle *b)
{
    double least = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        pl_segment of_a = edge_of(a, k), of_b = edge_of(b, k);
        least = fmin(least, triangle_segment_distance(b, &of_a));
        double fraction;
        if (pl_triangle_pierced(a, &of_b, &fraction)) {
            return 0;
        }
        pl_vec q = pl_triangle_nearest(a, b->corner[k], NULL);
        least = fmin(least, pl_vec_length(pl_vec_sub(q, b->corner[k])));
    }
    return least;
}
