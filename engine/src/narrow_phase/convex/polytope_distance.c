/* The distance of two polytopes apart: the simplex descent of Gilbert, Johnson and Keerthi (1988)
 * in the Minkowski difference b - a, from a direction that is known to separate them. The nearest
 * point of a simplex is found by the regions of its corners, edges and faces (Ericson, Real-Time
 * Collision Detection, 2004, 5.1). Polytopes have finitely many simplices, so that it ends; it has
 * found the answer when the nearest point v is as far as the supporting plane along v. */
#include "polytope.h"

/* It takes some ten rounds; rounding may make it go round in circles. */
enum { MOST_ROUNDS = 50 };
/* The two distances agree when they differ by less than this, relatively. */
static const double AGREE = 1e-15;
/* Of coordinates, relatively. */
static const double ROUNDING = 1e-15;

typedef struct corner {
    pe_vec3 x; /* the point of b less that of a, in a's axes */
    int a, b;  /* their vertices */
} corner;

/* Its point nearest to the origin is the sum of weight[i] corner[i]. */
typedef struct simplex {
    corner corner[4];
    double weight[4];
    int count;
    pe_vec3 nearest;
} simplex;

static simplex of_corner(corner p)
{
    return (simplex){.corner = {p}, .weight = {1}, .count = 1, .nearest = p.x};
}

static simplex of_edge(corner p, corner q)
{
    pe_vec3 d = pe_sub(q.x, p.x);
    double t = -pe_dot(p.x, d), square = pe_dot(d, d);
    if (!(t > 0)) {
        return of_corner(p);
    }
    if (t >= square) {
        return of_corner(q);
    }
    t /= square;
    return (simplex){
        .corner = {p, q}, .weight = {1 - t, t}, .count = 2, .nearest = pe_madd(p.x, t, d)};
}

/* The one whose nearest point is nearer; the first if they tie. */
static simplex nearer(simplex s, simplex t)
{
    return pe_dot(t.nearest, t.nearest) < pe_dot(s.nearest, s.nearest) ? t : s;
}

static simplex of_triangle(corner p, corner q, corner r)
{
    pe_vec3 n = pe_cross(pe_sub(q.x, p.x), pe_sub(r.x, p.x));
    double square = pe_dot(n, n);
    /* Twice the areas between the origin's foot and each edge, times |n|. */
    double wp = pe_dot(n, pe_cross(q.x, r.x)), wq = pe_dot(n, pe_cross(r.x, p.x));
    double wr = pe_dot(n, pe_cross(p.x, q.x));
    if (square > 0 && wp > 0 && wq > 0 && wr > 0) {
        double sum = wp + wq + wr;
        return (simplex){
            .corner = {p, q, r},
            .weight = {wp / sum, wq / sum, wr / sum},
            .count = 3,
            .nearest = pe_scale(pe_dot(n, p.x) / square, n),
        };
    }
    return nearer(nearer(of_edge(p, q), of_edge(q, r)), of_edge(r, p));
}

/* The new corner is the last: the nearest point is on one of its three faces. Those that have the
 * origin behind them are left out; all have, by rounding, when it lies in a flat simplex. */
static simplex of_tetrahedron(const corner c[4])
{
    static const int faces[3][4] = {{0, 1, 3, 2}, {1, 2, 3, 0}, {2, 0, 3, 1}};
    simplex best = {.count = 0};
    for (int every = 0; every < 2 && best.count == 0; ++every) {
        for (int f = 0; f < 3; ++f) {
            corner p = c[faces[f][0]], q = c[faces[f][1]], r = c[faces[f][2]];
            pe_vec3 n = pe_cross(pe_sub(q.x, p.x), pe_sub(r.x, p.x));
            double inside = pe_dot(n, pe_sub(c[faces[f][3]].x, p.x)), origin = -pe_dot(n, p.x);
            if (every || !(inside * origin > 0)) {
                simplex s = of_triangle(p, q, r);
                best = best.count == 0 ? s : nearer(best, s);
            }
        }
    }
    return best;
}

static simplex reduce(const simplex *s)
{
    const corner *c = s->corner;
    return s->count == 1   ? of_corner(c[0])
           : s->count == 2 ? of_edge(c[0], c[1])
           : s->count == 3 ? of_triangle(c[0], c[1], c[2])
                           : of_tetrahedron(c);
}

/* The corner of the difference that is first along n. */
static corner first_along(const pe_polytope_pair *pair, pe_vec3 n, const corner *from)
{
    pe_vec3 back = pe_scale(-1, pe_unrotate(&pair->b_from_a.turn, n));
    int a = pe_polytope_support(&pair->a, n, from != NULL ? from->a : -1);
    int b = pe_polytope_support(&pair->b, back, from != NULL ? from->b : -1);
    pe_vec3 x = pe_add(pe_rotate(&pair->b_from_a.turn, pair->b.vertices[b]), pair->b_from_a.offset);
    return (corner){pe_sub(x, pair->a.vertices[a]), a, b};
}

static bool has_corner(const simplex *s, const corner *p)
{
    bool found = false;
    for (int i = 0; i < s->count; ++i) {
        found = found || (s->corner[i].a == p->a && s->corner[i].b == p->b);
    }
    return found;
}

/* The direction of the nearest point. Where that is near, the direction has few digits; square to
 * an edge it must be to all of them, or an end of the edge would be nearer along it. */
static pe_vec3 normal_of(const simplex *s)
{
    pe_vec3 n = pe_scale(1 / pe_length(s->nearest), s->nearest);
    if (s->count == 2) {
        pe_vec3 d = pe_sub(s->corner[1].x, s->corner[0].x);
        n = pe_madd(n, -pe_dot(n, d) / pe_dot(d, d), d);
        n = pe_scale(1 / pe_length(n), n);
    }
    return n;
}

/* Goes down to the simplex with the nearest point. The one along which the cores are separated most
 * may be another: by rounding, a turn of v changes its length too little to be seen. */
static simplex descend(const pe_polytope_pair *pair, pe_vec3 n, simplex *most_separated)
{
    simplex s = of_corner(first_along(pair, n, NULL)), best = s;
    double most = -HUGE_VAL;
    *most_separated = s;
    for (int round = 0; round < MOST_ROUNDS && pe_dot(s.nearest, s.nearest) > 0; ++round) {
        pe_vec3 v = normal_of(&s);
        double length = pe_length(s.nearest);
        corner next = first_along(pair, v, &s.corner[0]);
        double along = pe_dot(v, next.x);
        if (along > most) {
            most = along;
            *most_separated = s;
        }
        if (length - along <= AGREE * length || has_corner(&s, &next)) {
            break;
        }
        s.corner[s.count++] = next;
        s = reduce(&s);
        best = nearer(best, s);
        if (pe_length(s.nearest) > length * (1 + AGREE)) {
            break; /* rounding: it cannot come nearer */
        }
    }
    return best;
}

static void widen(int ends[2], int vertex)
{
    ends[0] = vertex < ends[0] ? vertex : ends[0];
    ends[1] = vertex > ends[1] ? vertex : ends[1];
}

pe_separation pe_polytope_distance(const pe_polytope_pair *pair, const pe_separation *start)
{
    simplex directed, s = descend(pair, start->normal, &directed);
    double rounding = ROUNDING * pe_length(pair->b_from_a.offset);
    if (pe_length(directed.nearest) <= pe_length(s.nearest) + rounding) {
        s = directed; /* equally near, and its points lie along the normal */
    }
    const corner *c = s.corner;
    pe_vec3 on_a = pe_v3(0, 0, 0);
    pe_separation found = *start;
    /* So near to each other the direction may be rounding. */
    if (pe_dot(directed.nearest, directed.nearest) > 0) {
        pe_vec3 normal = normal_of(&directed);
        double distance = pe_polytope_separation_along(pair, normal);
        if (distance >= start->distance - rounding) {
            found.normal = normal;
            found.distance = distance;
        }
    }
    found.kind = PE_OF_POINTS;
    found.ends_a[0] = found.ends_a[1] = c[0].a;
    found.ends_b[0] = found.ends_b[1] = c[0].b;
    for (int i = 0; i < s.count; ++i) {
        on_a = pe_madd(on_a, s.weight[i], pair->a.vertices[c[i].a]);
        widen(found.ends_a, c[i].a);
        widen(found.ends_b, c[i].b);
    }
    found.on_a = on_a;
    found.on_b = pe_add(on_a, s.nearest);
    return found;
}
