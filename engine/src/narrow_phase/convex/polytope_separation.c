/* The separation of two polytopes: of overlapping cores by separating axes, of others their
 * distance.
 *
 * Separating axes are the normals of the Minkowski difference: faces of either core, and cross
 * products of edges whose arcs on the Gauss sphere meet (Gregorius, The Separating Axis Test
 * between Convex Polyhedra, GDC 2013). An edge's arc joins the normals of its faces. That of a
 * segment is the whole circle. Most axes are dropped without a look at the other core: it holds a
 * ball about its origin, so that no direction separates the core by more than the ball.
 *
 * The distance is found by the simplex descent of Gilbert, Johnson and Keerthi (1988) in the
 * Minkowski difference b - a, from a direction that separates the cores. The nearest point of a
 * simplex is found by the regions of its corners, edges and faces (Ericson, Real-Time Collision
 * Detection, 2004, 5.1). Polytopes have finitely many simplices, so that the descent ends. It has
 * found the answer when the nearest point v is as far away as the support plane along v. */
#include "polytope.h"

#include "narrow_phase/tolerances.h"

/* ---- Separating axes ---- */

/* The best face of p against q, placed in p's axes. */
typedef struct face_choice {
    double separation;
    int face, vertex; /* of p; of q, the lowest over it */
} face_choice;

/* Replaces *best by a face of p that separates more. False: one separates by more than `limit`. */
static bool best_face_of(const pe_polytope *p, const pe_polytope *q, const pe_transform *placed,
                         double limit, double tie, face_choice *best)
{
    /* The face over which q's origin is highest gives a bound for the others. */
    double farthest = -HUGE_VAL;
    int first = 0;
    for (int i = 0; i < p->face_count; ++i) {
        double out = pe_dot(p->faces[i].normal, placed->offset) - p->faces[i].offset;
        if (out > farthest + tie) {
            farthest = out;
            first = i;
        }
    }
    int vertex = -1;
    for (int k = p->face_count > 0 ? -1 : 0; k < p->face_count; ++k) {
        int i = k < 0 ? first : k;
        const pe_face *face = &p->faces[i];
        double out = pe_dot(face->normal, placed->offset) - face->offset;
        if (k == first || out - q->inner <= best->separation + tie) {
            continue;
        }
        pe_vec3 back = pe_scale(-1, pe_unrotate(&placed->turn, face->normal));
        vertex = pe_polytope_support(q, back, vertex);
        double separation = out - pe_dot(back, q->vertices[vertex]);
        if (separation > limit) {
            return false;
        }
        if (separation > best->separation + tie) {
            *best = (face_choice){separation, i, vertex};
        }
    }
    return true;
}

bool pe_polytope_best_face(const pe_polytope_pair *pair, double limit, pe_separation *best)
{
    double tie = PE_AXIS_TIE * pair->size;
    face_choice of_a = {-HUGE_VAL, 0, 0};
    if (!best_face_of(&pair->a, &pair->b, &pair->b_in_a, limit, tie, &of_a)) {
        return false;
    }
    face_choice of_b = of_a;
    if (!best_face_of(&pair->b, &pair->a, &pair->a_in_b, limit, tie, &of_b)) {
        return false;
    }
    bool flipped = of_b.separation > of_a.separation;
    face_choice choice = flipped ? of_b : of_a;
    *best = (pe_separation){.distance = choice.separation};
    if (flipped) {
        pe_vec3 n = pe_rotate(&pair->b_in_a.turn, pair->b.faces[choice.face].normal);
        best->kind = PE_OF_FACE_B;
        best->b = choice.face;
        best->normal = pe_scale(-1, n);
        best->on_a = pair->a.vertices[choice.vertex];
        best->on_b = pe_madd(best->on_a, best->distance, best->normal);
    } else {
        best->kind = PE_OF_FACE_A;
        best->a = choice.face;
        best->normal = pair->a.faces[choice.face].normal;
        best->on_b = pe_transform_point(&pair->b_in_a, pair->b.vertices[choice.vertex]);
        best->on_a = pe_madd(best->on_b, -best->distance, best->normal);
    }
    best->ends_a[0] = best->ends_a[1] = flipped ? choice.vertex : 0;
    best->ends_b[0] = best->ends_b[1] = flipped ? 0 : choice.vertex;
    return true;
}

/* An edge of b in a's axes. */
typedef struct placed_edge {
    pe_vec3 start, along, normal[2];
    double along2; /* squared length */
    int index;
    bool has_faces;
} placed_edge;

/* The largest distance of a point from the core along the directions of an edge's arc. With x and y
 * its distances from the planes of the two faces, the distance along the arc is a sinusoid. It is
 * largest at an end or at its crest between them. */
static double most_over_arc(const pe_face *f, const pe_face *g, pe_vec3 point)
{
    double x = pe_dot(f->normal, point) - f->offset, y = pe_dot(g->normal, point) - g->offset;
    double c = pe_dot(f->normal, g->normal), sine2 = 1 - c * c;
    return y - c * x > 0 && x - c * y > 0
               ? (sine2 > 0 ? sqrt((x * x + y * y - 2 * c * x * y) / sine2) : HUGE_VAL)
               : pe_max(x, y);
}

/* Points inside one core, in the other's axes: a ball about its origin, and its nearest point by
 * the best face. */
typedef struct core_points {
    pe_vec3 centre, nearest;
    double radius;
} core_points;

/* `nearest` is in the core's own axes. If it lies outside the core by more than the slack, the
 * origin replaces it. */
static core_points points_of(const pe_polytope *p, const pe_transform *placed, pe_vec3 nearest,
                             double slack)
{
    bool in = true;
    for (int i = 0; i < p->face_count && in; ++i) {
        in = pe_dot(p->faces[i].normal, nearest) <= p->faces[i].offset + slack;
    }
    return (core_points){.centre = placed->offset,
                         .nearest = in ? pe_transform_point(placed, nearest) : placed->offset,
                         .radius = p->inner};
}

/* Whether an edge of the core may separate those points by more than `least`. */
static bool may_separate(const pe_polytope *p, const pe_edge *edge, const core_points *other,
                         double least)
{
    if (edge->face[0] < 0) {
        return true;
    }
    const pe_face *f = &p->faces[edge->face[0]], *g = &p->faces[edge->face[1]];
    return most_over_arc(f, g, other->nearest) > least &&
           most_over_arc(f, g, other->centre) - other->radius > least;
}

/* Edges of b are placed in chunks, so that the list needs no memory. */
enum { CHUNK = 64 };

typedef struct edge_chunk {
    int count;
    placed_edge edge[CHUNK];
} edge_chunk;

/* Fills the chunk with the next edges of b whose separation may exceed `least`. */
static void gather(const pe_polytope_pair *pair, const core_points *a, double least, int *next,
                   edge_chunk *chunk)
{
    const pe_polytope *b = &pair->b;
    const pe_transform *placed = &pair->b_in_a;
    chunk->count = 0;
    for (; *next < b->edge_count && chunk->count < CHUNK; ++*next) {
        const pe_edge *edge = &b->edges[*next];
        if (!may_separate(b, edge, a, least)) {
            continue;
        }
        pe_vec3 p = b->vertices[edge->vertex[0]], q = b->vertices[edge->vertex[1]];
        pe_vec3 along = pe_rotate(&placed->turn, pe_sub(q, p));
        placed_edge *other = &chunk->edge[chunk->count++];
        *other = (placed_edge){
            .start = pe_transform_point(placed, p),
            .along = along,
            .along2 = pe_dot(along, along),
            .index = *next,
            .has_faces = edge->face[0] >= 0,
        };
        for (int k = 0; k < 2 && other->has_faces; ++k) {
            other->normal[k] = pe_rotate(&placed->turn, b->faces[edge->face[k]].normal);
        }
    }
}

/* Tests edge i of a, whose arc runs from normal m to n, against the chunk. False: a pair separates
 * by more than `limit`. */
static bool try_edge(const pe_polytope_pair *pair, int i, const edge_chunk *chunk, double limit,
                     pe_separation *best)
{
    const pe_edge *edge = &pair->a.edges[i];
    pe_vec3 start = pair->a.vertices[edge->vertex[0]];
    pe_vec3 along = pe_sub(pair->a.vertices[edge->vertex[1]], start);
    bool has_faces = edge->face[0] >= 0;
    pe_vec3 m = has_faces ? pair->a.faces[edge->face[0]].normal : pe_v3(0, 0, 0);
    pe_vec3 n = has_faces ? pair->a.faces[edge->face[1]].normal : m;
    double along2 = pe_dot(along, along), tie = PE_AXIS_TIE * pair->size;
    for (int k = 0; k < chunk->count; ++k) {
        const placed_edge *other = &chunk->edge[k];
        /* The arcs meet if the ends of each lie on both sides of the other's plane, and on the same
         * half of the sphere. */
        double mb = pe_dot(m, other->along), nb = pe_dot(n, other->along);
        double ma = pe_dot(other->normal[0], along), na = pe_dot(other->normal[1], along);
        if ((has_faces && mb * nb >= 0) || (other->has_faces && ma * na >= 0) ||
            (has_faces && other->has_faces && ma * nb >= 0)) {
            continue;
        }
        bool positive = has_faces ? mb > 0 : ma > 0;
        pe_vec3 cross = pe_scale(positive ? 1 : -1, pe_cross(along, other->along));
        double square = pe_dot(cross, cross), whole = along2 * other->along2;
        double s = pe_dot(cross, pe_sub(other->start, start));
        bool nearly_parallel = square < PE_EDGES_NEAR_PARALLEL * PE_EDGES_NEAR_PARALLEL * whole;
        if (square <= PE_EDGES_PARALLEL * PE_EDGES_PARALLEL * whole ||
            (!nearly_parallel && !pe_quotient_exceeds(s, square, best->distance + tie))) {
            continue;
        }
        pe_vec3 normal = pe_scale(1 / sqrt(square), cross);
        double distance =
            nearly_parallel ? pe_polytope_separation_along(pair, normal) : s / sqrt(square);
        if (distance > limit) {
            return false;
        }
        if (distance > best->distance + tie) {
            *best = (pe_separation){distance, normal, PE_OF_EDGES, .a = i, .b = other->index};
        }
    }
    return true;
}

bool pe_polytope_best_edges(const pe_polytope_pair *pair, double limit, pe_separation *best)
{
    const pe_polytope *a = &pair->a;
    double tie = PE_AXIS_TIE * pair->size;
    pe_vec3 on_b = pe_transform_point(&pair->a_in_b, best->on_b);
    const core_points of_a = points_of(a, &pair->a_in_b, best->on_a, 0.01 * tie);
    const core_points of_b = points_of(&pair->b, &pair->b_in_a, on_b, 0.01 * tie);
    for (int next = 0; next < pair->b.edge_count && a->edge_count > 0;) {
        edge_chunk chunk;
        gather(pair, &of_a, best->distance + tie, &next, &chunk);
        for (int i = 0; i < a->edge_count && chunk.count > 0; ++i) {
            if (may_separate(a, &a->edges[i], &of_b, best->distance + tie) &&
                !try_edge(pair, i, &chunk, limit, best)) {
                return false;
            }
        }
    }
    return true;
}

/* ---- Distance ---- */

/* About ten rounds are needed. Rounding may make the descent cycle. */
enum { MOST_ROUNDS = 50 };

typedef struct corner {
    pe_vec3 x; /* the point of b less that of a, in a's axes */
    int a, b;  /* their vertices */
} corner;

/* Its point nearest to the origin, which is the sum of weight[i] corner[i]. */
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

/* The simplex whose nearest point is nearer; the first if they tie. */
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

/* The newest corner is the last: the nearest point lies on one of its three faces. Faces that have
 * the origin behind them are left out. If the origin lies in a flat simplex, rounding can leave
 * out all of them; then all are tried. */
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

/* The corner of the Minkowski difference b - a that is first along n. */
static corner first_along(const pe_polytope_pair *pair, pe_vec3 n, const corner *from)
{
    pe_vec3 back = pe_scale(-1, pe_unrotate(&pair->b_in_a.turn, n));
    int a = pe_polytope_support(&pair->a, n, from != NULL ? from->a : -1);
    int b = pe_polytope_support(&pair->b, back, from != NULL ? from->b : -1);
    pe_vec3 x = pe_transform_point(&pair->b_in_a, pair->b.vertices[b]);
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

/* The direction of the nearest point. If that is near, the direction has few correct digits. But it
 * must be perpendicular to an edge to the last digit, or an end of the edge would be nearer. */
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

/* Descends to the simplex with the nearest point. *most_separated is the one along whose direction
 * the cores are separated most. It may differ: a small turn of v changes its length by less than
 * rounding. */
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
        if (length - along <= PE_GJK_AGREE * length || has_corner(&s, &next)) {
            break;
        }
        s.corner[s.count++] = next;
        s = reduce(&s);
        best = nearer(best, s);
        if (pe_length(s.nearest) > length * (1 + PE_GJK_AGREE)) {
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
    double rounding = PE_COORDINATE_ROUNDING * pe_length(pair->b_in_a.offset);
    if (pe_length(directed.nearest) <= pe_length(s.nearest) + rounding) {
        s = directed; /* equally near, and its points lie along the normal */
    }
    const corner *c = s.corner;
    pe_vec3 on_a = pe_v3(0, 0, 0);
    pe_separation found = *start;
    /* Of points this near to each other the direction may be rounding. */
    if (pe_dot(directed.nearest, directed.nearest) > 0) {
        pe_vec3 normal = normal_of(&directed);
        double distance = pe_polytope_separation_along(pair, normal);
        if (distance >= start->distance - rounding) {
            found.normal = normal;
            found.distance = distance;
        }
    }
    /* Where edges nearly touch, directions that differ by rounding are equally near, and the
     * descent ends at one along which other corners are nearer. */
    if (found.distance < pe_length(s.nearest) - PE_AXIS_TIE * pair->size) {
        pe_polytope_best_edges(pair, HUGE_VAL, &found);
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
