/* A capsule against a sphere and a capsule: a segment and a point or segment, swept by balls. */
#include "polytope.h"

/* Squared sine of the angle between two segments whose cross product is rounding alone. */
static const double PARALLEL = 1e-24;

/* A direction across both cores, towards b: the one to part them along when they meet. */
static pe_vec3 across(const pe_polytope_pair *pair)
{
    pe_vec3 u = pe_v3(0, 0, 1), v = u, d = pair->b_from_a.offset; /* a capsule's axis is z */
    if (pair->a.edge_count > 0 && pair->b.edge_count > 0) {
        v = pe_axis(&pair->b_from_a.turn, 2);
    } else if (pair->b.edge_count > 0) {
        u = v = pe_axis(&pair->b_from_a.turn, 2);
    }
    pe_vec3 n = pe_cross(u, v), other;
    if (pe_dot(n, n) <= PARALLEL) {
        n = pe_madd(d, -pe_dot(u, d), u);
    }
    double length = pe_length(n);
    if (!(length > 0)) {
        pe_tangents(u, &n, &other);
        length = 1;
    }
    return pe_scale((pe_dot(n, d) < 0 ? -1 : 1) / length, n);
}

void pe_collide_capsule_or_sphere(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits)
{
    pe_polytope_pair pair;
    pe_polytope_pair_make(a, b, &pair);
    pe_separation start = {.normal = across(&pair)};
    start.distance = pe_polytope_separation_along(&pair, start.normal);
    pe_collide_polytopes_apart(&pair, &start, margin, hits);
}
