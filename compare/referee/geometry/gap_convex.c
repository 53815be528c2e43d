/* The gap of two bounded convex shapes by GJK and by the EPA of libccd, with a check of the result.
 *
 * Signed distance of two convex sets: gap = -min over unit d of h(d), where h is the support
 * function of the Minkowski difference A - B. So every queried direction gives a lower bound of the
 * gap, -h(d), even if libccd fails; and the result of libccd (the radius of a ball inside A - B, or
 * the distance of a point of A - B) is an upper bound, if libccd is right. A gap is returned only
 * if the two bounds meet. Otherwise libccd is called again, and after the last attempt PL_FAILED is
 * returned. This check is needed: libccd 2.1 takes some deep pairs for touching ones (see NUDGE).
 *
 * Most pairs are apart. They are settled by the distance query of GJK, which libccd 2.1 lacks. It
 * ends early once the lower bound exceeds the gap of interest.
 *
 * libccd gets the cores of the shapes, the centre of a sphere and the segment of a capsule, because
 * EPA needs ever more facets on a curved surface. The radii are subtracted afterwards, which is
 * exact: the signed distance of K + rB is that of K minus r. A cylinder stays curved. For a
 * cylinder the polytope of libccd is only a rough upper bound, and the lower bound is improved:
 * from a point a little outside of A - B, beyond the best plane so far, GJK finds the nearest point
 * of A - B. Its plane is at least as near to the origin, so this descends exactly to a minimum of
 * h, and the upper bound shows that no other minimum is much lower. Source: Cameron 1997 for the
 * distance from a translated origin.
 *
 * libccd compares squared lengths with absolute numbers, so the shapes are scaled to unit size
 * first. Source: van den Bergen 2003, ch. 4. */
#include "base/heap.h"
#include "gap.h"
#include "solid.h"

#include <ccd/ccd.h>

#include <stdint.h>

enum {
    MAX_SUPPORTS = 300, /* support queries of one attempt; EPA itself has no limit */
    MAX_SUPPORTS_CURVED = 600,
    MAX_GJK_ITERATIONS = 1000,
    MAX_ATTEMPTS = 8,
    MAX_DESCENTS = 60
};

/* Tolerance of EPA in the first attempt, for shapes of unit size: on the product of the depth and
 * its error, and on the squared distance of a new vertex from its facet, so that facets that differ
 * by less than 1e-7 are merged. Each further attempt has a hundredth of it. It cannot start at
 * 1e-18: there rounding of the product can look like progress, and EPA splits facets until it
 * reaches the limit of queries. */
static const double EPA_TOLERANCE = 1e-14;
/* All in units of the shapes' size. libccd takes a depth below sqrt(DBL_EPSILON) = 1.5e-8 for
 * touching, and so it takes a deep pair when the origin is on an edge of its first simplices, as
 * with aligned boxes. Further attempts move one shape by a little more than that, in a direction in
 * general position. The lower bound is always that of the unmoved shapes, so the result loses no
 * accuracy. */
static const double NUDGE = 4e-8;
/* The largest accepted difference of the bounds (the touching depth and the nudge), and the
 * difference below which no further attempt is made. */
static const double CERTIFIED = 6e-8;
static const double EXACT = 1e-13;
static const double ROUNDING = 1e-15;
static const double PULL_APART = 1e-6;
/* For cylinders: EPA's tolerance, the largest accepted difference of the bounds, and the distance
 * outside of A - B at which a descent starts. */
static const double EPA_TOLERANCE_CURVED = 1e-12;
static const double CERTIFIED_CURVED = 3e-4;
static const double OUTSIDE = 1e-3;

/* One of the shapes. */
typedef struct convex {
    const pl_shape *shape;
    pl_axes axes;
    pl_vec origin; /* of the shape's frame, less the query's centre */
    pl_vec middle; /* the centre of mass, a point inside, less the query's centre */
} convex;

/* The pair as libccd gets it, and the results of its support queries. */
typedef struct query {
    convex a, b;
    double radii; /* of both cores, m */
    double scale;
    pl_vec apart; /* added to b, except in the lower bound */
    bool curved;
    int supports;
    double within; /* a gap above it need not be computed */
    double lower;  /* largest -h(d)/|d| so far */
    pl_vec best;   /* the unit d that gave it */
    pl_vec first;
    pl_vec support_a; /* result of the last query of a */
} query;

static pl_vec core_support(const query *q, const convex *object, pl_vec d)
{
    pl_vec local = pl_core_support(object->shape, pl_to_local(&object->axes, d));
    pl_vec p = pl_vec_add(object->origin, pl_to_world(&object->axes, local));
    return pl_vec_scale(p, q->scale);
}

/* Beyond the limit every query returns the null vector, which ends GJK and EPA. */
static bool exhausted(const query *q)
{
    return q->supports > (q->curved ? MAX_SUPPORTS_CURVED : MAX_SUPPORTS);
}

static pl_vec support_first(query *q, pl_vec d)
{
    q->supports += 1;
    q->support_a = exhausted(q) ? (pl_vec){0, 0, 0} : core_support(q, &q->a, d);
    return q->support_a;
}

/* Called right after support_first, with the opposite direction. */
static pl_vec support_second(query *q, pl_vec d)
{
    if (exhausted(q)) {
        return (pl_vec){0, 0, 0};
    }
    const pl_vec p = core_support(q, &q->b, d);
    const double length = pl_vec_length(d);
    const double bound =
        length > 0 ? pl_vec_dot(pl_vec_sub(q->support_a, p), d) / length : -HUGE_VAL;
    if (bound > q->lower) {
        q->lower = bound;
        q->best = pl_vec_scale(d, -1 / length);
    }
    return pl_vec_add(p, q->apart);
}

/* The point of A - B farthest along d. */
static pl_vec difference_support(query *q, pl_vec d)
{
    const pl_vec of_a = support_first(q, d);
    return pl_vec_sub(of_a, support_second(q, pl_vec_scale(d, -1)));
}

/* ---- libccd gets the query in place of either object ---- */

static query *query_of(const void *object)
{
    return (query *)(uintptr_t)object;
}

static void ccd_support_first(const void *object, const ccd_vec3_t *dir, ccd_vec3_t *out)
{
    pl_vec_store(support_first(query_of(object), pl_vec_of(dir->v)), out->v);
}

static void ccd_support_second(const void *object, const ccd_vec3_t *dir, ccd_vec3_t *out)
{
    pl_vec_store(support_second(query_of(object), pl_vec_of(dir->v)), out->v);
}

static void ccd_first_direction(const void *a, const void *b, ccd_vec3_t *dir)
{
    (void)b;
    pl_vec_store(query_of(a)->first, dir->v);
}

/* A direction in general position to every axis: powers of the plastic number, modulo 1. */
static pl_vec attempt_direction(int attempt)
{
    double k = attempt + 1;
    return (pl_vec){fmod(0.8191725133961645 * k, 1) - 0.5, fmod(0.6710436067037893 * k, 1) - 0.5,
                    fmod(0.5497004779019703 * k, 1) - 0.5};
}

/* The distance query of GJK. It keeps the nearest triangle of A - B so far and improves it by one
 * support point at a time. The result is an upper bound of the distance at any stop. It stops when
 * the bounds meet, when the gap is above `within`, or when no support point is nearer. */
static double core_distance(query *q)
{
    pl_vec start = difference_support(q, q->first);
    const pl_vec origin = {0, 0, 0};
    pl_triangle triangle = {{start, start, start}};
    pl_vec v = start;
    for (int i = 0; i < MAX_GJK_ITERATIONS && !(q->lower > q->within); ++i) {
        pl_vec w = difference_support(q, pl_vec_scale(v, -1));
        if (pl_vec_dot(v, pl_vec_sub(v, w)) <= ROUNDING * pl_vec_length(v)) {
            break;
        }
        pl_vec best = v;
        int replaced = -1;
        for (int k = 0; k < 3; ++k) {
            pl_triangle t = triangle;
            t.corner[k] = w;
            pl_vec p = pl_triangle_nearest(&t, origin, NULL);
            if (pl_vec_dot(p, p) < pl_vec_dot(best, best)) {
                best = p;
                replaced = k;
            }
        }
        if (replaced < 0) {
            break;
        }
        triangle.corner[replaced] = w;
        v = best;
    }
    return pl_vec_length(v);
}

/* The distance query with b moved by `apart`. It raises the lower bound. */
static void query_apart(query *q, pl_vec apart)
{
    q->supports = 0;
    q->apart = apart;
    (void)core_distance(q);
}

/* When libccd finds a pair touching, it stops at the first simplex of A - B through the origin, and
 * may not have queried the direction that proves it. The distance query does so once the shapes are
 * moved apart a little, centre from centre. */
static void probe_touching(query *q)
{
    pl_vec c = pl_vec_sub(q->b.middle, q->a.middle);
    double length = pl_vec_length(c);
    if (length > 0) {
        query_apart(q, pl_vec_scale(c, PULL_APART / length));
    }
}

/* Raises the lower bound to that of a local minimum of h. */
static void descend(query *q)
{
    double before = -HUGE_VAL;
    for (int i = 0; i < MAX_DESCENTS && q->lower > before + ROUNDING; ++i) {
        before = q->lower;
        q->first = q->best;
        query_apart(q, pl_vec_scale(q->best, OUTSIDE - q->lower));
    }
}

/* An upper bound of the gap of overlapping cores, which may be wrong if libccd fails. */
static double upper_bound(query *q, const ccd_t *ccd)
{
    double depth = 0;
    ccd_vec3_t dir, position;
    int code = ccdGJKPenetration(q, q, ccd, &depth, &dir, &position);
    if (code == -2) {
        pl_out_of_memory();
    }
    double upper = code == 0 ? -depth : core_distance(q);
    /* EPA's facets are always inside A - B. On a curved surface EPA always reaches the limit. */
    if (exhausted(q) && !(q->curved && depth > 0)) {
        upper = HUGE_VAL;
    }
    if (code == 0 && depth <= CERTIFIED) {
        probe_touching(q);
    }
    if (q->curved) {
        descend(q);
    }
    return upper;
}

/* Finds the gap of overlapping cores, q->lower. */
static pl_status core_depth(query *q)
{
    const double certified = q->curved ? CERTIFIED_CURVED : CERTIFIED;
    const double exact = q->curved ? CERTIFIED_CURVED : EXACT;
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.first_dir = ccd_first_direction;
    ccd.support1 = ccd_support_first;
    ccd.support2 = ccd_support_second;
    ccd.max_iterations = MAX_GJK_ITERATIONS;
    ccd.epa_tolerance = q->curved ? EPA_TOLERANCE_CURVED : EPA_TOLERANCE;
    double best = HUGE_VAL;
    for (int attempt = 0; attempt < MAX_ATTEMPTS && fabs(best - q->lower) > exact; ++attempt) {
        q->supports = 0;
        q->first = attempt_direction(attempt);
        q->apart = pl_vec_scale(q->first, attempt > 0 ? NUDGE : 0);
        const double upper = upper_bound(q, &ccd);
        if (fabs(upper - q->lower) < fabs(best - q->lower)) {
            best = upper;
        }
        ccd.epa_tolerance *= 1e-2;
    }
    if (fabs(best - q->lower) > certified) {
        descend(q);
    }
    return fabs(best - q->lower) <= certified ? PL_OK : PL_FAILED;
}

static bool is_bounded_and_convex(const pl_shape *shape)
{
    return shape->kind != PL_SHAPE_PLANE && shape->kind != PL_SHAPE_MESH;
}

/* `centre` is subtracted, so that a position far from the origin loses no digits. */
static convex place(const pl_placed_shape *s, pl_vec centre)
{
    const pl_vec middle = pl_centre_of_mass(s->shape, s->position, s->orientation);
    return (convex){s->shape, pl_axes_of(s->orientation),
                    pl_vec_sub(pl_vec_of(s->position), centre), pl_vec_sub(middle, centre)};
}

/* A query of two bounded shapes. Its bounds are of their cores, in scaled units. */
static query begin(const pl_placed_shape *a, const pl_placed_shape *b, double within)
{
    const pl_vec centre = pl_centre_of_mass(a->shape, a->position, a->orientation);
    query q = {.a = place(a, centre),
               .b = place(b, centre),
               .radii = pl_core_radius(a->shape) + pl_core_radius(b->shape),
               .scale = 1 / (pl_bounding_radius(a->shape) + pl_bounding_radius(b->shape)),
               .curved = a->shape->kind == PL_SHAPE_CYLINDER || b->shape->kind == PL_SHAPE_CYLINDER,
               .lower = -HUGE_VAL};
    q.within = (within + q.radii) * q.scale;
    q.first = pl_vec_sub(q.b.origin, q.a.origin);
    return q;
}

double pl_distance_convex(const pl_placed_shape *a, const pl_placed_shape *b, double within)
{
    query q = begin(a, b, within);
    (void)core_distance(&q);
    return fmax(q.lower / q.scale - q.radii, 0);
}

pl_status pl_gap_convex(const pl_placed_shape *a, const pl_placed_shape *b, double within,
                        double *gap)
{
    if (!is_bounded_and_convex(a->shape) || !is_bounded_and_convex(b->shape)) {
        return PL_UNSUPPORTED;
    }
    query q = begin(a, b, within);
    const double upper = core_distance(&q);
    const bool is_known = q.lower > q.within || upper - q.lower <= EXACT;
    const pl_status status = is_known ? PL_OK : core_depth(&q);
    if (status == PL_OK) {
        *gap = q.lower / q.scale - pl_core_radius(a->shape) - pl_core_radius(b->shape);
        if (q.lower > q.within) {
            *gap = fmax(*gap, nextafter(within, HUGE_VAL)); /* also after rounding */
        }
    }
    return status;
}
