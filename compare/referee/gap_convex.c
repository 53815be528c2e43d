/* The gap of two bounded convex shapes by libccd (GJK and EPA), checked.
 *
 * Signed distance of two convex sets: gap = -min over unit d of h(d), where h is the support
 * function of the Minkowski difference A - B. So every direction that is asked about gives a lower
 * bound of the gap, -h(d), whatever libccd makes of it; and libccd's answer (the radius of a ball
 * inside A - B, or the distance of a point of it) is an upper bound, if libccd is right. An answer
 * is returned only when the two bounds meet; otherwise libccd is asked again, and at last PL_FAILED
 * is returned. That is needed: libccd 2.1 calls some deep pairs touching (see NUDGE).
 *
 * A sphere is handed over as its centre, because EPA needs ever more facets on a curved surface;
 * its radius is taken off afterwards, which is exact: the signed distance of K + rB is that of K
 * less r. libccd compares squared lengths with absolute numbers, so shapes are scaled to unit size
 * first. Source: van den Bergen 2003, ch. 4. */
#include "plumb/vec.h"
#include "referee/gap.h"

#include <ccd/ccd.h>

#include <stdbool.h>

enum {
    MAX_SUPPORTS = 300, /* of one attempt; EPA itself has no limit */
    MAX_GJK_ITERATIONS = 1000,
    MAX_ATTEMPTS = 8
};

/* Of EPA's first attempt, for shapes of unit size: on the product of the depth and its error, and
 * on the square of a new vertex's distance from its facet, so that facets off by less than 1e-7 are
 * taken for one. Each further attempt has a hundredth of it. It cannot begin at 1e-18: there the
 * rounding of the product can pass for progress, and EPA splits facets until its questions run out.
 */
static const double EPA_TOLERANCE = 1e-14;
/* All in units of the shapes' size. libccd takes a depth below sqrt(DBL_EPSILON) = 1.5e-8 for
 * touching, and calls a deep pair touching when the origin falls on an edge of its first simplices,
 * as with aligned boxes. Further attempts are made of shapes nudged by a little more, in a
 * direction in general position; the lower bound is of the shapes as they are, so that the nudge
 * costs the answer no accuracy. */
static const double NUDGE = 4e-8;
/* How far apart the bounds may seem (the touching depth and the nudge), and when to stop trying for
 * better. */
static const double CERTIFIED = 6e-8;
static const double EXACT = 1e-13;
static const double PULL_APART = 1e-6;

/* The pair as libccd sees it, and what its questions have shown. */
typedef struct query {
    double scale;
    pl_vec centre; /* subtracted, so that a place far from the origin costs no digits */
    pl_vec apart;  /* added to b, but not to what the lower bound sees */
    int supports;
    double lower; /* largest -h(d)/|d| so far */
    pl_vec first;
    pl_vec support_a; /* answer to the last question about a */
} query;

typedef struct convex {
    const pl_placed_shape *placed;
    pl_axes axes;
    query *shared;
} convex;

/* Support point of the shape's core: a box's vertex, a sphere's centre. */
static pl_vec core_support(const convex *object, pl_vec d)
{
    const pl_shape *shape = object->placed->shape;
    pl_vec p = pl_vec_sub(pl_vec_of(object->placed->position), object->shared->centre);
    if (shape->kind == PL_SHAPE_BOX) {
        pl_vec local = pl_to_local(&object->axes, d);
        pl_vec vertex = {copysign(shape->half_extents[0], local.x),
                         copysign(shape->half_extents[1], local.y),
                         copysign(shape->half_extents[2], local.z)};
        p = pl_vec_add(p, pl_to_world(&object->axes, vertex));
    }
    return pl_vec_scale(p, object->shared->scale);
}

/* Past the limit every answer is the null vector, which ends GJK and EPA alike. */
static bool exhausted(const query *shared)
{
    return shared->supports > MAX_SUPPORTS;
}

static void support_first(const void *object, const ccd_vec3_t *dir, ccd_vec3_t *out)
{
    const convex *a = object;
    a->shared->supports += 1;
    pl_vec p = exhausted(a->shared) ? (pl_vec){0, 0, 0} : core_support(a, pl_vec_of(dir->v));
    a->shared->support_a = p;
    ccdVec3Set(out, p.x, p.y, p.z);
}

/* Comes right after support_first, with the opposite direction. */
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
        shared->lower = fmax(shared->lower, bound);
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

/* Directions in general position to every axis: powers of the plastic number, mod 1. */
static pl_vec attempt_direction(int attempt)
{
    double k = attempt + 1;
    return (pl_vec){fmod(0.8191725133961645 * k, 1) - 0.5, fmod(0.6710436067037893 * k, 1) - 0.5,
                    fmod(0.5497004779019703 * k, 1) - 0.5};
}

/* A point of A - B far along d. */
static pl_vec difference_support(const convex *a, const convex *b, pl_vec d)
{
    ccd_vec3_t along = {{d.x, d.y, d.z}}, against = {{-d.x, -d.y, -d.z}}, of_a, of_b;
    support_first(a, &along, &of_a);
    support_second(b, &against, &of_b);
    return pl_vec_sub(pl_vec_of(of_a.v), pl_vec_of(of_b.v));
}

/* The nearer to the origin of `best` and the nearest point of segment ab. */
static pl_vec nearer_on_segment(pl_vec best, pl_vec a, pl_vec b)
{
    pl_vec ab = pl_vec_sub(b, a);
    double square = pl_vec_dot(ab, ab);
    double t = square > 0 ? fmin(fmax(-pl_vec_dot(a, ab) / square, 0), 1) : 0;
    pl_vec p = pl_vec_mad(a, t, ab);
    return pl_vec_dot(p, p) < pl_vec_dot(best, best) ? p : best;
}

/* The point of a triangle (or of the segment or point it has collapsed to) nearest to the origin.
 */
static pl_vec nearest_on_triangle(const pl_vec t[3])
{
    pl_vec n = pl_vec_cross(pl_vec_sub(t[1], t[0]), pl_vec_sub(t[2], t[0]));
    double square = pl_vec_dot(n, n);
    pl_vec p = pl_vec_scale(n, square > 0 ? pl_vec_dot(n, t[0]) / square : 0);
    bool inside = square > 0;
    for (int i = 0; i < 3; ++i) {
        pl_vec edge = pl_vec_sub(t[(i + 1) % 3], t[i]);
        inside = inside && pl_vec_dot(pl_vec_cross(edge, pl_vec_sub(p, t[i])), n) >= 0;
    }
    if (inside) {
        return p;
    }
    return nearer_on_segment(nearer_on_segment(nearer_on_segment(t[0], t[0], t[1]), t[1], t[2]),
                             t[2], t[0]);
}

/* GJK's distance query, which libccd 2.1 does not have: the nearest triangle of A - B found so far,
 * improved by one support point at a time. An upper bound of the distance wherever it stops. */
static double core_distance(const convex *a, const convex *b)
{
    const query *shared = a->shared;
    pl_vec start = difference_support(a, b, shared->first);
    pl_vec triangle[3] = {start, start, start};
    pl_vec v = start;
    for (int i = 0; i < MAX_GJK_ITERATIONS; ++i) {
        pl_vec w = difference_support(a, b, pl_vec_scale(v, -1));
        pl_vec best = v;
        int replaced = -1;
        for (int k = 0; k < 3; ++k) {
            pl_vec t[3] = {triangle[0], triangle[1], triangle[2]};
            t[k] = w;
            pl_vec p = nearest_on_triangle(t);
            if (pl_vec_dot(p, p) < pl_vec_dot(best, best)) {
                best = p;
                replaced = k;
            }
        }
        if (replaced < 0) {
            break;
        }
        triangle[replaced] = w;
        v = best;
    }
    return pl_vec_length(v);
}

/* When libccd calls a pair touching it stops at the first element of A - B through the origin, and
 * may never have asked about the direction that proves it. That direction is asked about by the
 * distance query once the shapes are pulled apart a little, centre from centre. */
static void probe_touching(const convex *a, const convex *b)
{
    query *shared = a->shared;
    pl_vec c = pl_vec_sub(pl_vec_of(b->placed->position), pl_vec_of(a->placed->position));
    double length = pl_vec_length(c);
    if (length > 0) {
        shared->apart = pl_vec_scale(c, PULL_APART / length);
        (void)core_distance(a, b);
    }
}

/* An upper bound of the gap of the cores, which may be false where libccd fails. */
static pl_status upper_bound(const convex *a, const convex *b, const ccd_t *ccd, double *upper)
{
    double depth = 0;
    ccd_vec3_t dir, position;
    int answer = ccdGJKPenetration(a, b, ccd, &depth, &dir, &position);
    if (answer == -2) {
        return PL_NO_MEMORY;
    }
    *upper = answer == 0 ? -depth : core_distance(a, b);
    if (answer == 0 && depth <= CERTIFIED) {
        probe_touching(a, b);
    }
    return PL_OK;
}

/* The gap of the cores in scaled units. */
static pl_status core_gap(const convex *a, const convex *b, double *gap)
{
    query *shared = a->shared;
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.first_dir = first_direction;
    ccd.support1 = support_first;
    ccd.support2 = support_second;
    ccd.max_iterations = MAX_GJK_ITERATIONS;
    ccd.epa_tolerance = EPA_TOLERANCE;
    double best = HUGE_VAL;
    for (int attempt = 0; attempt < MAX_ATTEMPTS && fabs(best - shared->lower) > EXACT; ++attempt) {
        shared->supports = 0;
        shared->first = attempt_direction(attempt);
        shared->apart = pl_vec_scale(shared->first, attempt > 0 ? NUDGE : 0);
        double upper = HUGE_VAL;
        pl_status status = upper_bound(a, b, &ccd, &upper);
        if (status != PL_OK) {
            return status;
        }
        if (!exhausted(shared) && fabs(upper - shared->lower) < fabs(best - shared->lower)) {
            best = upper;
        }
        ccd.epa_tolerance *= 1e-2;
    }
    *gap = shared->lower;
    return fabs(best - shared->lower) <= CERTIFIED ? PL_OK : PL_FAILED;
}

static double bounding_radius(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_BOX ? pl_vec_length(pl_vec_of(shape->half_extents))
                                       : shape->radius;
}

/* What has been taken off the shape to make its core. */
static double core_radius(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_SPHERE ? shape->radius : 0;
}

/* The gap by the support point of a bounded shape against a plane's normal. */
static double plane_support_gap(const pl_shape *plane, const pl_placed_shape *other)
{
    query shared = {.scale = 1, .centre = pl_vec_of(other->position)};
    convex object = {.placed = other, .axes = pl_axes_of(other->orientation), .shared = &shared};
    pl_vec n = pl_vec_of(plane->normal);
    pl_vec lowest = core_support(&object, pl_vec_scale(n, -1));
    return pl_vec_dot(n, shared.centre) - plane->offset + pl_vec_dot(n, lowest) -
           core_radius(other->shape);
}

pl_status pl_gap_convex(const pl_placed_shape *a, const pl_placed_shape *b, double *gap)
{
    if (a->shape->kind == PL_SHAPE_PLANE || b->shape->kind == PL_SHAPE_PLANE) {
        const pl_placed_shape *plane = a->shape->kind == PL_SHAPE_PLANE ? a : b;
        const pl_placed_shape *other = plane == a ? b : a;
        if (other->shape->kind == PL_SHAPE_PLANE) {
            return PL_UNSUPPORTED;
        }
        *gap = plane_support_gap(plane->shape, other);
        return PL_OK;
    }
    query shared = {.scale = 1 / (bounding_radius(a->shape) + bounding_radius(b->shape)),
                    .centre = pl_vec_of(a->position),
                    .lower = -HUGE_VAL};
    convex object_a = {.placed = a, .axes = pl_axes_of(a->orientation), .shared = &shared};
    convex object_b = {.placed = b, .axes = pl_axes_of(b->orientation), .shared = &shared};
    double core = 0;
    pl_status status = core_gap(&object_a, &object_b, &core);
    if (status == PL_OK) {
        *gap = core / shared.scale - core_radius(a->shape) - core_radius(b->shape);
    }
    return status;
}
