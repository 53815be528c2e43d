/* Box against box: separating axes, then face clipping or the nearest points of two edges.
 *
 * Of the 15 axes (Gottschalk, Lin, Manocha 1996) the one of largest separation is the normal. A
 * face that looks along it, or nearly, is the reference. The facing face of the other box is
 * clipped along the normal against the sides of the reference (Sutherland and Hodgman 1974), which
 * leaves at most 8 points. Nearly flat boxes so keep all their points, with the same feature ids,
 * when a pair of edges or the other box's face separates slightly more than the reference.
 *
 * An axis that separates gives a lower bound of the distance. If no point realises it, the nearest
 * features are a corner and a corner or edge, or edges away from the axis. The general collider of
 * polytopes then finds them, and parallel edges that meet.
 *
 * The work is done in the axes of the boxes. Points are moved to the world at the end. */
#include "narrow_phase/tolerances.h"
#include "polytope.h"

typedef struct axis_choice {
    double separation;
    int i, j; /* of a face: axis i; of edges: axis i of the first box, j of the second */
} axis_choice;

/* One box of the pair. */
typedef struct box_side {
    const pe_pose *pose;
    double extent[3];
    double offset[3]; /* the other's centre from this one's, in this one's axes */
    double r[3][3];   /* r[i][j]: this one's axis i times the other's axis j */
} box_side;

typedef struct box_pair {
    box_side a, b;
    double reach[3][3]; /* |a.r| */
} box_pair;

static void store(double to[3], pe_vec3 v)
{
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
}

static pe_vec3 axis_of(const box_side *box, int k)
{
    return pe_axis(&box->pose->rotation, k);
}

static void describe(pe_placed a, pe_placed b, box_pair *p)
{
    const pe_mat3 *ra = &a.pose->rotation, *rb = &b.pose->rotation;
    pe_vec3 offset = pe_sub(b.pose->position, a.pose->position);
    p->a.pose = a.pose;
    p->b.pose = b.pose;
    store(p->a.extent, a.shape->half_extents);
    store(p->b.extent, b.shape->half_extents);
    store(p->a.offset, pe_unrotate(ra, offset));
    store(p->b.offset, pe_unrotate(rb, pe_scale(-1, offset)));
    for (int i = 0; i < 3; ++i) {
        pe_vec3 row = pe_unrotate(rb, pe_axis(ra, i));
        store(p->a.r[i], row);
        p->b.r[0][i] = row.x;
        p->b.r[1][i] = row.y;
        p->b.r[2][i] = row.z;
        store(p->reach[i], pe_v3(fabs(row.x), fabs(row.y), fabs(row.z)));
    }
}

/* The best face axis of each box; false as soon as one separates by more than the margin. */
static bool test_faces(const box_pair *p, double margin, axis_choice *a, axis_choice *b)
{
    const double *ea = p->a.extent, *eb = p->b.extent;
    *a = *b = (axis_choice){.separation = -HUGE_VAL};
    for (int k = 0; k < 3; ++k) {
        const double *q = p->reach[k];
        double s = fabs(p->a.offset[k]) - ea[k] - (eb[0] * q[0] + eb[1] * q[1] + eb[2] * q[2]);
        if (s > margin) {
            return false;
        }
        if (s > a->separation) {
            *a = (axis_choice){.separation = s, .i = k};
        }
    }
    for (int k = 0; k < 3; ++k) {
        double reach_a = ea[0] * p->reach[0][k] + ea[1] * p->reach[1][k] + ea[2] * p->reach[2][k];
        double s = fabs(p->b.offset[k]) - eb[k] - reach_a;
        if (s > margin) {
            return false;
        }
        if (s > b->separation) {
            *b = (axis_choice){.separation = s, .i = k};
        }
    }
    return true;
}

/* The cross of edges i and j in the axes of the first box, unnormalised: exact where the edges are
 * nearly parallel. */
static pe_vec3 cross_of(const box_pair *p, int i, int j)
{
    int i1 = i < 2 ? i + 1 : 0, i2 = i > 0 ? i - 1 : 2;
    double n[3];
    n[i] = 0;
    n[i1] = -p->a.r[i2][j];
    n[i2] = p->a.r[i1][j];
    return pe_v3(n[0], n[1], n[2]);
}

/* The separation along a direction in the axes of the first box, without cancellation. */
static double separation_along(const box_pair *p, pe_vec3 n)
{
    const double *t = p->a.offset, *ea = p->a.extent;
    double c[3] = {n.x, n.y, n.z}, s = fabs(t[0] * n.x + t[1] * n.y + t[2] * n.z);
    for (int k = 0; k < 3; ++k) {
        double along = c[0] * p->a.r[0][k] + c[1] * p->a.r[1][k] + c[2] * p->a.r[2][k];
        s -= ea[k] * fabs(c[k]) + p->b.extent[k] * fabs(along);
    }
    return s;
}

/* Replaces *best by an axis of nearly parallel edges that is better; `pairs` has bit 3 i + j set
 * for edges i and j. */
static void test_parallel(const box_pair *p, unsigned pairs, double tie, axis_choice *best)
{
    for (int k = 0; k < 9; ++k) {
        pe_vec3 n = cross_of(p, k / 3, k % 3);
        if (pairs >> k & 1) {
            double s = separation_along(p, pe_scale(1 / pe_length(n), n));
            if (s > best->separation + tie) {
                *best = (axis_choice){s, k / 3, k % 3};
            }
        }
    }
}

/* The best pair of edges, of those better than best->separation by `tie`; false as soon as one
 * separates by more than the margin. */
static bool test_edges(const box_pair *p, double margin, double tie, axis_choice *best)
{
    const double *ea = p->a.extent, *eb = p->b.extent, *t = p->a.offset;
    double exceed = best->separation + tie;
    unsigned parallel = 0;
    for (int i = 0; i < 3; ++i) {
        int i1 = i < 2 ? i + 1 : 0, i2 = i > 0 ? i - 1 : 2;
        const double *r1 = p->a.r[i1], *r2 = p->a.r[i2];
        const double *q = p->reach[i], *q1 = p->reach[i1], *q2 = p->reach[i2];
        for (int j = 0; j < 3; ++j) {
            int j1 = j < 2 ? j + 1 : 0, j2 = j > 0 ? j - 1 : 2;
            double sine2 = 1 - q[j] * q[j];
            /* |offset . (a_i x b_j)| less the reach of both boxes along it, unnormalised. */
            double s = fabs(t[i2] * r1[j] - t[i1] * r2[j]) - (ea[i1] * q2[j] + ea[i2] * q1[j]) -
                       (eb[j1] * q[j2] + eb[j2] * q[j1]);
            if (sine2 < PE_BOX_EDGES_NEAR_PARALLEL2) {
                double lengths = ea[i1] + ea[i2] + eb[j1] + eb[j2] + fabs(t[i1]) + fabs(t[i2]);
                sine2 = r1[j] * r1[j] + r2[j] * r2[j];
                bool may_gain =
                    sine2 > PE_BOX_EDGES_PARALLEL2 &&
                    pe_quotient_exceeds(s + PE_BOX_AXIS_ROUNDING * lengths, sine2, exceed);
                parallel |= (unsigned)may_gain << (3 * i + j);
                continue;
            }
            if (!pe_quotient_exceeds(s, sine2, exceed)) {
                continue;
            }
            *best = (axis_choice){s / sqrt(sine2), i, j};
            exceed = best->separation + tie;
            if (best->separation > margin) {
                return false;
            }
        }
    }
    if (parallel != 0) {
        test_parallel(p, parallel, tie, best);
    }
    return best->separation <= margin;
}

/* The midpoint of the box's edge along axis k that lies farthest along the direction. *id is the
 * axis with the signs of the two other axes. */
static pe_vec3 far_edge(const box_side *box, int k, pe_vec3 direction, uint32_t *id)
{
    pe_vec3 x = box->pose->position;
    *id = (uint32_t)k;
    for (int m = 1; m < 3; ++m) {
        int q = (k + m) % 3;
        bool positive = pe_dot(axis_of(box, q), direction) > 0;
        x = pe_madd(x, positive ? box->extent[q] : -box->extent[q], axis_of(box, q));
        *id = *id << 1 | positive;
    }
    return x;
}

/* The normal of a pair of edges, from the first box to the second. */
static pe_vec3 edge_normal(const box_pair *p, axis_choice edge)
{
    pe_vec3 n = pe_rotate(&p->a.pose->rotation, cross_of(p, edge.i, edge.j));
    bool against = pe_dot(n, pe_sub(p->b.pose->position, p->a.pose->position)) < 0;
    return pe_scale((against ? -1 : 1) / pe_length(n), n);
}

/* Adds the midpoint of the nearest points of two edges. False if they do not realise the separation
 * of the axis; those of overlapping boxes do. */
static bool edge_contact(const box_pair *p, axis_choice edge, pe_vec3 n, double tolerance,
                         pe_pair_manifold *manifold)
{
    pe_vec3 u = axis_of(&p->a, edge.i), v = axis_of(&p->b, edge.j);
    uint32_t id_a, id_b;
    pe_vec3 x = far_edge(&p->a, edge.i, n, &id_a);
    pe_vec3 y = far_edge(&p->b, edge.j, pe_scale(-1, n), &id_b);

    /* They cross at x + s u and y + t v, within the part where they lie next to each other. */
    pe_vec3 d = pe_sub(y, x), w = pe_cross(u, v);
    double square = pe_dot(w, w), ea = p->a.extent[edge.i], eb = p->b.extent[edge.j];
    double middle = pe_dot(d, u), reach = eb * fabs(p->a.r[edge.i][edge.j]);
    double s = square > 0 ? pe_dot(pe_cross(d, v), w) / square : middle;
    s = pe_max(middle - reach, pe_min(middle + reach, s));
    s = pe_max(-ea, pe_min(ea, s)); /* where no part does, at the end of a's edge */
    x = pe_madd(x, s, u);
    y = pe_madd(y, pe_max(-eb, pe_min(eb, pe_dot(pe_sub(x, y), v))), v);
    pe_vec3 rest = pe_madd(pe_sub(y, x), -edge.separation, n);
    if (edge.separation > 0 && pe_length(rest) > tolerance) {
        return false;
    }
    manifold->normal = n;
    manifold->count = 1;
    manifold->item[0] = (pe_pair_point){
        .position = pe_scale(0.5, pe_add(x, y)),
        .separation = edge.separation,
        .feature = 1u << 31 | id_a << 8 | id_b,
    };
    return true;
}

/* A corner of the polygon being clipped: coordinates on the reference face, height over it, and the
 * edge that leaves the corner: see feature_id.h. */
typedef struct corner {
    double x[2], height;
    uint32_t edge;
} corner;

enum { MAX_CORNERS = PE_MAX_POINTS + 4 };

typedef struct polygon {
    corner buffer[2][MAX_CORNERS], *corners; /* in one of the buffers */
    int count;
} polygon;

/* Keeps the part of `in` whose distances past the clip line do not exceed the slack. A side that
 * leaves from a corner beyond the line, but within the slack, is cut at that corner. */
static int clip(const corner *in, const double *past, double slack, int count, uint32_t clip_edge,
                corner *out)
{
    int kept = 0;
    /* A convex polygon always fits. One that is not convex, by rounding, must not overrun. */
    for (int i = 0; i < count && kept + 2 <= MAX_CORNERS; ++i) {
        int next = i + 1 < count ? i + 1 : 0;
        bool here = past[i] <= slack, there = past[next] <= slack;
        if (here) {
            out[kept++] = in[i];
        }
        if (here != there) {
            const corner *p = here ? &in[i] : &in[next], *q = here ? &in[next] : &in[i];
            double inner = pe_min(0, here ? past[i] : past[next]);
            double t = inner / (inner - (here ? past[next] : past[i]));
            out[kept++] = (corner){
                .x = {p->x[0] + t * (q->x[0] - p->x[0]), p->x[1] + t * (q->x[1] - p->x[1])},
                .height = p->height + t * (q->height - p->height),
                .edge = here ? clip_edge : in[i].edge,
            };
        }
    }
    return kept;
}

/* Clips against the rectangle |x[0]| <= bound[0], |x[1]| <= bound[1], whose edges have numbers 4
 * .. 7. The polygon reaches from middle - reach to middle + reach in x. */
static void clip_to_rectangle(polygon *p, const double middle[2], const double reach[2],
                              const double bound[2], double slack)
{
    for (uint32_t line = 0; line < 4; ++line) {
        int k = line < 2 ? 0 : 1;
        double sign = line % 2 == 0 ? 1 : -1, past[MAX_CORNERS];
        if (!(sign * middle[k] + reach[k] > bound[k] + slack)) {
            continue;
        }
        for (int i = 0; i < p->count; ++i) {
            past[i] = sign * p->corners[i].x[k] - bound[k];
        }
        corner *clipped = p->buffer[p->corners == p->buffer[0]];
        p->count = clip(p->corners, past, slack, p->count, 4 + line, clipped);
        p->corners = clipped;
    }
}

/* The reference face: that of axis k towards the other box. */
typedef struct reference {
    const box_side *box, *other;
    int k;
    bool flipped;   /* the box is the second one */
    bool tilted;    /* the normal is not the face's own */
    pe_vec3 normal; /* of the contact, in the world, out of the box */
} reference;

/* Replaces the height over the face by that along the normal, and the position by the foot along
 * the normal. */
static void shear(double x[3], const double tilt[2], double along)
{
    x[2] /= along;
    x[0] -= tilt[0] * x[2];
    x[1] -= tilt[1] * x[2];
}

/* The facing face of the other box: that of its axis `axis` most opposed to the reference face. */
typedef struct facing_face {
    int axis;
    double side; /* 1: the positive side of the axis, -1: the negative one */
} facing_face;

static facing_face facing_face_of(const box_side *box, int k, double side)
{
    int m = 0;
    for (int q = 1; q < 3; ++q) {
        m = fabs(box->r[k][q]) > fabs(box->r[k][m]) + PE_FACING_TIE ? q : m;
    }
    return (facing_face){m, side * box->r[k][m] > 0 ? -1 : 1};
}

/* The facing face over the reference face, clipped along the normal. */
static void make_polygon(const reference *r, facing_face facing, double side, double slack,
                         polygon *p)
{
    const box_side *box = r->box;
    int k = r->k, ku = k < 2 ? k + 1 : 0, kv = k > 0 ? k - 1 : 2;
    int m = facing.axis, mu = m < 2 ? m + 1 : 0, mv = m > 0 ? m - 1 : 2;
    /* Its midpoint and half edges; the last component is the height. */
    const double *e = r->other->extent;
    const double *row[3] = {box->r[ku], box->r[kv], box->r[k]};
    double origin[3] = {box->offset[ku], box->offset[kv], box->offset[k]}, middle[3], u[3], v[3];
    for (int q = 0; q < 3; ++q) {
        double scale = q < 2 ? 1 : side;
        middle[q] = scale * (origin[q] + facing.side * e[m] * row[q][m]);
        u[q] = scale * e[mu] * row[q][mu];
        v[q] = scale * e[mv] * row[q][mv];
    }
    middle[2] -= box->extent[k];
    if (r->tilted) {
        double along = pe_dot(r->normal, pe_scale(side, axis_of(box, k)));
        const double tilt[2] = {pe_dot(r->normal, axis_of(box, ku)),
                                pe_dot(r->normal, axis_of(box, kv))};
        shear(middle, tilt, along);
        shear(u, tilt, along);
        shear(v, tilt, along);
    }
    p->corners = p->buffer[0];
    p->count = 4;
    for (uint32_t c = 0; c < 4; ++c) {
        double su = c == 0 || c == 3 ? -1 : 1, sv = c < 2 ? -1 : 1;
        p->corners[c] = (corner){
            .x = {middle[0] + su * u[0] + sv * v[0], middle[1] + su * u[1] + sv * v[1]},
            .height = middle[2] + su * u[2] + sv * v[2],
            .edge = c,
        };
    }
    const double bound[2] = {box->extent[ku], box->extent[kv]};
    const double reach[2] = {fabs(u[0]) + fabs(v[0]), fabs(u[1]) + fabs(v[1])};
    clip_to_rectangle(p, middle, reach, bound, slack);
}

/* Adds the points of the other box's facing face, clipped along the normal. Returns the least
 * separation of all, within the margin or not. */
static double face_contact(const reference *r, double size, double margin,
                           pe_pair_manifold *manifold)
{
    const box_side *box = r->box;
    int k = r->k, ku = k < 2 ? k + 1 : 0, kv = k > 0 ? k - 1 : 2;
    double side = box->offset[k] < 0 ? -1 : 1; /* the face's own normal is side * axis[k] */
    pe_vec3 face = pe_scale(side, axis_of(box, k)), tu = axis_of(box, ku), tv = axis_of(box, kv);
    facing_face facing = facing_face_of(box, k, side);
    polygon p;
    make_polygon(r, facing, side, PE_CLIP_SLACK * size, &p);
    uint32_t faces = (uint32_t)r->flipped << 6 | (uint32_t)(2 * k + (side > 0)) << 3 |
                     (uint32_t)(2 * facing.axis + (facing.side > 0));
    double least = HUGE_VAL;
    pe_vec3 centre = pe_madd(box->pose->position, box->extent[k], face);
    for (int i = 0; i < p.count && manifold->count < PE_MAX_POINTS; ++i) {
        const corner *c = &p.corners[i];
        least = pe_min(least, c->height);
        if (!pe_pair_manifold_within(manifold, c->height, margin)) {
            continue;
        }
        pe_vec3 x = pe_madd(pe_madd(centre, c->x[0], tu), c->x[1], tv);
        uint32_t edge_in = p.corners[i > 0 ? i - 1 : p.count - 1].edge;
        manifold->item[manifold->count++] = (pe_pair_point){
            .position = pe_madd(x, 0.5 * c->height, r->normal),
            .separation = c->height,
            .feature = faces << 6 | edge_in << 3 | c->edge,
        };
    }
    manifold->normal = r->flipped ? pe_scale(-1, r->normal) : r->normal;
    return least;
}

/* Whether the face of axis k of a box looks along the normal out of the box. */
static bool looks_along(const box_side *box, int k, pe_vec3 normal)
{
    return (box->offset[k] < 0 ? -1 : 1) * pe_dot(axis_of(box, k), normal) >= PE_REFERENCE_COSINE;
}

/* The reference for the normal n of two edges. False: neither of the best faces looks along it. */
static bool reference_of_edges(const box_pair *p, axis_choice face_a, axis_choice face_b, pe_vec3 n,
                               double bias, reference *r)
{
    pe_vec3 back = pe_scale(-1, n);
    bool a = looks_along(&p->a, face_a.i, n), b = looks_along(&p->b, face_b.i, back);
    bool flipped = b && (!a || face_b.separation > face_a.separation + bias);
    *r = flipped ? (reference){&p->b, &p->a, face_b.i, true, true, back}
                 : (reference){&p->a, &p->b, face_a.i, false, true, n};
    return a || b;
}

/* The reference for the normal n of one of the faces: the first box's face unless it separates
 * clearly less. */
static reference reference_of_faces(const box_pair *p, axis_choice face_a, axis_choice face_b,
                                    bool of_b, pe_vec3 n, double bias)
{
    double cosine = p->a.r[face_a.i][face_b.i]; /* of the axes; of the normals up to the sign */
    bool same_side = (p->a.offset[face_a.i] < 0) == (p->b.offset[face_b.i] < 0);
    bool flat = (same_side ? -cosine : cosine) >= PE_REFERENCE_COSINE;
    if (of_b && (!flat || face_b.separation > face_a.separation + bias)) {
        return (reference){&p->b, &p->a, face_b.i, true, false, pe_scale(-1, n)};
    }
    return (reference){&p->a, &p->b, face_a.i, false, of_b, n};
}

/* The normal of a face, from the first box to the second. */
static pe_vec3 face_normal(const box_side *box, int k, bool flipped)
{
    return pe_scale((box->offset[k] < 0) != flipped ? -1 : 1, axis_of(box, k));
}

/* The axes of the box along which the other touches it, within `reach`: one of them, 3 if there are
 * more, -1 if there are none. */
static int touching_axis(const box_side *box, const box_side *other, double reach)
{
    int found = -1;
    const double *e = other->extent;
    for (int k = 0; k < 3; ++k) {
        const double *r = box->r[k];
        double s = fabs(box->offset[k]) - box->extent[k] -
                   (e[0] * fabs(r[0]) + e[1] * fabs(r[1]) + e[2] * fabs(r[2]));
        found = fabs(s) > reach ? found : found < 0 ? k : 3;
    }
    return found;
}

/* Whether the boxes touch along the normals of two faces that are not parallel. */
static bool may_meet_at_edges(const box_pair *p, double reach)
{
    int a = touching_axis(&p->a, &p->b, reach), b = touching_axis(&p->b, &p->a, reach);
    if (a < 0 || b < 0 || a == 3 || b == 3) {
        return a == 3 || b == 3; /* two of one box suffice */
    }
    return 1 - p->reach[a][b] * p->reach[a][b] > PE_MEETING_FLAT * PE_MEETING_FLAT;
}

void pe_collide_box_box(pe_placed a, pe_placed b, double margin, pe_pair_manifold *manifold)
{
    box_pair p;
    axis_choice face_a, face_b;
    describe(a, b, &p);
    double size = pe_min(a.size, b.size), tie = PE_AXIS_TIE * size,
           tolerance = PE_SAME_DISTANCE * size, reach = PE_EDGES_MEET * size;
    if (!test_faces(&p, margin + reach, &face_a, &face_b)) {
        return;
    }
    bool of_b = face_b.separation > face_a.separation + tie;
    axis_choice best = of_b ? face_b : face_a, edge = {.separation = best.separation};
    if ((fabs(best.separation) <= reach && may_meet_at_edges(&p, reach) &&
         pe_collide_meeting_edges(a, b, margin, manifold)) ||
        !test_edges(&p, margin, tie, &edge)) {
        return;
    }
    bool of_edges = edge.separation > best.separation;
    double separation = edge.separation;
    pe_vec3 n = of_edges ? edge_normal(&p, edge) : face_normal(of_b ? &p.b : &p.a, best.i, of_b);
    manifold->least_margin = separation;
    manifold->normal_on_b = of_b && !of_edges;
    double bias = PE_REFERENCE_BIAS * size;
    reference r;
    bool has_reference = true;
    if (of_edges) {
        has_reference = reference_of_edges(&p, face_a, face_b, n, bias, &r);
    } else {
        r = reference_of_faces(&p, face_a, face_b, of_b, n, bias);
    }
    if (has_reference ? face_contact(&r, size, margin, manifold) <= separation + tolerance
                      : edge_contact(&p, edge, n, tolerance, manifold)) {
        return;
    }
    /* No point realises the separation: the nearest features are others. */
    pe_pair_manifold_clear(manifold);
    pe_collide_polytopes(a, b, margin, manifold);
}
