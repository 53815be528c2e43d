/* A polygon of which all corners are seen from the first in turn becomes a fan. Any other is cut by
 * clipping ears (Meisters, Polygons have ears, 1975): an ear is a corner whose triangle with its
 * two neighbours has an area and holds no other corner, not even on its border, so that what is
 * left is again a polygon. Whether a corner is an ear changes only when a neighbour goes. */
#include "polygon.h"

#include "plumb/vec.h"

#include <math.h>
#include <stdlib.h>

typedef struct point {
    double x, y; /* in the polygon's plane, seen so that it is counter-clockwise, over its size */
} point;

/* Less than this, over the square of the size, is no area. */
#define AREA_ROUNDING 1e-14
#define FLATNESS 1e-3

/* Twice the area of a triangle, positive when counter-clockwise. */
static double area(point a, point b, point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static pl_vec arm(const double (*vertices)[3], const int *corner, int i)
{
    return pl_vec_sub(pl_vec_of(vertices[corner[i]]), pl_vec_of(vertices[corner[0]]));
}

static pl_polygon_fault project(const double (*vertices)[3], const int *corner, int count,
                                point *points)
{
    double size = 0;
    for (int i = 1; i < count; i++) {
        size = fmax(size, pl_vec_length(arm(vertices, corner, i)));
    }
    if (!(size > 0)) {
        return PL_POLYGON_NO_AREA;
    }
    pl_vec normal = {0, 0, 0}; /* twice the area, over the square of the size */
    for (int i = 1; i + 1 < count; i++) {
        const pl_vec a = pl_vec_scale(arm(vertices, corner, i), 1 / size);
        const pl_vec b = pl_vec_scale(arm(vertices, corner, i + 1), 1 / size);
        normal = pl_vec_add(normal, pl_vec_cross(a, b));
    }
    const double length = pl_vec_length(normal);
    if (!(length > AREA_ROUNDING)) {
        return PL_POLYGON_NO_AREA;
    }
    normal = pl_vec_scale(normal, 1 / length);
    const pl_vec steepest = fabs(normal.x) < 0.6   ? (pl_vec){1, 0, 0}
                            : fabs(normal.y) < 0.6 ? (pl_vec){0, 1, 0}
                                                   : (pl_vec){0, 0, 1};
    pl_vec u = pl_vec_reject(steepest, normal);
    u = pl_vec_scale(u, 1 / pl_vec_length(u));
    const pl_vec v = pl_vec_cross(normal, u);
    double low = 0, high = 0;
    for (int i = 0; i < count; i++) {
        const pl_vec a = pl_vec_scale(arm(vertices, corner, i), 1 / size);
        points[i] = (point){pl_vec_dot(a, u), pl_vec_dot(a, v)};
        low = fmin(low, pl_vec_dot(a, normal));
        high = fmax(high, pl_vec_dot(a, normal));
    }
    return high - low > FLATNESS ? PL_POLYGON_NOT_FLAT : PL_POLYGON_RIGHT;
}

/* Whether the corners go round the first counter-clockwise by less than half a turn. */
static bool is_fan(const point *points, int count)
{
    for (int i = 2; i < count; i++) {
        if (!(area(points[0], points[1], points[i]) > AREA_ROUNDING) ||
            !(area(points[0], points[i - 1], points[i]) > AREA_ROUNDING)) {
            return false;
        }
    }
    return true;
}

/* Whether two of its sides go through each other. Ears alone would not show it of an outline that
 * goes round twice. */
static bool crosses_itself(const point *points, int count)
{
    for (int i = 0; i < count; i++) {
        const point a = points[i], b = points[(i + 1) % count];
        for (int k = i + 2; k < count; k++) {
            const point c = points[k], d = points[(k + 1) % count];
            if (area(a, b, c) * area(a, b, d) < 0 && area(c, d, a) * area(c, d, b) < 0) {
                return true;
            }
        }
    }
    return false;
}

/* What is left of a polygon, a ring of corners. */
typedef struct ring {
    const point *points;
    int *previous, *next; /* (count) */
    bool *ear;            /* (count) */
} ring;

static bool is_ear(const ring *r, int i)
{
    const point a = r->points[r->previous[i]], b = r->points[i], c = r->points[r->next[i]];
    if (!(area(a, b, c) > AREA_ROUNDING)) {
        return false;
    }
    for (int k = r->next[r->next[i]]; k != r->previous[i]; k = r->next[k]) {
        const point p = r->points[k];
        if (area(a, b, p) >= -AREA_ROUNDING && area(b, c, p) >= -AREA_ROUNDING &&
            area(c, a, p) >= -AREA_ROUNDING) {
            return false;
        }
    }
    return true;
}

/* The triangles of the ring, as numbers of its corners; false where no ear is left. */
static bool clip_ears(ring *r, int count, int (*triangles)[3])
{
    for (int i = 0; i < count; i++) {
        r->previous[i] = (i + count - 1) % count;
        r->next[i] = (i + 1) % count;
    }
    for (int i = 0; i < count; i++) {
        r->ear[i] = is_ear(r, i);
    }
    int at = 0, left = count, passed = 0, made = 0;
    while (left > 3 && passed < left) {
        const int before = r->previous[at], after = r->next[at];
        if (!r->ear[at]) {
            passed++;
            at = after;
            continue;
        }
        int *triangle = triangles[made++];
        triangle[0] = before;
        triangle[1] = at;
        triangle[2] = after;
        r->next[before] = after;
        r->previous[after] = before;
        left--;
        passed = 0;
        r->ear[before] = is_ear(r, before);
        r->ear[after] = is_ear(r, after);
        at = r->next[after]; /* ears from all around make fewer slivers than from one side */
    }
    const int before = r->previous[at], after = r->next[at];
    triangles[made][0] = before;
    triangles[made][1] = at;
    triangles[made][2] = after;
    return left == 3 && area(r->points[before], r->points[at], r->points[after]) > AREA_ROUNDING;
}

pl_polygon_fault pl_polygon_cut(const double (*vertices)[3], const int *corner, int count,
                                int (*triangles)[3])
{
    const size_t room = (size_t)count;
    point *points = malloc(room * sizeof *points);
    ring r = {.points = points,
              .previous = malloc(room * sizeof *r.previous),
              .next = malloc(room * sizeof *r.next),
              .ear = malloc(room * sizeof *r.ear)};
    pl_polygon_fault fault = PL_POLYGON_NO_MEMORY;
    if (points == NULL || r.previous == NULL || r.next == NULL || r.ear == NULL) {
        goto cleanup;
    }
    fault = project(vertices, corner, count, points);
    if (fault != PL_POLYGON_RIGHT) {
        goto cleanup;
    }
    if (is_fan(points, count)) {
        for (int i = 0; i < count - 2; i++) {
            triangles[i][0] = 0;
            triangles[i][1] = i + 1;
            triangles[i][2] = i + 2;
        }
    } else if (crosses_itself(points, count) || !clip_ears(&r, count, triangles)) {
        fault = PL_POLYGON_CROSSES;
        goto cleanup;
    }
    for (int i = 0; i < 3 * (count - 2); i++) {
        triangles[i / 3][i % 3] = corner[triangles[i / 3][i % 3]];
    }
cleanup:
    free(points);
    free(r.previous);
    free(r.next);
    free(r.ear);
    return fault;
}
