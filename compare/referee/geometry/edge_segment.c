/* With n1, n2 the normals at the ends, the tangents meet in a line along L = n1 x n2. The
 * translation that takes the stretch, along e, over that line is the distance of the two lines,
 * along e x L. */
#include "edge_segment.h"

/* Sines of angles below this are of parallel lines or planes. */
static const double PARALLEL = 1e-9;
/* The surface counts as being at the ridge if it is nearer than this part of the ridge's height. */
static const double NEAR = 1e-3;

pl_tangent pl_tangent_at(pl_vec normal, pl_vec point)
{
    return (pl_tangent){normal, pl_vec_dot(normal, point)};
}

bool pl_edge_segment_ridge(const pl_edge_segment *s, pl_vec *ridge)
{
    const pl_tangent *a = &s->at_p, *b = &s->at_q;
    pl_vec e = pl_vec_sub(s->q, s->p), along = pl_vec_cross(a->normal, b->normal);
    double square = pl_vec_dot(along, along);
    pl_vec n = pl_vec_cross(e, along);
    double across = pl_vec_dot(n, n);
    if (square < PARALLEL * PARALLEL || across <= PARALLEL * PARALLEL * square * pl_vec_dot(e, e)) {
        return false;
    }
    pl_vec sum = pl_vec_add(pl_vec_scale(pl_vec_cross(b->normal, along), a->offset),
                            pl_vec_scale(pl_vec_cross(along, a->normal), b->offset));
    pl_vec on_line = pl_vec_scale(sum, 1 / square);
    double t = pl_vec_dot(pl_vec_cross(pl_vec_sub(s->p, on_line), e), n) / -across;
    *ridge = pl_vec_mad(on_line, t, along);
    return true;
}

/* How far the stretch is below a tangent. */
static double below(const pl_tangent *tangent, const pl_edge_segment *s)
{
    double least = fmin(pl_vec_dot(tangent->normal, s->p), pl_vec_dot(tangent->normal, s->q));
    return fmax(tangent->offset - least, 0);
}

double pl_edge_segment_depth(const pl_edge_segment *s, pl_vec ridge, pl_vec on_surface)
{
    pl_vec e = pl_vec_sub(s->q, s->p);
    pl_vec n = pl_vec_cross(e, pl_vec_cross(s->at_p.normal, s->at_q.normal));
    double length = pl_vec_length(n);
    double height = fabs(pl_vec_dot(pl_vec_sub(ridge, s->p), n)) / length;
    double lift = fabs(pl_vec_dot(pl_vec_sub(on_surface, s->p), n)) / length;
    if (!(pl_vec_length(pl_vec_sub(ridge, on_surface)) <= NEAR * height)) {
        return s->middle_depth;
    }
    double least = fmin(below(&s->at_p, s), fmin(below(&s->at_q, s), below(&s->at_middle, s)));
    return fmax(s->middle_depth, fmin(lift, least));
}
