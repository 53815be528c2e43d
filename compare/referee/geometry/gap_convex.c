/* The gap of two bounded convex shapes by GJK and libccd's EPA, checked.
 *
 * Signed distance of two convex sets: gap = -min over unit d of h(d), where h is the support
 * function of the Minkowski difference A - B. So every direction that is asked about gives a lower
 * bound of the gap, -h(d), whatever libccd makes of it; and libccd's answer (the radius of a ball
 * inside A - B, or the distance of a point of it) is an upper bound, if libccd is right. An answer
 * is returned only when the two bounds meet; otherwise libccd is asked again, and at last PL_FAILED
 * is returned. That is needed: libccd 2.1 calls some deep pairs touching (see NUDGE).
 *
 * Pairs that are apart, and most are, are settled by the distance query of GJK, which libccd 2.1
 * does not have; it ends early once the lower bound has passed what the caller wants to know of.
 *
 * Shapes are handed over as their cores, a sphere as its centre and a capsule as its segment,
 * because EPA needs ever more facets on a curved surface; their radii are taken off afterwards,
 * which is exact: the signed distance of K + rB is that of K less r. A cylinder stays curved. Of
 * it, libccd's polytope is a rough upper bound only, and the lower bound is polished: from a point
 * a little outside of A - B beyond the best plane so far, GJK finds the nearest point of A - B,
 * whose plane is nearer to the origin still or the same; so it falls to a minimum of h, exactly,
 * and the upper bound says that no other is much lower. Source: Cameron 1997 for the distance from
 * a shifted origin.
 *
 * libccd compares squared lengths with absolute numbers, so shapes are scaled to unit size
 * first. Source: van den Bergen 2003, ch. 4. */
#include "gap.h"
#include "solid.h"

#include <ccd/ccd.h>

#include <stdbool.h>

enum {
    MAX_SUPPORTS = 300, /* of one attempt; EPA itself has no limit */
    MAX_SUPPORTS_CURVED = 600,
    MAX_GJK_ITERATIONS = 1000,
    MAX_ATTEMPTS = 8,
    MAX_POLISHES = 60
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
static const double ROUNDING = 1e-15;
static const double PULL_APART = 1e-6;
/* The same for cylinders: EPA's tolerance, how far apart the bounds may be, and how far outside of
 * A - B a polish starts. */
static const double EPA_TOLERANCE_CURVED = 1e-12;
static const double CERTIFIED_CURVED = 3e-4;
static const double OUTSIDE = 1e-3;

/* The pair as libccd sees it, and what its questions have shown. */
typedef struct query {
    double scale;
    pl_vec centre; /* subtracted, so that a place far from the origin costs no digits */
    pl_vec apart;  /* added to b, but not to what the lower bound sees */
    bool curved;
    int supports;
    double within; /* no more need be known of a gap above it */
    double lower;  /* largest -h(d)/|d| so far */
    pl_vec best;   /* the unit d that gave it */
    pl_vec first;
    pl_vec support_a; /* answer to the last question about a */
} query;

typedef struct convex {
    const pl_shape *shape;
    pl_axes axes;
    pl_vec origin; /* of the shape's frame, less the query's centre */
    query *shared;
} convex;

static pl_vec core_support(const convex *object, pl_vec d)
{
    pl_vec local = pl_core_support(object->shape, pl_to_local(&object->axes, d));
    pl_vec p = pl_vec_add(object->origin, pl_to_world(&object->axes, local));
    return pl_vec_scale(p, object->shared->scale);
}

/* Past the limit every answer is the null vector, which ends GJK and EPA alike. */
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

/* GJK's distance query: the nearest triangle of A - B found so far, improved by one support point
 * at a time. An upper bound of the distance wherever it stops. It stops when the bounds have met,
 * when the shapes prove farther apart than need be known, or when nothing comes nearer. */
static double core_distance(const convex *a, const convex *b)
{
    const query *shared = a->shared;
    pl_vec start = difference_support(a, b, shared->first);
    pl_vec triangle[3] = {start, start, start};
    pl_vec v = start;
    for (int i = 0; i < MAX_GJK_ITERATIONS && !(shared->lower > shared->within); ++i) {
        pl_vec w = difference_support(a, b, pl_vec_scale(v, -1));
        if (pl_vec_dot(v, pl_vec_sub(v, w)) <= ROUNDING * pl_vec_length(v)) {
            break;
        }
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

/* The distance query with b moved by `apart`. */
static void ask_apart(const convex *a, const convex *b, pl_vec apart)
{
    query *shared = a->shared;
    shared->supports = 0;
    shared->apart = apart;
    (void)core_distance(a, b);
}

/* When libccd calls a pair touching it stops at the first element of A - B through the origin, and
 * may never have asked about the direction that proves it. That direction is asked about by the
 * distance query once the shapes are pulled apart a little, centre from centre. */
static void probe_touching(const convex *a, const convex *b)
{
    pl_vec c = pl_vec_sub(b->origin, a->origin);
    double length = pl_vec_length(c);
    if (length > 0) {
        ask_apart(a, b, pl_vec_scale(c, PULL_APART / length));
    }
}

/* Lets the lower bound fall to a minimum of h. */
static void polish(const convex *a, const convex *b)
{
    query *shared = a->shared;
    double before = -HUGE_VAL;
    for (int i = 0; i < MAX_POLISHES && shared->lower > before + ROUNDING; ++i) {
        before = shared->lower;
        shared->first = shared->best;
        ask_apart(a, b, pl_vec_scale(shared->best, OUTSIDE - shared->lower));
    }
}

/* An upper bound of the gap of overlapping cores, which may be false where libccd fails. */
static pl_status upper_bound(const convex *a, const convex *b, const ccd_t *ccd, double *upper)
{
    double depth = 0;
    ccd_vec3_t dir, position;
    int answer = ccdGJKPenetration(a, b, ccd, &depth, &dir, &position);
    if (answer == -2) {
        return PL_NO_MEMORY;
    }
    *upper = answer == 0 ? -depth : core_distance(a, b);
    /* EPA's facets are inside A - B wherever it stops, but facets of a curved surface have no end.
     */
    if (exhausted(a->shared) && !(a->shared->curved && depth > 0)) {
        *upper = HUGE_VAL;
    }
    if (answer == 0 && depth <= CERTIFIED) {
        probe_touching(a, b);
    }
    if (a->shared->curved) {
        polish(a, b);
    }
    return PL_OK;
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
        double upper = HUGE_VAL;
        pl_status status = upper_bound(a, b, &ccd, &upper);
        if (status != PL_OK) {
            return status;
        }
        if (fabs(upper - shared->lower) < fabs(best - shared->lower)) {
            best = upper;
        }
        ccd.epa_tolerance *= 1e-2;
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
    return (convex){placed->shape, pl_axes_of(placed->orientation), origin, shared};
}

static bool is_bounded_and_convex(const pl_shape *shape)
{
    return shape->kind != PL_SHAPE_PLANE && shape->kind != PL_SHAPE_MESH;
}

/* Of two bounded shapes: `within` and the result are of their cores. */
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
            *gap = fmax(*gap, nextafter(within, HUGE_VAL)); /* whatever rounding made of it */
        }
    }
    return status;
}
