/* Contact points of two polytopes.
 *
 * Where a face of one looks along the normal, or nearly, the facing face of the other is clipped
 * along the normal against its sides (Sutherland and Hodgman 1974); a segment is clipped likewise.
 * Each corner of what they have in common is named by the two edges that bound it, whichever shape
 * was the reference, so that names stay when the choice of normal flips. Edges that are parallel,
 * or nearly so and rounded, touch along a line: its ends. Anything else touches at the nearest
 * points.
 *
 * The least separation is always that of the cores less the radii: when no corner has it, the
 * nearest points are added. */
#include "candidates.h"
#include "polytope.h"

/* Cosine of the angle between a face and the normal up to which it is a patch of contact. */
static const double FLAT = 0.995;
/* The second shape's face is the reference when its cosine is larger by this, 1e-3 rad off: at rest
 * the choice must be the same at every step. */
static const double SAME_COSINE = 1e-6;
/* Sine of the angle up to which two edges touch along a line. */
static const double ALONG = 0.01;
/* Cosine between an edge and the normal up to which the edge lies across the normal. */
static const double ACROSS = 1e-4;
/* In units of the smaller shape: */
static const double CLIP_SLACK = 1e-8;     /* points this far outside still lie on the face */
static const double SAME_PLACE = 1e-6;     /* corners this near to each other are one */
static const double SAME_DISTANCE = 5e-10; /* a corner that has the least separation */

/* Clipping adds a corner a side at most; the room for one more is never used. */
enum { MOST_CORNERS = 2 * PE_FACE_CORNERS + 1 };
_Static_assert((int)MOST_CORNERS < (int)PE_MOST_CANDIDATES, "corners and nearest points have room");

/* ---- A face as reference ---- */

/* The reference polytope p and the other one q, placed in p's axes. */
typedef struct view {
    const pe_polytope *p, *q;
    const pe_seen *placed;
    const pe_pose *pose; /* p's */
    pe_vec3 normal;      /* in p's axes, out of p */
    bool flipped;        /* p is the second shape */
} view;

static view view_of(const pe_polytope_pair *pair, pe_vec3 normal, bool flipped)
{
    return flipped ? (view){&pair->b,
                            &pair->a,
                            &pair->a_from_b,
                            pair->pose_b,
                            pe_scale(-1, pe_unrotate(&pair->b_from_a.turn, normal)),
                            true}
                   : (view){&pair->a, &pair->b, &pair->b_from_a, pair->pose_a, normal, false};
}

/* A corner of the polygon being clipped. */
typedef struct corner {
    pe_vec3 x;
    uint32_t edge; /* that leads on from it */
    uint32_t name; /* of the two edges that cross there */
    bool clipped;  /* no corner of the polygon at first */
} corner;

enum { EDGE_OF_B = 1 << 15 };

static uint32_t name_of(uint32_t edge, uint32_t other)
{
    return edge < other ? edge << 16 | other : other << 16 | edge;
}

/* Where the way from a point inside, `in` past the side, to one outside it, `out` past it, crosses
 * the side; points inside by the slack alone are there already. */
static pe_vec3 crossing(pe_vec3 x, double in, pe_vec3 y, double out)
{
    return in < 0 ? pe_madd(x, in / (in - out), pe_sub(y, x)) : x;
}

static bool same_place(pe_vec3 x, pe_vec3 y, double slack)
{
    double reach = SAME_PLACE / CLIP_SLACK * slack;
    pe_vec3 d = pe_sub(x, y);
    return pe_dot(d, d) <= reach * reach;
}

/* Keeps the part of `in` where `past` is not above the slack. A crossing next to the corner that is
 * kept is that corner. */
static int clip(const corner *in, const double *past, double slack, int count, uint32_t clip_edge,
                corner *out)
{
    int kept = 0;
    /* A convex polygon never fills the room; one that rounding made otherwise must not overrun it.
     */
    for (int i = 0; i < count && kept + 2 <= MOST_CORNERS; ++i) {
        int next = i + 1 < count ? i + 1 : 0;
        bool here = past[i] <= slack, there = past[next] <= slack;
        if (here) {
            out[kept++] = in[i];
        }
        if (here != there) {
            int stay = here ? i : next, leave = here ? next : i;
            pe_vec3 x = crossing(in[stay].x, past[stay], in[leave].x, past[leave]);
            if (!same_place(x, in[stay].x, slack)) {
                out[kept++] = (corner){x, here ? clip_edge : in[i].edge,
                                       name_of(clip_edge, in[i].edge), true};
            } else if (here) {
                out[kept - 1].edge = clip_edge;
            }
        }
    }
    return kept;
}

/* Side k of the reference face: how far past it, along the outward unit direction, a point is. */
typedef struct side {
    pe_vec3 out;
    double offset;
} side;

static side side_of(const view *w, const pe_face *face, int k)
{
    int next = k + 1 < pe_face_corners(face) ? k + 1 : 0;
    pe_vec3 from = w->p->vertices[pe_face_corner(w->p, face, k)];
    pe_vec3 to = w->p->vertices[pe_face_corner(w->p, face, next)];
    pe_vec3 out = pe_cross(pe_sub(to, from), w->normal);
    out = pe_scale(1 / pe_length(out), out);
    return (side){out, pe_dot(out, from)};
}

/* Clips q's face against p's. Returns where the corners then are: either buffer. */
static const corner *clip_face(const view *w, const pe_face *face, const pe_face *other,
                               double slack, corner *polygon, corner *spare, int *count)
{
    *count = pe_face_corners(other);
    for (int i = 0; i < *count; ++i) {
        pe_vec3 x = w->q->vertices[pe_face_corner(w->q, other, i)];
        uint32_t tag = w->flipped ? 0 : EDGE_OF_B, in = (uint32_t)(i > 0 ? i : *count) - 1;
        polygon[i] = (corner){pe_add(pe_rotate(&w->placed->turn, x), w->placed->offset),
                              (uint32_t)i | tag, name_of(in | tag, (uint32_t)i | tag), false};
    }
    for (int k = 0; k < pe_face_corners(face); ++k) {
        side s = side_of(w, face, k);
        double past[MOST_CORNERS];
        bool cut = false;
        for (int i = 0; i < *count; ++i) {
            past[i] = pe_dot(s.out, polygon[i].x) - s.offset;
            cut = cut || past[i] > slack;
        }
        if (cut) {
            *count = clip(polygon, past, slack, *count, (uint32_t)k | (w->flipped ? EDGE_OF_B : 0),
                          spare);
            corner *clipped = spare;
            spare = polygon;
            polygon = clipped;
        }
    }
    return polygon;
}

/* Clips q, a segment or a point. */
static int clip_segment(const view *w, const pe_face *face, double slack, corner ends[2])
{
    int count = w->q->vertex_count;
    for (int i = 0; i < count; ++i) {
        pe_vec3 x = pe_rotate(&w->placed->turn, w->q->vertices[i]);
        uint32_t edge = (uint32_t)i | (w->flipped ? 0 : EDGE_OF_B);
        ends[i] = (corner){pe_add(x, w->placed->offset), edge, name_of(edge, edge), false};
    }
    for (int k = 0; k < pe_face_corners(face) && count > 0; ++k) {
        side s = side_of(w, face, k);
        double past[2] = {0, 0};
        for (int i = 0; i < count; ++i) {
            past[i] = pe_dot(s.out, ends[i].x) - s.offset;
        }
        int out = past[0] > slack ? 0 : 1, in = 1 - out;
        if (past[out] > slack && (count == 1 || past[in] > slack)) {
            return 0;
        }
        if (past[out] > slack) {
            pe_vec3 x = crossing(ends[in].x, past[in], ends[out].x, past[out]);
            uint32_t edge = (uint32_t)k | (w->flipped ? EDGE_OF_B : 0);
            if (same_place(x, ends[in].x, slack)) {
                /* Its end stands on the face, or it passes a corner of the face. */
                ends[0] = ends[in];
                count = ends[0].clipped ? 0 : 1;
            } else if (same_place(x, ends[out].x, slack)) {
                ends[out].x = x;
            } else {
                ends[out] = (corner){x, edge, name_of(edge, ends[out].edge), true};
            }
        }
    }
    return count;
}

static uint64_t corner_name(const view *w, int face, int other, uint32_t edges)
{
    uint64_t a = (uint64_t)(w->flipped ? other : face), b = (uint64_t)(w->flipped ? face : other);
    return (a & 0x7fff) << 47 | (b & 0x7fff) << 32 | edges;
}

/* Points of face `index` of p and what of q faces it. */
static void face_contact(const view *w, int index, double size, pe_candidates *found)
{
    const pe_face *face = &w->p->faces[index];
    double slack = CLIP_SLACK * size, cosine;
    corner buffer[2][MOST_CORNERS];
    const corner *corners = buffer[0];
    int count, other = 0;
    if (w->q->face_count > 0) {
        other = pe_polytope_facing(w->q, pe_scale(-1, pe_unrotate(&w->placed->turn, w->normal)),
                                   &cosine);
        corners = clip_face(w, face, &w->q->faces[other], slack, buffer[0], buffer[1], &count);
    } else {
        count = clip_segment(w, face, slack, buffer[0]);
    }
    double along = pe_dot(face->normal, w->normal), radius = w->q->radius;
    for (int i = 0; i < count; ++i) {
        double height = (pe_dot(face->normal, corners[i].x) - face->offset) / along;
        bool ball = w->q->vertex_count == 1; /* which has one point */
        uint64_t name = ball ? 0 : corner_name(w, index, other, corners[i].name);
        pe_candidates_add(found, w->pose,
                          pe_madd(corners[i].x, -0.5 * (height + radius), w->normal),
                          height - radius, name);
    }
}

/* ---- Edges and nearest points ---- */

/* Points in a's axes and the features that they lie on: vertices, or edges by theirs. */
typedef struct witness {
    pe_vec3 on_a, on_b;
    int ends_a[2], ends_b[2];
} witness;

enum { NEAREST = 1, END_OF_A, END_OF_B }; /* corners of faces have 0 there */

static uint64_t witness_name(const pe_polytope_pair *pair, uint64_t kind, const int a[2],
                             const int b[2])
{
    if (pair->a.vertex_count == 1 || pair->b.vertex_count == 1) {
        return 0; /* a ball has one point */
    }
    static const int whole[2] = {0, 1}; /* no matter whether at the end of a capsule's segment */
    a = pair->a.face_count == 0 && kind == NEAREST ? whole : a;
    b = pair->b.face_count == 0 && kind == NEAREST ? whole : b;
    uint64_t name = kind;
    name = name << 15 | ((uint64_t)(a[0] < a[1] ? a[0] : a[1]) & 0x7fff);
    name = name << 15 | ((uint64_t)(a[0] < a[1] ? a[1] : a[0]) & 0x7fff);
    name = name << 15 | ((uint64_t)(b[0] < b[1] ? b[0] : b[1]) & 0x7fff);
    return name << 15 | ((uint64_t)(b[0] < b[1] ? b[1] : b[0]) & 0x7fff);
}

static pe_vec3 vertex_of_b(const pe_polytope_pair *pair, int vertex)
{
    const pe_seen *placed = &pair->b_from_a;
    return pe_add(pe_rotate(&placed->turn, pair->b.vertices[vertex]), placed->offset);
}

/* Where two edges cross, seen along their common normal. It is within what they have beside each
 * other, which holds it where they are nearly parallel and the lines' crossing is uncertain. */
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

/* Where the direction's line of nearest points meets the cores. */
static witness witness_of(const pe_polytope_pair *pair, const pe_separation *s)
{
    return s->kind == PE_OF_EDGES
               ? crossing_of_edges(pair, &pair->a.edges[s->a], &pair->b.edges[s->b])
               : (witness){
                     s->on_a, s->on_b, {s->ends_a[0], s->ends_a[1]}, {s->ends_b[0], s->ends_b[1]}};
}

static void add_witness(const pe_polytope_pair *pair, const pe_separation *s, const witness *w,
                        pe_candidates *found)
{
    pe_vec3 on_a = pe_madd(w->on_a, pair->a.radius, s->normal);
    pe_vec3 on_b = pe_madd(w->on_b, -pair->b.radius, s->normal);
    pe_candidates_add(found, pair->pose_a, pe_scale(0.5, pe_add(on_a, on_b)),
                      pe_dot(s->normal, pe_sub(on_b, on_a)),
                      witness_name(pair, NEAREST, w->ends_a, w->ends_b));
}

/* Two edges side by side, by their places along the first one. */
typedef struct line {
    pe_vec3 along;           /* unit */
    pe_vec3 a[2], b[2];      /* ends */
    double at_a[2], at_b[2]; /* m */
} line;

/* The point of an edge at a place along the line. */
static pe_vec3 at(const pe_vec3 x[2], const double place[2], double t)
{
    return pe_madd(x[0], (t - place[0]) / (place[1] - place[0]), pe_sub(x[1], x[0]));
}

/* The point `t` along the line. Where the edges are rounded and off each other by y sideways, each
 * surface meets the normal at its share of y, below its top. */
static void add_line_point(const pe_polytope_pair *pair, const line *l, pe_vec3 n, double t,
                           uint64_t name, pe_candidates *found)
{
    double ra = pair->a.radius, rb = pair->b.radius, sum = ra + rb;
    pe_vec3 xa = at(l->a, l->at_a, t), xb = at(l->b, l->at_b, t), across = pe_cross(n, l->along);
    double y = pe_dot(across, pe_sub(xb, xa)), share = sum > 0 ? ra / sum : 0.5;
    if (fabs(y) > pe_max(0.5 * sum, CLIP_SLACK * pair->size)) {
        return;
    }
    double ya = share * y, yb = y - ya;
    xa = pe_madd(pe_madd(xa, ya, across), sqrt(pe_max(0, ra * ra - ya * ya)), n);
    xb = pe_madd(pe_madd(xb, -yb, across), -sqrt(pe_max(0, rb * rb - yb * yb)), n);
    /* The two points differ a little along the line: the one on the sharper shape counts. */
    double separation = pe_dot(n, pe_sub(xb, xa));
    pe_vec3 middle = ra < rb ? pe_madd(xa, 0.5 * separation, n) : pe_madd(xb, -0.5 * separation, n);
    pe_candidates_add(found, pair->pose_a, middle, separation, name);
}

/* Both ends of what two nearly parallel edges have beside each other. */
static void line_contact(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b,
                         pe_vec3 n, pe_candidates *found)
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
    int first_b = l.at_b[0] < l.at_b[1] ? 0 : 1;
    double low = pe_max(l.at_a[0], l.at_b[first_b]), high = pe_min(l.at_a[1], l.at_b[1 - first_b]);
    double slack = CLIP_SLACK * pair->size;
    if (!(high - low > slack)) {
        return;
    }
    for (int end = 0; end < 2; ++end) {
        double t = end == 0 ? low : high;
        int at_b = end == 0 ? first_b : 1 - first_b;
        bool of_a = fabs(t - l.at_a[end]) <= slack;
        int corner_a[2] = {a->vertex[end], a->vertex[end]};
        int corner_b[2] = {b->vertex[at_b], b->vertex[at_b]};
        uint64_t name = of_a ? witness_name(pair, END_OF_A, corner_a, b->vertex)
                             : witness_name(pair, END_OF_B, a->vertex, corner_b);
        add_line_point(pair, &l, n, t, name, found);
    }
}

/* Sine of the angle of two edges that both lie across the normal; 2: they do not. */
static double sine_of_edges(const pe_polytope_pair *pair, const pe_edge *a, const pe_edge *b,
                            const pe_separation *s)
{
    pe_vec3 u = pe_sub(pair->a.vertices[a->vertex[1]], pair->a.vertices[a->vertex[0]]);
    pe_vec3 v = pe_rotate(&pair->b_from_a.turn,
                          pe_sub(pair->b.vertices[b->vertex[1]], pair->b.vertices[b->vertex[0]]));
    double lu = pe_length(u), lv = pe_length(v);
    /* Over a wide gap points opposite along the normal would be off each other. */
    double most = ACROSS * pe_min(1, pair->size / fabs(s->distance));
    bool across = fabs(pe_dot(u, s->normal)) < most * lu && fabs(pe_dot(v, s->normal)) < most * lv;
    return across ? pe_length(pe_cross(u, v)) / (lu * lv) : 2;
}

/* The most parallel edges at the features of the witness that lie across the normal. */
static void touching_line(const pe_polytope_pair *pair, const pe_separation *s, const witness *w,
                          pe_candidates *found)
{
    const pe_polytope *a = &pair->a, *b = &pair->b;
    if (a->edge_count == 0 || b->edge_count == 0) {
        return;
    }
    double least = ALONG;
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
        line_contact(pair, edge_a, edge_b, s->normal, found);
    }
}

/* ---- All together ---- */

/* The points along the direction; false when `must_be_real` and none has its distance. */
static bool contact(const pe_polytope_pair *pair, const pe_separation *s, bool must_be_real,
                    double margin, pe_pair_manifold *hits)
{
    double separation = s->distance - pair->a.radius - pair->b.radius;
    pe_candidates found;
    pe_candidates_none(&found);
    double cosine_a = -2, cosine_b = -2;
    pe_vec3 back = pe_scale(-1, pe_unrotate(&pair->b_from_a.turn, s->normal));
    int face_a = s->a, face_b = s->b;
    if (s->kind == PE_OF_FACE_A) {
        cosine_a = 1;
    } else if (pair->a.face_count > 0) {
        face_a = pe_polytope_facing(&pair->a, s->normal, &cosine_a);
    }
    if (s->kind == PE_OF_FACE_B) {
        cosine_b = 1;
    } else if (s->kind != PE_OF_FACE_A && pair->b.face_count > 0) {
        face_b = pe_polytope_facing(&pair->b, back, &cosine_b);
    }
    bool flipped = cosine_b > cosine_a + SAME_COSINE;
    if (pe_max(cosine_a, cosine_b) > FLAT) {
        view w = view_of(pair, s->normal, flipped);
        face_contact(&w, flipped ? face_b : face_a, pair->size, &found);
    }
    double tolerance = SAME_DISTANCE * pair->size;
    if (found.least > separation + tolerance) {
        if (must_be_real) {
            return false;
        }
        /* Cores that touch where no face does have their nearest points, too. */
        bool touch = s->kind != PE_OF_EDGES && fabs(s->distance) <= tolerance;
        pe_separation points = touch ? pe_polytope_distance(pair, s) : *s;
        witness w = witness_of(pair, &points);
        if (found.count == 0) {
            touching_line(pair, s, &w, &found);
        }
        if (found.least > separation + tolerance) {
            add_witness(pair, s, &w, &found);
        }
    }
    hits->normal = pe_rotate(&pair->pose_a->rotation, s->normal);
    hits->normal_on_b = s->kind == PE_OF_FACE_B;
    hits->least_margin = separation;
    pe_candidates_keep(&found, pair->size, margin, hits);
    return true;
}

void pe_collide_polytopes_apart(const pe_polytope_pair *pair, const pe_separation *start,
                                double margin, pe_pair_manifold *hits)
{
    pe_separation s = pe_polytope_distance(pair, start);
    if (s.distance - pair->a.radius - pair->b.radius <= margin) {
        contact(pair, &s, false, margin, hits);
    }
}

void pe_collide_polytopes(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits)
{
    pe_polytope_pair pair;
    pe_polytope_pair_make(a, b, &pair);
    double limit = margin + pair.a.radius + pair.b.radius;
    pe_separation s;
    if (!pe_polytope_best_face(&pair, limit, &s)) {
        return;
    }
    /* A gap along a face is the distance when points have it; else the distance is to be found. */
    if (s.distance > 0) {
        if (!contact(&pair, &s, true, margin, hits)) {
            pe_collide_polytopes_apart(&pair, &s, margin, hits);
        }
        return;
    }
    if (!pe_polytope_best_edges(&pair, limit, &s)) {
        return;
    }
    if (s.distance > 0) {
        pe_collide_polytopes_apart(&pair, &s, margin, hits);
    } else {
        contact(&pair, &s, false, margin, hits);
    }
}
