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
#include "segment.h"
#include "solid.h"

#include <ccd/ccd.h>

#include <stdbool.h>

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

/* The pair as libccd gets it, and the results of its support queries. */
typedef struct query {
    double scale;
    pl_vec centre; /* subtracted, so that a position far from the origin loses no digits */
    pl_vec apart;  /* added to b, except in the lower bound */
    bool curved;
    int supports;
    double within; /* a gap above it need not be computed */
    double lower;  /* largest -h(d)/|d| so far */
    pl_vec best;   /* the unit d that gave it */
    pl_vec first;
    pl_vec support_a; /* result of the last query of a */
} query;

typedef struct convex {
    const pl_shape *shape;
    pl_axes axes;
    pl_vec origin; /* of the shape's frame, less the query's centre */
    pl_vec middle; /* the centre of mass, a point inside, less the query's centre */
    query *shared;
} convex;

static pl_vec core_support(const convex *object, pl_vec d)
{
    pl_vec local = pl_core_support(object->shape, pl_to_local(&object->axes, d));
    pl_vec p = pl_vec_add(object->origin, pl_to_world(&object->axes, local));
    return pl_vec_scale(p, object->shared->scale);
}

/* Beyond the limit every query returns the null vector, which ends GJK and EPA. */
static bool exhausted(const query *shared)
{
    return shared->supports > (shared->curved ? MAX_SUPPORTS_CURVED : MAX_SUPPORTS);
}

static void support_first(const void *object, const ccd_vec3_t *dir, ccd_vec3_t *out)
{
    const convex *a = object;
    a->shared->supports += 1;
    pl_vec p = exhausted(a->shared) ? (pl_vec){0, 0, 0} : core_support(a, pl_vec_of(dir->v));
    a->shared->support_a = p;
    ccdVec3Set(out, p.x, p.y, p.z);
}

/* libccd calls it right after support_first, with the opposite direction. */
static void support_second(const void *object, const ccd_vec3_t *dir, ccd_vec3_t *out)
{
    const convex *b = object;
    query *shared = b->shared;
    if (exhausted(shared)) {
        ccdVec3Set(out, 0, 0, 0);
        return;
    }
    pl_vec d = pl_vec_of(dir->v);
    pl_vec p = core_support(b, d);
    double length = pl_vec_length(d);
    if (length > 0) {
        double bound = pl_vec_dot(pl_vec_sub(shared->support_a, p), d) / length;
        if (bound > shared->lower) {
            shared->lower = bound;
            shared->best = pl_vec_scale(d, -1 / length);
        }
    }
    p = pl_vec_add(p, shared->apart);
    ccdVec3Set(out, p.x, p.y, p.z);
}

static void first_direction(const void *a, const void *b, ccd_vec3_t *dir)
{
    (void)b;
    pl_vec d = ((const convex *)a)->shared->first;
    ccdVec3Set(dir, d.x, d.y, d.z);
}

/* A direction in general position to every axis: powers of the plastic number, modulo 1. */
static pl_vec attempt_direction(int attempt)
{
    double k = attempt + 1;
    return (pl_vec){fmod(0.8191725133961645 * k, 1) - 0.5, fmod(0.6710436067037893 * k, 1) - 0.5,
                    fmod(0.5497004779019703 * k, 1) - 0.5};
}

/* The point of A - B farthest along d. */
static pl_vec difference_support(const convex *a, const convex *b, pl_vec d)
{
    ccd_vec3_t along = {{d.x, d.y, d.z}}, against = {{-d.x, -d.y, -d.z}}, of_a, of_b;
    support_first(a, &along, &of_a);
    support_second(b, &against, &of_b);
    return pl_vec_sub(pl_vec_of(of_a.v), pl_vec_of(of_b.v));
}

/* The distance query of GJK. It keeps the nearest triangle of A - B so far and improves it by one
 * support point at a time. The result is an upper bound of the distance at any stop. It stops when
 * the bounds meet, when the gap is above `within`, or when no support point is nearer. */
static double core_distance(const convex *a, const convex *b)
{
    const query *shared = a->shared;
    pl_vec start = difference_support(a, b, shared->first);
    const pl_vec origin = {0, 0, 0};
    pl_triangle triangle = {{start, start, start}};
    pl_vec v = start;
    for (int i = 0; i < MAX_GJK_ITERATIONS && !(shared->lower > shared->within); ++i) {
        pl_vec w = difference_support(a, b, pl_vec_scale(v, -1));
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
static void query_apart(const convex *a, const convex *b, pl_vec apart)
{
    query *shared = a->shared;
    shared->supports = 0;
    shared->apart = apart;
    (void)core_distance(a, b);
}

/* When libccd finds a pair touching, it stops at the first simplex of A - B through the origin, and
 * may not have queried the direction that proves it. The distance query does so once the shapes are
 * moved apart a little, centre from centre. */
static void probe_touching(const convex *a, const convex *b)
{
    pl_vec c = pl_vec_sub(b->middle, a->middle);
    double length = pl_vec_length(c);
    if (length > 0) {
        query_apart(a, b, pl_vec_scale(c, PULL_APART / length));
    }
}

/* Raises the lower bound to that of a local minimum of h. */
static void descend(const convex *a, const convex *b)
{
    query *shared = a->shared;
    double before = -HUGE_VAL;
    for (int i = 0; i < MAX_DESCENTS && shared->lower > before + ROUNDING; ++i) {
        before = shared->lower;
        shared->first = shared->best;
        query_apart(a, b, pl_vec_scale(shared->best, OUTSIDE - shared->lower));
    }
}

/* An upper bound of the gap of overlapping cores, which may be wrong if libccd fails. */
static double upper_bound(const convex *a, const convex *b, const ccd_t *ccd)
{
    double depth = 0;
    ccd_vec3_t dir, position;
    int code = ccdGJKPenetration(a, b, ccd, &depth, &dir, &position);
    if (code == -2) {
        pl_out_of_memory();
    }
    double upper = code == 0 ? -depth : core_distance(a, b);
    /* EPA's facets are always inside A - B. On a curved surface EPA always reaches the limit. */
    if (exhausted(a->shared) && !(a->shared->curved && depth > 0)) {
        upper = HUGE_VAL;
    }
    if (code == 0 && depth <= CERTIFIED) {
        probe_touching(a, b);
    }
    if (a->shared->curved) {
        descend(a, b);
    }
    return upper;
}

/* The gap of overlapping cores in scaled units. */
static pl_status core_depth(const convex *a, const convex *b, double *gap)
{
    query *shared = a->shared;
    const double certified = shared->curved ? CERTIFIED_CURVED : CERTIFIED;
    const double exact = shared->curved ? CERTIFIED_CURVED : EXACT;
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.first_dir = first_direction;
    ccd.support1 = support_first;
    ccd.support2 = support_second;
    ccd.max_iterations = MAX_GJK_ITERATIONS;
    ccd.epa_tolerance = shared->curved ? EPA_TOLERANCE_CURVED : EPA_TOLERANCE;
    double best = HUGE_VAL;
    for (int attempt = 0; attempt < MAX_ATTEMPTS && fabs(best - shared->lower) > exact; ++attempt) {
        shared->supports = 0;
        shared->first = attempt_direction(attempt);
        shared->apart = pl_vec_scale(shared->first, attempt > 0 ? NUDGE : 0);
        const double upper = upper_bound(a, b, &ccd);
        if (fabs(upper - shared->lower) < fabs(best - shared->lower)) {
            best = upper;
        }
        ccd.epa_tolerance *= 1e-2;
    }
    if (fabs(best - shared->lower) > certified) {
        descend(a, b);
    }
    *gap = shared->lower;
    return fabs(best - shared->lower) <= certified ? PL_OK : PL_FAILED;
}

/* The gap of the cores in scaled units. */
static pl_status core_gap(const convex *a, const convex *b, double *gap)
{
    query *shared = a->shared;
    shared->first = pl_vec_sub(b->origin, a->origin);
    double upper = core_distance(a, b);
    if (shared->lower > shared->within || upper - shared->lower <= EXACT) {
        *gap = shared->lower;
        return PL_OK;
    }
    return core_depth(a, b, gap);
}

static convex place(const pl_placed_shape *placed, query *shared)
{
    pl_vec origin = pl_vec_sub(pl_vec_of(placed->position), shared->centre);
    pl_vec middle = pl_centre_of_mass(placed->shape, placed->position, placed->orientation);
    return (convex){placed->shape, pl_axes_of(placed->orientation), origin,
                    pl_vec_sub(middle, shared->centre), shared};
}

static bool is_bounded_and_convex(const pl_shape *shape)
{
    return shape->kind != PL_SHAPE_PLANE && shape->kind != PL_SHAPE_MESH;
}

/* A query of two bounded shapes. Its bounds are of their cores, in scaled units. */
static query begin(const pl_placed_shape *a, const pl_placed_shape *b, double within)
{
    double radii = pl_core_radius(a->shape) + pl_core_radius(b->shape);
    double scale = 1 / (pl_bounding_radius(a->shape) + pl_bounding_radius(b->shape));
    return (query){.scale = scale,
                   .centre = pl_centre_of_mass(a->shape, a->position, a->orientation),
                   .curved =
                       a->shape->kind == PL_SHAPE_CYLINDER || b->shape->kind == PL_SHAPE_CYLINDER,
                   .within = (within + radii) * scale,
                   .lower = -HUGE_VAL};
}

double pl_distance_convex(const pl_placed_shape *a, const pl_placed_shape *b, double within)
{
    query shared = begin(a, b, within);
    convex object_a = place(a, &shared), object_b = place(b, &shared);
    shared.first = pl_vec_sub(object_b.origin, object_a.origin);
    (void)core_distance(&object_a, &object_b);
    double radii = pl_core_radius(a->shape) + pl_core_radius(b->shape);
    return fmax(shared.lower / shared.scale - radii, 0);
}

pl_status pl_gap_convex(const pl_placed_shape *a, const pl_placed_shape *b, double within,
                        double *gap)
{
    if (!is_bounded_and_convex(a->shape) || !is_bounded_and_convex(b->shape)) {
        return PL_UNSUPPORTED;
    }
    query shared = begin(a, b, within);
    convex object_a = place(a, &shared), object_b = place(b, &shared);
    double core = 0;
    pl_status status = core_gap(&object_a, &object_b, &core);
    if (status == PL_OK) {
        *gap = core / shared.scale - pl_core_radius(a->shape) - pl_core_radius(b->shape);
        if (shared.lower > shared.within) {
            *gap = fmax(*gap, nextafter(within, HUGE_VAL)); /* also after rounding */
        }
    }
    return status;
}
