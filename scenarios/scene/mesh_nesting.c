/* A point is inside a closed surface when the solid angles of its triangles add up to 4 pi, outside
 * when to 0: van Oosterom and Strackee, The solid angle of a plane triangle, 1983. Where surfaces
 * touch, a point of one may lie on the other: then another point of it decides. */
#include "mesh.h"

#include "base/number.h"
#include "plumb/vec.h"
#include "polyhedron.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The triangles of component c are order[first[c] .. first[c + 1]), lowest first. */
typedef struct surfaces {
    const double (*vertices)[3];
    int (*triangles)[3]; /* in that order, copied */
    int *first, *order;
    double (*low)[3], (*high)[3]; /* boxes */
    int count;
} surfaces;

static void free_surfaces(surfaces *s)
{
    free(s->triangles);
    free(s->first);
    free(s->order);
    free(s->low);
    free(s->high);
}

static void sort_triangles(surfaces *s, const int (*triangles)[3], int triangle_count,
                           const int *surface)
{
    for (int t = 0; t < triangle_count; ++t) {
        s->first[surface[t] + 2]++;
    }
    for (int c = 0; c < s->count; ++c) {
        s->first[c + 2] += s->first[c + 1];
    }
    for (int t = 0; t < triangle_count; ++t) {
        const int place = s->first[surface[t] + 1]++;
        s->order[place] = t;
        memcpy(s->triangles[place], triangles[t], sizeof triangles[t]);
    }
}

static void find_boxes(surfaces *s)
{
    for (int c = 0; c < s->count; ++c) {
        for (int i = 3 * s->first[c]; i < 3 * s->first[c + 1]; ++i) {
            const double *vertex = s->vertices[s->triangles[i / 3][i % 3]];
            const bool is_first = i == 3 * s->first[c];
            for (int k = 0; k < 3; ++k) {
                s->low[c][k] = is_first ? vertex[k] : fmin(s->low[c][k], vertex[k]);
                s->high[c][k] = is_first ? vertex[k] : fmax(s->high[c][k], vertex[k]);
            }
        }
    }
}

static bool create_surfaces(surfaces *s, const double (*vertices)[3], const int (*triangles)[3],
                            int triangle_count, const int *surface, int surface_count,
                            pl_diagnostic *diagnostic)
{
    const size_t count = (size_t)surface_count;
    *s = (surfaces){.vertices = vertices,
                    .triangles = malloc((size_t)triangle_count * sizeof *s->triangles),
                    .first = calloc(count + 2, sizeof *s->first),
                    .order = malloc((size_t)triangle_count * sizeof *s->order),
                    .low = malloc(count * sizeof *s->low),
                    .high = malloc(count * sizeof *s->high),
                    .count = surface_count};
    if (s->triangles == NULL || s->first == NULL || s->order == NULL || s->low == NULL ||
        s->high == NULL) {
        free_surfaces(s);
        pl_diagnose_no_memory(diagnostic);
        return false;
    }
    sort_triangles(s, triangles, triangle_count, surface);
    find_boxes(s);
    return true;
}

static void turn(int triangle[3])
{
    const int swapped = triangle[1];
    triangle[1] = triangle[2];
    triangle[2] = swapped;
}

bool pl_mesh_turn_outward(const double (*vertices)[3], int (*triangles)[3], int triangle_count,
                          const int *surface, int surface_count, pl_diagnostic *diagnostic)
{
    surfaces s;
    if (!create_surfaces(&s, vertices, (const int(*)[3])triangles, triangle_count, surface,
                         surface_count, diagnostic)) {
        return false;
    }
    bool right = true;
    for (int c = 0; c < s.count && right; ++c) {
        const int begin = s.first[c], end = s.first[c + 1];
        double middle[3], six_volumes, two_areas, largest = 0;
        for (int k = 0; k < 3; ++k) {
            middle[k] = s.low[c][k] + (s.high[c][k] - s.low[c][k]) / 2;
            largest = fmax(largest, fmax(-s.low[c][k], s.high[c][k]));
        }
        pl_surface_volume(vertices, (const int(*)[3])s.triangles + begin, end - begin, middle,
                          &six_volumes, &two_areas);
        for (int i = begin; i < end && six_volumes < 0; ++i) {
            turn(triangles[s.order[i]]);
        }
        if (!pl_surface_is_thick(fabs(six_volumes), two_areas, largest)) {
            char found[PL_NUMBER_SIZE];
            pl_path_push_key(&diagnostic->path, "triangles");
            pl_path_push_index(&diagnostic->path, s.order[begin]);
            right = pl_diagnose(diagnostic,
                                "expected a surface that encloses a volume, found %s m^3 in that "
                                "of triangle %d",
                                pl_number_text(six_volumes / 6, found), s.order[begin]);
        }
    }
    free_surfaces(&s);
    return right;
}

static pl_vec corner_from(const surfaces *s, int place, int k, pl_vec point)
{
    return pl_vec_sub(pl_vec_of(s->vertices[s->triangles[place][k]]), point);
}

/* How often surface c goes around the point: 1 inside, 0 outside, between on the surface. */
static double winding(const surfaces *s, int c, pl_vec point)
{
    const double two_pi = 6.28318530717958647692;
    double sum = 0;
    for (int i = s->first[c]; i < s->first[c + 1]; ++i) {
        const pl_vec a = corner_from(s, i, 0, point), b = corner_from(s, i, 1, point);
        const pl_vec d = corner_from(s, i, 2, point);
        const double la = pl_vec_length(a), lb = pl_vec_length(b), ld = pl_vec_length(d);
        const double volume = pl_vec_dot(a, pl_vec_cross(b, d));
        sum += atan2(volume, la * lb * ld + pl_vec_dot(a, b) * ld + pl_vec_dot(b, d) * la +
                                 pl_vec_dot(d, a) * lb);
    }
    return sum / two_pi;
}

static bool in_box(const surfaces *s, int c, pl_vec point)
{
    const double x[3] = {point.x, point.y, point.z};
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
        inside = inside && x[k] >= s->low[c][k] && x[k] <= s->high[c][k];
    }
    return inside;
}

/* 1: surface c lies within surface d; 0: it does not; -1: they touch wherever it was looked. */
static int lies_within(const surfaces *s, int c, int d)
{
    enum { MOST_TRIES = 64 };
    const int begin = s->first[c], count = s->first[c + 1] - begin;
    const int tries = count < MOST_TRIES ? count : MOST_TRIES;
    for (int i = 0; i < tries; ++i) {
        const int place = begin + (int)((long long)i * count / tries);
        const pl_vec zero = {0, 0, 0};
        pl_vec point =
            pl_vec_add(pl_vec_add(corner_from(s, place, 0, zero), corner_from(s, place, 1, zero)),
                       corner_from(s, place, 2, zero));
        point = pl_vec_scale(point, 1.0 / 3);
        if (!in_box(s, d, point)) {
            return 0;
        }
        const double around = winding(s, d, point);
        if (fabs(around - round(around)) < 1e-3) {
            return around > 0.5 ? 1 : 0;
        }
    }
    return -1;
}

static bool turn_if_cavity(const surfaces *s, int c, int (*triangles)[3], pl_diagnostic *diagnostic)
{
    int depth = 0;
    for (int d = 0; d < s->count; ++d) {
        const int within = d == c ? 0 : lies_within(s, c, d);
        if (within < 0) {
            pl_path_push_key(&diagnostic->path, "triangles");
            pl_path_push_index(&diagnostic->path, s->order[s->first[c]]);
            return pl_diagnose(diagnostic,
                               "expected surfaces apart or one in another, found those of "
                               "triangles %d and %d in one place",
                               s->order[s->first[c]], s->order[s->first[d]]);
        }
        depth += within;
    }
    for (int i = s->first[c]; i < s->first[c + 1] && depth % 2 == 1; ++i) {
        turn(triangles[s->order[i]]);
    }
    return true;
}

bool pl_mesh_turn_cavities(const double (*vertices)[3], int (*triangles)[3], int triangle_count,
                           const int *surface, int surface_count, pl_diagnostic *diagnostic)
{
    if (surface_count == 1) {
        return true;
    }
    surfaces s;
    if (!create_surfaces(&s, vertices, (const int(*)[3])triangles, triangle_count, surface,
                         surface_count, diagnostic)) {
        return false;
    }
    bool right = true;
    for (int c = 0; c < s.count && right; ++c) {
        right = turn_if_cavity(&s, c, triangles, diagnostic);
    }
    free_surfaces(&s);
    return right;
}
