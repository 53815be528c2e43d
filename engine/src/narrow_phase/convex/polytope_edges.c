/* Polytopes that touch at edges or corners: nearest points, and edges that lie along each other.
 *
 * Parallel edges that meet touch along a line, and each has a range of normals, between those of
 * its faces. Every direction in both ranges separates the edges by nothing, so that the separation
 * leaves the normal to rounding, and an overlap of rounding to one of the faces. Here the middle of
 * the common range is the normal, as if both edges were rounded off a little. That is far from all
 * faces, so that friction holds the most to either side, and it is the one that symmetry asks of
 * two cards that lean on each other.
 *
 * A rounding by r moves the edges apart by 2 r along the middle m. With the gap d between the sharp
 * ones, the line of least distance is along 2 r m + d: m where the edges meet, the direction of the
 * gap where it is wide, and out of the range, which leaves the normal to a face, where one edge has
 * gone past the other. r falls to 0 as |d| grows, so that only edges that nearly touch differ from
 * sharp ones, and no motion makes the normal jump. */
#include "polytope_edges.h"

#include "narrow_phase/feature_id.h"
#include "narrow_phase/tolerances.h"

/* ---- Nearest points ---- */

/* Points in a's axes and the features that they lie on: vertices, or edges by theirs. */
typedef struct witness {
    pe_vec3 on_a, on_b;
    int ends_a[2], ends_b[2];
} witness;

enum { NEAREST = 1, END_OF_A, END_OF_B }; /* corners of faces have 0 there */

/* Whether one of the cores is a point: its ball touches at one point. */
static bool has_ball(const pe_polytope_pair *pair)
{
    return pair->a.vertex_count == 1 || pair->b.vertex_count == 1;
}

static uint64_t witness_feature(const pe_polytope_pair *pair, uint64_t kind, const int a[2],
                                const int b[2])
{
    if (has_ball(pair)) {
        return 0;
    }
    static const int whole[2] = {0, 1}; /* the end of a capsule's segment makes no difference */
    a = pair->a.face_count == 0 && kind == NEAREST ? whole : a;
    b = pair->b.face_count == 0 && kind == NEAREST ? whole : b;
    return kind << 60 | pe_vertex_pair_feature(a[0], a[1]) << 30 |
           pe_vertex_pair_feature(b[0], b[1]);
}

static pe_vec3 vertex_of_b(const pe_polytope_pair *pair, int vertex)
{
    return pe_transform_point(&pair->b_in_a, pair->b.vertices[vertex]);
}

/* The points where two edges cross, seen along their common normal. They are clamped to the part
 * where the edges lie next to each other, because the crossing of nearly parallel lines is
 * uncertain. */
static witness crossing_of_edges(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b)
{
    pe_vec3 p = pair->a.vertices[a->vertex[0]], q = vertex_of_b(pair, b->vertex[0]);
    pe_vec3 u = pe_sub(pair->a.vertices[a->vertex[1]], p);
    pe_vec3 v = pe_sub(vertex_of_b(pair, b->vertex[1]), q), d = pe_sub(q, p), w = pe_cross(u, v);
    double square = pe_dot(w, w), whole = pe_dot(u, u);
    double from = pe_dot(d, u) / whole, to = from + pe_dot(v, u) / whole;
    double low = pe_max(0, pe_min(from, to)), high = pe_min(1, pe_max(from, to));
    double s = square > 0 ? pe_dot(pe_cross(d, v), w) / square : low;
    s = pe_max(low, pe_min(high, s));
    pe_vec3 x = pe_madd(p, s, u);
    double t = pe_dot(pe_sub(x, q), v) / pe_dot(v, v);
    return (witness){.on_a = x,
                     .on_b = pe_madd(q, pe_max(0, pe_min(1, t)), v),
                     .ends_a = {a->vertex[0], a->vertex[1]},
                     .ends_b = {b->vertex[0], b->vertex[1]}};
}

/* The nearest points along the direction. */
static witness witness_of(const pe_polytope_pair *pair, const pe_separation *s)
{
    return s->kind == PE_OF_EDGES || s->kind == PE_OF_LINE
               ? crossing_of_edges(pair, &pair->a.edges[s->a], &pair->b.edges[s->b])
               : (witness){
                     s->on_a, s->on_b, {s->ends_a[0], s->ends_a[1]}, {s->ends_b[0], s->ends_b[1]}};
}

static void add_witness(const pe_polytope_pair *pair, const pe_separation *s, const witness *w,
                        pe_candidates *found)
{
    pe_vec3 on_a = pe_madd(w->on_a, pair->a.radius, s->normal);
    pe_vec3 on_b = pe_madd(w->on_b, -pair->b.radius, s->normal);
    const double separation = pe_dot(s->normal, pe_sub(on_b, on_a));
    /* Rounding moves the nearest points sideways, by more the farther apart the cores are. The point
     * on the sharper shape is used. */
    const pe_vec3 middle =
        pair->a.radius < pair->b.radius   ? pe_madd(on_a, 0.5 * separation, s->normal)
        : pair->b.radius < pair->a.radius ? pe_madd(on_b, -0.5 * separation, s->normal)
                                          : pe_scale(0.5, pe_add(on_a, on_b));
    pe_candidates_add(found, pair->pose_a, middle, separation,
                      witness_feature(pair, NEAREST, w->ends_a, w->ends_b));
}

/* ---- Lines ---- */

/* Two nearly parallel edges, with coordinates along the first one. */
typedef struct line {
    pe_vec3 along;           /* unit */
    pe_vec3 a[2], b[2];      /* ends */
    double at_a[2], at_b[2]; /* m */
    int first_b;             /* the end of b where the line begins */
} line;

/* The point of an edge with the coordinate t. */
static pe_vec3 at(const pe_vec3 x[2], const double place[2], double t)
{
    return pe_madd(x[0], (t - place[0]) / (place[1] - place[0]), pe_sub(x[1], x[0]));
}

/* Adds the point with the coordinate t. If the edges are rounded and offset by y sideways, each
 * surface meets the normal at its share of y, below its top. */
static void add_line_point(const pe_polytope_pair *pair, const line *l, pe_vec3 n, double t,
                           double aside, uint64_t feature, pe_candidates *found)
{
    double ra = pair->a.radius, rb = pair->b.radius, sum = ra + rb;
    pe_vec3 xa = at(l->a, l->at_a, t), xb = at(l->b, l->at_b, t), across = pe_cross(n, l->along);
    double y = pe_dot(across, pe_sub(xb, xa)), share = sum > 0 ? ra / sum : 0.5;
    if (fabs(y) > pe_max(0.5 * sum, aside)) {
        return;
    }
    double ya = share * y, yb = y - ya;
    xa = pe_madd(pe_madd(xa, ya, across), sqrt(pe_max(0, ra * ra - ya * ya)), n);
    xb = pe_madd(pe_madd(xb, -yb, across), -sqrt(pe_max(0, rb * rb - yb * yb)), n);
    /* The two points differ a little along the line. That on the sharper shape is used. */
    double separation = pe_dot(n, pe_sub(xb, xa));
    pe_vec3 middle = ra < rb ? pe_madd(xa, 0.5 * separation, n) : pe_madd(xb, -0.5 * separation, n);
    pe_candidates_add(found, pair->pose_a, middle, separation, feature);
}

/* The edges as a line, and where the part begins and ends in which they lie next to each other. */
static line line_of(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b,
                    double part[2])
{
    line l;
    for (int k = 0; k < 2; ++k) {
        l.a[k] = pair->a.vertices[a->vertex[k]];
        l.b[k] = vertex_of_b(pair, b->vertex[k]);
    }
    l.along = pe_sub(l.a[1], l.a[0]);
    l.along = pe_scale(1 / pe_length(l.along), l.along);
    for (int k = 0; k < 2; ++k) {
        l.at_a[k] = pe_dot(l.along, l.a[k]);
        l.at_b[k] = pe_dot(l.along, l.b[k]);
    }
    l.first_b = l.at_b[0] < l.at_b[1] ? 0 : 1;
    part[0] = pe_max(l.at_a[0], l.at_b[l.first_b]);
    part[1] = pe_min(l.at_a[1], l.at_b[1 - l.first_b]);
    return l;
}

/* Adds both ends of that part, unless the edges are farther apart across the normal than `aside`. */
static void line_contact(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b,
                         pe_vec3 n, double aside, pe_candidates *found)
{
    double part[2], slack = PE_CLIP_SLACK * pair->size;
    const line l = line_of(pair, a, b, part);
    for (int end = 0; end < 2 && part[1] - part[0] > slack; ++end) {
        int at_b = end == 0 ? l.first_b : 1 - l.first_b;
        bool of_a = fabs(part[end] - l.at_a[end]) <= slack;
        const int end_a[2] = {a->vertex[end], a->vertex[end]};
        const int end_b[2] = {b->vertex[at_b], b->vertex[at_b]};
        add_line_point(pair, &l, n, part[end], aside,
                       of_a ? witness_feature(pair, END_OF_A, end_a, b->vertex)
                            : witness_feature(pair, END_OF_B, a->vertex, end_b),
                       found);
    }
}

/* The sine of the angle of two edges that both lie across the normal; 2: they do not. */
static double sine_of_edges(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b,
                            const pe_separation *s)
{
    pe_vec3 u = pe_sub(pair->a.vertices[a->vertex[1]], pair->a.vertices[a->vertex[0]]);
    pe_vec3 v = pe_rotate(&pair->b_in_a.turn,
                          pe_sub(pair->b.vertices[b->vertex[1]], pair->b.vertices[b->vertex[0]]));
    double lu = pe_length(u), lv = pe_length(v);
    /* Over a wide gap, points opposite each other along the normal would be far apart sideways. */
    double most = PE_EDGE_ACROSS * pe_min(1, pair->size / fabs(s->distance));
    bool across = fabs(pe_dot(u, s->normal)) < most * lu && fabs(pe_dot(v, s->normal)) < most * lv;
    return across ? pe_length(pe_cross(u, v)) / (lu * lv) : 2;
}

/* Adds the line contact of the most parallel edges at the witness that lie across the normal. */
static void touching_line(const pe_polytope_pair *pair, const pe_separation *s, const witness *w,
                          pe_candidates *found)
{
    const pe_polytope *a = &pair->a, *b = &pair->b;
    if (a->edge_count == 0 || b->edge_count == 0) {
        return;
    }
    double least = PE_LINE_CONTACT;
    const pe_edge *edge_a = NULL, *edge_b = NULL;
    for (int i = a->vertex_first[w->ends_a[0]]; i < a->vertex_first[w->ends_a[0] + 1]; ++i) {
        for (int j = b->vertex_first[w->ends_b[0]]; j < b->vertex_first[w->ends_b[0] + 1]; ++j) {
            const pe_edge *p = &a->edges[a->vertex_edges[i]], *q = &b->edges[b->vertex_edges[j]];
            double sine = sine_of_edges(pair, p, q, s);
            if (sine < least) {
                least = sine;
                edge_a = p;
                edge_b = q;
            }
        }
    }
    if (edge_a != NULL) {
        line_contact(pair, edge_a, edge_b, s->normal, PE_CLIP_SLACK * pair->size, found);
    }
}

void pe_polytope_add_nearest(const pe_polytope_pair *pair, const pe_separation *s,
                             const pe_separation *nearest, double least, pe_candidates *found)
{
    const witness w = witness_of(pair, nearest);
    if (s->kind == PE_OF_LINE) {
        line_contact(pair, &pair->a.edges[s->a], &pair->b.edges[s->b], s->normal,
                     PE_EDGES_MEET * pair->size, found);
    } else if (found->count == 0) {
        touching_line(pair, s, &w, found);
    }
    if (found->least > least) {
        if (has_ball(pair)) {
            pe_candidates_clear(found);
        }
        add_witness(pair, s, &w, found);
    }
}

/* ---- Parallel edges that meet ---- */

/* Directions across an axis, from the first counter-clockwise to the last: less than half a turn. */
typedef struct range {
    pe_vec3 first, last;
} range;

static range range_of(pe_vec3 axis, pe_vec3 n, pe_vec3 m)
{
    return pe_dot(axis, pe_cross(n, m)) > 0 ? (range){n, m} : (range){m, n};
}

/* Whether the direction lies within the range, by an angle of this sine at least. */
static bool is_within(const range *r, pe_vec3 axis, pe_vec3 n, double sine)
{
    return pe_dot(axis, pe_cross(r->first, n)) >= sine &&
           pe_dot(axis, pe_cross(n, r->last)) >= sine;
}

/* The directions in both ranges. False: there are none. */
static bool common_range(const range *a, const range *b, pe_vec3 axis, range *both)
{
    const double least = -PE_MEETING_ROUNDING;
    bool first_a = is_within(b, axis, a->first, least), last_a = is_within(b, axis, a->last, least);
    *both = (range){first_a ? a->first : b->first, last_a ? a->last : b->last};
    return (first_a || is_within(a, axis, b->first, least)) &&
           (last_a || is_within(a, axis, b->last, least));
}

/* The directions that both edges face, towards b. */
static bool range_of_edges(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b,
                           pe_vec3 axis, range *both)
{
    pe_vec3 n[2], m[2];
    for (int k = 0; k < 2; ++k) {
        n[k] = pair->a.faces[a->face[k]].normal;
        m[k] = pe_scale(-1, pe_rotate(&pair->b_in_a.turn, pair->b.faces[b->face[k]].normal));
    }
    const range of_a = range_of(axis, n[0], n[1]), of_b = range_of(axis, m[0], m[1]);
    return common_range(&of_a, &of_b, axis, both);
}

/* The t, from 0 to 1, at which begin + t (end - begin) is least. */
static double place_of_least(pe_vec3 begin, pe_vec3 end)
{
    pe_vec3 d = pe_sub(end, begin);
    double t = -pe_dot(begin, d), square = pe_dot(d, d);
    return t <= 0 ? 0 : t >= square ? 1 : t / square;
}

/* The normal where edges meet: the middle of the range, or nearly that of the face if faces nearly
 * lie on each other, which then keep it. `sine`: of the range's angle. */
static pe_vec3 middle_of(const range *both, pe_vec3 face, double sine)
{
    double share = pe_min(1, sine / PE_MEETING_FLAT - 1);
    pe_vec3 middle = pe_add(both->first, both->last);
    middle = pe_scale(1 / pe_length(middle), middle);
    middle = pe_madd(face, share, pe_sub(middle, face));
    return pe_scale(1 / pe_length(middle), middle);
}

/* Whether the edges meet, and along which normal. `face` is that of the face that separates most. */
static bool meet(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b, pe_vec3 face,
                 pe_vec3 *normal)
{
    const double reach = PE_EDGES_MEET * pair->size;
    double part[2];
    const line l = line_of(pair, a, b, part);
    range both;
    if (!(part[1] - part[0] > PE_CLIP_SLACK * pair->size) ||
        !range_of_edges(pair, a, b, l.along, &both)) {
        return false;
    }
    const double sine = pe_dot(l.along, pe_cross(both.first, both.last));
    if (!(sine > PE_MEETING_FLAT)) {
        return false;
    }
    const pe_vec3 middle = middle_of(&both, face, sine);
    pe_vec3 gap[2];
    for (int k = 0; k < 2; ++k) {
        gap[k] = pe_sub(at(l.b, l.at_b, part[k]), at(l.a, l.at_a, part[k]));
    }
    const pe_vec3 change = pe_sub(gap[1], gap[0]);
    const pe_vec3 nearest = pe_madd(gap[0], place_of_least(gap[0], gap[1]), change);
    const double left = 1 - pe_length(nearest) / reach;
    if (!(left > 0)) {
        return false;
    }
    const pe_vec3 apart = pe_scale(0.5 * reach * left, middle);
    const double t = place_of_least(pe_add(apart, gap[0]), pe_add(apart, gap[1]));
    /* Across the edge that goes on there: else its end would be nearer. */
    const bool ends_a = (t == 0 && part[0] == l.at_a[0]) || (t == 1 && part[1] == l.at_a[1]);
    const pe_vec3 on = ends_a ? pe_sub(l.b[1], l.b[0]) : l.along;
    pe_vec3 d = pe_add(apart, pe_madd(gap[0], t, change));
    d = pe_madd(d, -pe_dot(d, on) / pe_dot(on, on), on);
    if (!(pe_dot(d, middle) > 0)) {
        return false;
    }
    *normal = pe_scale(1 / pe_length(d), d);
    return is_within(&both, l.along, *normal, PE_MEETING_FACE);
}

/* Whether both ends of the edge lie within `reach` of the face that looks along `out`, at the height
 * `top` over the origin. */
static bool is_level(const pe_polytope *p, const pe_edge *edge, pe_vec3 out, double top,
                     double reach)
{
    return pe_dot(out, p->vertices[edge->vertex[0]]) >= top - reach &&
           pe_dot(out, p->vertices[edge->vertex[1]]) >= top - reach;
}

/* Whether the point, in p's axes, lies over the face. */
static bool lies_over(const pe_polytope *p, const pe_face *face, pe_vec3 x)
{
    const int count = pe_face_corners(face);
    bool over = true;
    for (int k = 0; k < count && over; ++k) {
        pe_vec3 from = p->vertices[pe_face_corner(p, face, k)];
        pe_vec3 to = p->vertices[pe_face_corner(p, face, k + 1 < count ? k + 1 : 0)];
        over = pe_dot(pe_cross(face->normal, pe_sub(to, from)), pe_sub(x, from)) > 0;
    }
    return over;
}

/* Whether the edges' directions differ by less than this (rad). */
static bool are_parallel(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b)
{
    pe_vec3 u = pe_sub(pair->a.vertices[a->vertex[1]], pair->a.vertices[a->vertex[0]]);
    pe_vec3 v = pe_rotate(&pair->b_in_a.turn,
                          pe_sub(pair->b.vertices[b->vertex[1]], pair->b.vertices[b->vertex[0]]));
    pe_vec3 w = pe_cross(u, v);
    return pe_dot(w, w) < PE_LINE_CONTACT * PE_LINE_CONTACT * pe_dot(u, u) * pe_dot(v, v);
}

/* Tries the edge of one polytope, number `edge`, against those of the face of the other. */
static bool meets_face_edge(const pe_polytope_pair *pair, const pe_separation *face, int edge,
                            pe_separation *meeting)
{
    const bool of_a = face->kind == PE_OF_FACE_A;
    const pe_polytope *p = of_a ? &pair->a : &pair->b;
    const int index = of_a ? face->a : face->b;
    for (int i = 0; i < p->edge_count; ++i) {
        if (p->edges[i].face[0] != index && p->edges[i].face[1] != index) {
            continue;
        }
        const int ia = of_a ? i : edge, ib = of_a ? edge : i;
        const pe_edge *a = &pair->a.edges[ia], *b = &pair->b.edges[ib];
        pe_vec3 n;
        if (are_parallel(pair, a, b) && meet(pair, a, b, face->normal, &n)) {
            *meeting = (pe_separation){.distance = pe_polytope_separation_along(pair, n),
                                       .normal = n,
                                       .kind = PE_OF_LINE,
                                       .a = ia,
                                       .b = ib};
            return true;
        }
    }
    return false;
}

bool pe_polytope_edges_meet(const pe_polytope_pair *pair, const pe_separation *face,
                            pe_separation *meeting)
{
    const double reach = PE_EDGES_MEET * pair->size;
    if (fabs(face->distance) > reach || pair->a.radius > 0 || pair->b.radius > 0) {
        return false;
    }
    const bool of_a = face->kind == PE_OF_FACE_A;
    const pe_polytope *p = of_a ? &pair->a : &pair->b, *q = of_a ? &pair->b : &pair->a;
    const pe_transform *q_in_p = of_a ? &pair->b_in_a : &pair->a_in_b;
    const pe_vec3 out =
        of_a ? pe_scale(-1, pe_unrotate(&pair->b_in_a.turn, face->normal)) : face->normal;
    /* Most faces that touch lie on each other. */
    double cosine;
    pe_polytope_facing(q, out, &cosine);
    if (cosine > PE_REFERENCE_COSINE &&
        lies_over(p, &p->faces[of_a ? face->a : face->b], q_in_p->offset)) {
        return false;
    }
    const double top = pe_dot(out, q->vertices[of_a ? face->ends_b[0] : face->ends_a[0]]);
    bool found = false;
    for (int i = 0; i < q->edge_count && !found; ++i) {
        found =
            is_level(q, &q->edges[i], out, top, reach) && meets_face_edge(pair, face, i, meeting);
    }
    return found;
}
