/* Manifold points of two polytopes.
 *
 * If a face of one looks along the normal, or nearly, the facing face of the other is clipped along
 * the normal against the sides of the first (Sutherland and Hodgman 1974). A segment is clipped
 * likewise. Each corner of the common part is identified by the two edges that cross there,
 * whichever shape was the reference, so that feature ids stay when the choice of normal flips.
 * Edges that are parallel, or nearly so and rounded, touch along a line: the points are its ends.
 * All other features touch at their nearest points.
 *
 * The least separation is always that of the cores minus the radii: if no corner realises it, the
 * nearest points are added. */
#include "narrow_phase/tolerances.h"
#include "polytope_edges.h"

/* Clipping adds at most one corner a side. The room for one more is never used. */
enum { MOST_CORNERS = 2 * PE_FACE_CORNERS + 1 };
_Static_assert((int)MOST_CORNERS < (int)PE_MOST_CANDIDATES, "corners and nearest points have room");

/* ---- A face as reference ---- */

/* The reference polytope p, with face `face`, and the other polytope q, placed in p's axes. */
typedef struct view {
    const pe_polytope *p, *q;
    const pe_transform *placed;
    const pe_pose *pose; /* p's */
    pe_vec3 normal;      /* in p's axes, out of p */
    bool flipped;        /* p is the second shape */
    const pe_face *face;
    double slack; /* m: points this far outside the face still lie on it */
} view;

static view view_of(const pe_polytope_pair *pair, pe_vec3 normal, bool flipped, int face)
{
    view w = {&pair->a, &pair->b, &pair->b_in_a, pair->pose_a, .normal = normal};
    if (flipped) {
        pe_vec3 back = pe_scale(-1, pe_unrotate(&pair->b_in_a.turn, normal));
        w = (view){&pair->b, &pair->a, &pair->a_in_b, pair->pose_b, back, .flipped = true};
    }
    w.face = &w.p->faces[face];
    w.slack = PE_CLIP_SLACK * pair->size;
    return w;
}

/* A corner of the polygon being clipped. */
typedef struct corner {
    pe_vec3 x;
    uint32_t edge;  /* that leaves the corner */
    uint32_t edges; /* the two edges that cross there, see edge_pair */
    bool clipped;   /* not a corner of the original polygon */
} corner;

typedef struct polygon {
    corner buffer[2][MOST_CORNERS], *corners; /* in one of the buffers */
    int count;
} polygon;

enum { EDGE_OF_B = 1 << 15 };

static uint32_t edge_pair(uint32_t edge, uint32_t other)
{
    return edge < other ? edge << 16 | other : other << 16 | edge;
}

/* The point where the line from x, inside a side, to y, outside, crosses that side. `in` and `out`
 * are their distances past the side. A point x that is inside by the slack only crosses at once. */
static pe_vec3 crossing(pe_vec3 x, double in, pe_vec3 y, double out)
{
    return in < 0 ? pe_madd(x, in / (in - out), pe_sub(y, x)) : x;
}

static bool same_place(pe_vec3 x, pe_vec3 y, double slack)
{
    double reach = PE_SAME_CORNER / PE_CLIP_SLACK * slack;
    pe_vec3 d = pe_sub(x, y);
    return pe_dot(d, d) <= reach * reach;
}

/* Keeps the part of the polygon where `past` does not exceed the slack. A crossing that is near the
 * corner that is kept becomes that corner. */
static void clip(polygon *p, const double *past, double slack, uint32_t clip_edge)
{
    const corner *in = p->corners;
    corner *out = p->buffer[p->corners == p->buffer[0]];
    int kept = 0;
    /* A convex polygon always fits. One that is not convex, by rounding, must not overrun. */
    for (int i = 0; i < p->count && kept + 2 <= MOST_CORNERS; ++i) {
        int next = i + 1 < p->count ? i + 1 : 0;
        bool here = past[i] <= slack, there = past[next] <= slack;
        if (here) {
            out[kept++] = in[i];
        }
        if (here != there) {
            int stay = here ? i : next, leave = here ? next : i;
            pe_vec3 x = crossing(in[stay].x, past[stay], in[leave].x, past[leave]);
            if (!same_place(x, in[stay].x, slack)) {
                out[kept++] = (corner){x, here ? clip_edge : in[i].edge,
                                       edge_pair(clip_edge, in[i].edge), true};
            } else if (here) {
                out[kept - 1].edge = clip_edge;
            }
        }
    }
    p->corners = out;
    p->count = kept;
}

/* A side of the reference face: x lies past it by out.x - offset. */
typedef struct side {
    pe_vec3 out; /* unit */
    double offset;
} side;

static side side_of(const view *w, int k)
{
    int next = k + 1 < pe_face_corners(w->face) ? k + 1 : 0;
    pe_vec3 from = w->p->vertices[pe_face_corner(w->p, w->face, k)];
    pe_vec3 to = w->p->vertices[pe_face_corner(w->p, w->face, next)];
    pe_vec3 out = pe_cross(pe_sub(to, from), w->normal);
    out = pe_scale(1 / pe_length(out), out);
    return (side){out, pe_dot(out, from)};
}

/* Clips a face of q. */
static void clip_face(const view *w, const pe_face *other, polygon *poly)
{
    int count = pe_face_corners(other);
    poly->count = count;
    for (int i = 0; i < count; ++i) {
        pe_vec3 x = w->q->vertices[pe_face_corner(w->q, other, i)];
        uint32_t tag = w->flipped ? 0 : EDGE_OF_B, in = (uint32_t)(i > 0 ? i : count) - 1;
        poly->corners[i] = (corner){pe_transform_point(w->placed, x), (uint32_t)i | tag,
                                    edge_pair(in | tag, (uint32_t)i | tag), false};
    }
    for (int k = 0; k < pe_face_corners(w->face); ++k) {
        side s = side_of(w, k);
        double past[MOST_CORNERS];
        bool cut = false;
        for (int i = 0; i < poly->count; ++i) {
            past[i] = pe_dot(s.out, poly->corners[i].x) - s.offset;
            cut = cut || past[i] > w->slack;
        }
        if (cut) {
            clip(poly, past, w->slack, (uint32_t)k | (w->flipped ? EDGE_OF_B : 0));
        }
    }
}

/* Clips q, a segment or a point. */
static void clip_segment(const view *w, polygon *poly)
{
    corner *ends = poly->corners;
    int count = w->q->vertex_count;
    for (int i = 0; i < count; ++i) {
        uint32_t edge = (uint32_t)i | (w->flipped ? 0 : EDGE_OF_B);
        ends[i] = (corner){pe_transform_point(w->placed, w->q->vertices[i]), edge,
                           edge_pair(edge, edge), false};
    }
    for (int k = 0; k < pe_face_corners(w->face) && count > 0; ++k) {
        side s = side_of(w, k);
        double past[2] = {0, 0};
        for (int i = 0; i < count; ++i) {
            past[i] = pe_dot(s.out, ends[i].x) - s.offset;
        }
        int out = past[0] > w->slack ? 0 : 1, in = 1 - out;
        if (past[out] > w->slack && (count == 1 || past[in] > w->slack)) {
            count = 0;
        } else if (past[out] > w->slack) {
            pe_vec3 x = crossing(ends[in].x, past[in], ends[out].x, past[out]);
            uint32_t edge = (uint32_t)k | (w->flipped ? EDGE_OF_B : 0);
            if (same_place(x, ends[in].x, w->slack)) {
                /* Its end stands on the face, or it passes a corner of the face. */
                ends[0] = ends[in];
                count = ends[0].clipped ? 0 : 1;
            } else if (same_place(x, ends[out].x, w->slack)) {
                ends[out].x = x;
            } else {
                ends[out] = (corner){x, edge, edge_pair(edge, ends[out].edge), true};
            }
        }
    }
    poly->count = count;
}

/* Adds the points of the reference face and of the feature of q that faces it. */
static void face_contact(const view *w, pe_candidates *found)
{
    polygon poly;
    poly.corners = poly.buffer[0];
    int face = (int)(w->face - w->p->faces), other = 0;
    if (w->q->face_count > 0) {
        double cosine;
        other = pe_polytope_facing(w->q, pe_scale(-1, pe_unrotate(&w->placed->turn, w->normal)),
                                   &cosine);
        clip_face(w, &w->q->faces[other], &poly);
    } else {
        clip_segment(w, &poly);
    }
    uint64_t a = (uint64_t)(w->flipped ? other : face), b = (uint64_t)(w->flipped ? face : other);
    uint64_t faces = (a & 0x7fff) << 47 | (b & 0x7fff) << 32;
    double along = pe_dot(w->face->normal, w->normal), radius = w->q->radius;
    for (int i = 0; i < poly.count; ++i) {
        const corner *c = &poly.corners[i];
        double height = (pe_dot(w->face->normal, c->x) - w->face->offset) / along;
        bool ball = w->q->vertex_count == 1; /* which has one point */
        pe_candidates_add(found, w->pose, pe_madd(c->x, -0.5 * (height + radius), w->normal),
                          height - radius, ball ? 0 : faces | c->edges);
    }
}

/* ---- Manifolds ---- */

/* Adds the points of a line, and of the faces what lies farther from touching than a line may. */
static void line_and_faces(const pe_polytope_pair *pair, const pe_separation *line,
                           const pe_candidates *faces, pe_candidates *found)
{
    pe_polytope_add_nearest(pair, line, line, line->distance + PE_SAME_DISTANCE * pair->size,
                            found);
    for (int i = 0; i < faces->count; ++i) {
        const pe_pair_point *point = &faces->item[i];
        if (point->separation > line->distance + PE_EDGES_MEET * pair->size) {
            found->item[found->count++] = *point;
        }
    }
}

/* Fills the manifold along the direction. False: `must_be_real`, and no point realises the
 * distance. */
static bool contact(const pe_polytope_pair *pair, const pe_separation *s, bool must_be_real,
                    double margin, pe_pair_manifold *manifold)
{
    double separation = s->distance - pair->a.radius - pair->b.radius;
    pe_candidates found;
    pe_candidates_clear(&found);
    double cosine_a = -2, cosine_b = -2;
    pe_vec3 back = pe_scale(-1, pe_unrotate(&pair->b_in_a.turn, s->normal));
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
    bool flipped = cosine_b > cosine_a + PE_REFERENCE_COSINE_TIE;
    if (pe_max(cosine_a, cosine_b) > PE_REFERENCE_COSINE) {
        view w = view_of(pair, s->normal, flipped, flipped ? face_b : face_a);
        face_contact(&w, &found);
    }
    double tolerance = PE_SAME_DISTANCE * pair->size;
    if (s->kind == PE_OF_LINE) {
        const pe_candidates faces = found;
        pe_candidates_clear(&found);
        line_and_faces(pair, s, &faces, &found);
    } else if (found.least > separation + tolerance) {
        if (must_be_real) {
            return false;
        }
        /* Cores that touch, but not at a face, have nearest points, too. */
        bool touch = s->kind != PE_OF_EDGES && fabs(s->distance) <= tolerance;
        pe_separation points = touch ? pe_polytope_distance(pair, s) : *s;
        pe_polytope_add_nearest(pair, s, &points, separation + tolerance, &found);
    }
    manifold->normal = pe_rotate(&pair->pose_a->rotation, s->normal);
    manifold->normal_on_b = s->kind == PE_OF_FACE_B;
    manifold->least_margin = separation;
    pe_candidates_keep(&found, pair->size, margin, manifold);
    return true;
}

/* The same for cores that `start` separates. */
static void contact_apart(const pe_polytope_pair *pair, const pe_separation *start, double margin,
                          pe_pair_manifold *manifold)
{
    pe_separation s = pe_polytope_distance(pair, start);
    if (s.distance - pair->a.radius - pair->b.radius <= margin) {
        contact(pair, &s, false, margin, manifold);
    }
}

bool pe_collide_meeting_edges(pe_placed a, pe_placed b, double margin, pe_pair_manifold *manifold)
{
    pe_polytope_pair pair;
    pe_polytope_pair_make(a, b, &pair);
    pe_separation face, line;
    return pe_polytope_best_face(&pair, margin + PE_EDGES_MEET * pair.size, &face) &&
           pe_polytope_edges_meet(&pair, &face, &line) &&
           contact(&pair, &line, false, margin, manifold);
}

void pe_collide_polytopes(pe_placed a, pe_placed b, double margin, pe_pair_manifold *manifold)
{
    pe_polytope_pair pair;
    pe_polytope_pair_make(a, b, &pair);
    double limit = margin + pair.a.radius + pair.b.radius;
    pe_separation s, line;
    if (!pe_polytope_best_face(&pair, limit + PE_EDGES_MEET * pair.size, &s)) {
        return;
    }
    if (pe_polytope_edges_meet(&pair, &s, &line)) {
        contact(&pair, &line, false, margin, manifold);
        return;
    }
    if (s.distance > limit) {
        return;
    }
    /* A gap along a face is the distance if points realise it; else the distance is to be found. */
    if (s.distance > 0 && contact(&pair, &s, true, margin, manifold)) {
        return;
    }
    if (!(s.distance > 0) && !pe_polytope_best_edges(&pair, limit, &s)) {
        return;
    }
    if (s.distance > 0) {
        contact_apart(&pair, &s, margin, manifold);
    } else {
        contact(&pair, &s, false, margin, manifold);
    }
}

/* ---- Capsules and spheres ---- */

/* A direction across both cores, towards b, along which they part if they meet. */
static pe_vec3 across_cores(const pe_polytope_pair *pair)
{
    pe_vec3 u = pe_v3(0, 0, 1), v = u, d = pair->b_in_a.offset; /* a capsule's axis is z */
    if (pair->a.edge_count > 0 && pair->b.edge_count > 0) {
        v = pe_axis(&pair->b_in_a.turn, 2);
    } else if (pair->b.edge_count > 0) {
        u = v = pe_axis(&pair->b_in_a.turn, 2);
    }
    pe_vec3 n = pe_cross(u, v), other;
    if (pe_dot(n, n) <= PE_SEGMENTS_PARALLEL2) {
        n = pe_madd(d, -pe_dot(u, d), u);
    }
    double length = pe_length(n);
    if (!(length > 0)) {
        pe_tangents(u, &n, &other);
        length = 1;
    }
    return pe_scale((pe_dot(n, d) < 0 ? -1 : 1) / length, n);
}

void pe_collide_capsule_or_sphere(pe_placed a, pe_placed b, double margin,
                                  pe_pair_manifold *manifold)
{
    pe_polytope_pair pair;
    pe_polytope_pair_make(a, b, &pair);
    pe_separation start = {.normal = across_cores(&pair)};
    start.distance = pe_polytope_separation_along(&pair, start.normal);
    contact_apart(&pair, &start, margin, manifold);
}
