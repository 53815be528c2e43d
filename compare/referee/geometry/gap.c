/* The gap of any pair, and signed distances that have a closed form:
 *
 *   plane-X           support of X against the normal, minus the offset
 *   sphere-sphere     |c| - r_a - r_b
 *   sphere-box        the signed distance of the centre from the box, minus r; likewise for a
 *                     cylinder
 *   sphere-capsule    the distance of the centre from the capsule's segment, minus r_a + r_b
 *   capsule-capsule   the distance of the two segments, minus r_a + r_b
 *   box-box           max over 15 unit axes n of |n.c| - r_a(n) - r_b(n) (separating axis theorem)
 *
 * with c from centre to centre and r(n) the half width of a box along n. The 15 axes are the
 * normals of all facets of the Minkowski difference. If the boxes overlap, the largest of the
 * (negative) numbers is minus the exact depth; if they are apart, it is a lower bound of the
 * distance. Source: Gottschalk, Lin and Manocha 1996, sec. 5; Ericson 2005, sec. 4.4 and 5.1.4. */
#include "gap.h"
#include "solid.h"

/* Half width of a box along a unit vector given in the box's own axes. */
static double half_width(const double half[3], pl_vec n)
{
    return half[0] * fabs(n.x) + half[1] * fabs(n.y) + half[2] * fabs(n.z);
}

static double plane_gap(const pl_shape *plane, const pl_placed_shape *other)
{
    pl_vec n = pl_vec_of(plane->normal);
    double height = pl_vec_dot(n, pl_vec_of(other->position)) - plane->offset;
    pl_axes axes = pl_axes_of(other->orientation);
    pl_vec down = pl_to_local(&axes, pl_vec_scale(n, -1));
    pl_vec lowest = pl_core_support(other->shape, down);
    return height - pl_vec_dot(lowest, down) - pl_core_radius(other->shape);
}

static double box_distance(const double half[3], pl_vec p)
{
    pl_vec q = {fabs(p.x) - half[0], fabs(p.y) - half[1], fabs(p.z) - half[2]};
    double inside = fmax(q.x, fmax(q.y, q.z));
    pl_vec outside = {fmax(q.x, 0), fmax(q.y, 0), fmax(q.z, 0)};
    return inside > 0 ? pl_vec_length(outside) : inside;
}

/* A sphere and any other bounded shape but a polyhedron. */
static double sphere_gap(const pl_placed_shape *sphere, const pl_placed_shape *other)
{
    const pl_shape *shape = other->shape;
    const pl_vec c = pl_vec_sub(pl_vec_of(sphere->position), pl_vec_of(other->position));
    const pl_axes axes = pl_axes_of(other->orientation);
    pl_vec p = shape->kind == PL_SHAPE_SPHERE ? c : pl_to_local(&axes, c);
    if (shape->kind == PL_SHAPE_CAPSULE) {
        p.z -= fmin(fmax(p.z, -shape->half_height), shape->half_height);
    }
    const double distance = shape->kind == PL_SHAPE_BOX ? box_distance(shape->half_extents, p)
                            : shape->kind == PL_SHAPE_CYLINDER ? pl_cylinder_distance(shape, p)
                                                               : pl_vec_length(p);
    return distance - sphere->shape->radius - pl_core_radius(shape);
}

static pl_segment core_segment(const pl_placed_shape *capsule, pl_vec origin)
{
    pl_axes axes = pl_axes_of(capsule->orientation);
    pl_vec centre = pl_vec_sub(pl_vec_of(capsule->position), origin);
    double h = capsule->shape->half_height;
    return (pl_segment){pl_vec_mad(centre, -h, axes.axis[2]), pl_vec_mad(centre, h, axes.axis[2])};
}

static double capsule_capsule_gap(const pl_placed_shape *a, const pl_placed_shape *b)
{
    pl_vec origin = pl_vec_of(a->position);
    pl_segment of_a = core_segment(a, origin), of_b = core_segment(b, origin);
    return pl_segment_distance(&of_a, &of_b) - a->shape->radius - b->shape->radius;
}

/* A pair of boxes, in box a's frame. */
typedef struct box_pair {
    const double *half_a, *half_b;
    pl_vec c;    /* from centre a to centre b */
    pl_vec b[3]; /* box b's axes */
} box_pair;

/* Separation along n, a unit vector in box a's frame: a lower bound of the gap for any n. */
static double separation(const box_pair *pair, pl_vec n)
{
    pl_vec in_b = {pl_vec_dot(n, pair->b[0]), pl_vec_dot(n, pair->b[1]), pl_vec_dot(n, pair->b[2])};
    return fabs(pl_vec_dot(n, pair->c)) - half_width(pair->half_a, n) -
           half_width(pair->half_b, in_b);
}

/* The largest of `best` and the separations along the cross products of a's axes with axis b of the
 * other box. In a's frame these are (0, -z, y), (z, 0, -x) and (-y, x, 0), which are orthogonal to
 * both edges without rounding, however nearly parallel the edges are. The rounding of their lengths
 * turns an axis about the edges alone, where the facet is narrow if the edges are nearly parallel.
 * So only the null vector has to be left out. */
static double edge_separation(const box_pair *pair, pl_vec b, double best)
{
    const pl_vec cross[3] = {{0, -b.z, b.y}, {b.z, 0, -b.x}, {-b.y, b.x, 0}};
    for (int i = 0; i < 3; ++i) {
        double length = pl_vec_length(cross[i]);
        if (length > 0) {
            pl_vec n = pl_vec_scale(cross[i], 1 / length);
            best = fmax(best, separation(pair, n));
        }
    }
    return best;
}

static double box_box_gap(const pl_placed_shape *a, const pl_placed_shape *b)
{
    pl_axes axes_a = pl_axes_of(a->orientation);
    pl_axes axes_b = pl_axes_of(b->orientation);
    pl_vec c = pl_vec_sub(pl_vec_of(b->position), pl_vec_of(a->position));
    box_pair pair = {.half_a = a->shape->half_extents,
                     .half_b = b->shape->half_extents,
                     .c = pl_to_local(&axes_a, c)};
    for (int i = 0; i < 3; ++i) {
        pair.b[i] = pl_to_local(&axes_a, axes_b.axis[i]);
    }
    const pl_vec unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double best = -HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
        best = fmax(best, separation(&pair, unit[i]));
        best = fmax(best, separation(&pair, pair.b[i]));
    }
    for (int i = 0; i < 3; ++i) {
        best = edge_separation(&pair, pair.b[i], best);
    }
    return best;
}

pl_status pl_gap_closed_form(const pl_placed_shape *a, const pl_placed_shape *b, double *gap)
{
    if (a->shape->kind > b->shape->kind) {
        const pl_placed_shape *swap = a;
        a = b;
        b = swap;
    }
    const pl_shape_kind first = a->shape->kind, second = b->shape->kind;
    if (first == PL_SHAPE_PLANE && second != PL_SHAPE_PLANE) {
        *gap = plane_gap(a->shape, b);
    } else if (first == PL_SHAPE_SPHERE && second != PL_SHAPE_HULL && second != PL_SHAPE_MESH) {
        *gap = sphere_gap(a, b);
    } else if (first == PL_SHAPE_BOX && second == PL_SHAPE_BOX) {
        *gap = box_box_gap(a, b);
    } else if (first == PL_SHAPE_CAPSULE && second == PL_SHAPE_CAPSULE) {
        *gap = capsule_capsule_gap(a, b);
    } else {
        return PL_UNSUPPORTED;
    }
    return PL_OK;
}

static bool has(const pl_placed_shape *a, const pl_placed_shape *b, pl_shape_kind kind)
{
    return a->shape->kind == kind || b->shape->kind == kind;
}

pl_status pl_gap(const pl_placed_shape *a, const pl_placed_shape *b, double within, double *gap)
{
    pl_status status = pl_gap_closed_form(a, b, gap);
    if (status != PL_UNSUPPORTED) {
        return status;
    }
    return has(a, b, PL_SHAPE_MESH) && !has(a, b, PL_SHAPE_PLANE)
               ? pl_gap_mesh(a, b, within, gap)
               : pl_gap_convex(a, b, within, gap);
}
