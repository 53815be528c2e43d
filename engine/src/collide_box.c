/* Box against box: separating axes, then face clipping or the nearest points of two edges.
 *
 * Of the 15 axes (Gottschalk, Lin, Manocha 1996) the one of largest separation is taken, with a
 * bias towards faces, and towards the first box's: among axes that tie within rounding, a resting
 * stack must choose the same one at every step. A face contact clips the facing face of the other
 * box against the sides of the reference face (Sutherland and Hodgman 1974), at most 8 points, each
 * named by the two edges that bound it.
 *
 * Everything is worked out in the axes of the boxes; the world is met again at the points. */
#include "collide.h"

/* Tolerances, in units of the smaller box. */
static const double FACE_BIAS = 1e-5; /* the second box's face must be better by this */
/* A pair of edges must be better than faces by this. An edge contact is one point where a face
 * contact has four: with a smaller bias, nearly flat bricks of a falling wall are held at one point
 * only and turn into each other about it. */
static const double EDGE_BIAS = 1e-3;
static const double CLIP_SLACK = 1e-6; /* points this far outside still lie on the face */
/* Edges at a smaller angle than this, in rad, are parallel: a face axis serves as well. */
static const double LEAST_SINE = 1e-3;

typedef struct axis_choice {
    double separation;
    int i, j; /* face: axis i; edges: axis i of the first box, j of the second */
} axis_choice;

/* One box as the other sees it. */
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

/* Whether s / sqrt(square) > t, for square > 0, without the root. */
static bool quotient_exceeds(double s, double square, double t)
{
    return t < 0 ? s >= 0 || s * s < t * t * square : s > 0 && s * s > t * t * square;
}

/* The best pair of edges, of those better than best->separation; false as soon as one separates by
 * more than the margin. */
static bool test_edges(const box_pair *p, double margin, axis_choice *best)
{
    const double *ea = p->a.extent, *eb = p->b.extent, *t = p->a.offset;
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
            if (sine2 < LEAST_SINE * LEAST_SINE || !quotient_exceeds(s, sine2, best->separation)) {
                continue;
            }
            *best = (axis_choice){s / sqrt(sine2), i, j};
            if (best->separation > margin) {
                return false;
            }
        }
    }
    return true;
}

/* The middle of the box's edge along axis k that lies farthest along the direction. Names the edge
 * by the signs of the two other axes. */
static pe_vec3 far_edge(const box_side *box, int k, pe_vec3 direction, uint32_t *name)
{
    pe_vec3 x = box->pose->position;
    *name = (uint32_t)k;
    for (int m = 1; m < 3; ++m) {
        int q = (k + m) % 3;
        bool positive = pe_dot(axis_of(box, q), direction) > 0;
        x = pe_madd(x, positive ? box->extent[q] : -box->extent[q], axis_of(box, q));
        *name = *name << 1 | positive;
    }
    return x;
}

static void edge_contact(const box_pair *p, axis_choice edge, pe_hits *hits)
{
    pe_vec3 u = axis_of(&p->a, edge.i), v = axis_of(&p->b, edge.j);
    pe_vec3 n = pe_cross(u, v);
    bool against = pe_dot(n, pe_sub(p->b.pose->position, p->a.pose->position)) < 0;
    n = pe_scale((against ? -1 : 1) / pe_length(n), n);
    uint32_t name_a, name_b;
    pe_vec3 x = far_edge(&p->a, edge.i, n, &name_a);
    pe_vec3 y = far_edge(&p->b, edge.j, pe_scale(-1, n), &name_b);

    /* Nearest points x + s u and y + t v of the two lines, held to the edges. */
    pe_vec3 d = pe_sub(y, x);
    double c = p->a.r[edge.i][edge.j], du = pe_dot(d, u), dv = pe_dot(d, v);
    double sine2 = 1 - c * c;
    double ea = p->a.extent[edge.i], eb = p->b.extent[edge.j];
    double s = pe_max(-ea, pe_min(ea, (du - c * dv) / sine2));
    double t = pe_max(-eb, pe_min(eb, (c * du - dv) / sine2));
    hits->normal = n;
    hits->count = 1;
    hits->item[0] = (pe_hit){
        .position = pe_scale(0.5, pe_add(pe_madd(x, s, u), pe_madd(y, t, v))),
        .separation = edge.separation,
        .feature = 1u << 31 | name_a << 8 | name_b,
    };
}

/* A corner of the polygon being clipped: coordinates on the reference face and height over it, with
 * the name of the edge that leads on from it. */
typedef struct corner {
    double x[2], height;
    uint32_t edge;
} corner;

enum { MAX_CORNERS = PE_MAX_POINTS + 4 };

/* Keeps the part of `in` where the distances past the clip line are not above 0. */
static int clip(const corner *in, const double *past, int count, uint32_t clip_edge, corner *out)
{
    int kept = 0;
    /* A convex polygon never fills the room; one that rounding made otherwise must not overrun it.
     */
    for (int i = 0; i < count && kept + 2 <= MAX_CORNERS; ++i) {
        int next = i + 1 < count ? i + 1 : 0;
        const corner *p = &in[i], *q = &in[next];
        if (past[i] <= 0) {
            out[kept++] = *p;
        }
        if ((past[i] <= 0) != (past[next] <= 0)) {
            double t = past[i] / (past[i] - past[next]);
            out[kept++] = (corner){
                .x = {p->x[0] + t * (q->x[0] - p->x[0]), p->x[1] + t * (q->x[1] - p->x[1])},
                .height = p->height + t * (q->height - p->height),
                .edge = past[i] <= 0 ? clip_edge : p->edge,
            };
        }
    }
    return kept;
}

/* Clips against the rectangle |x[0]| <= bound[0], |x[1]| <= bound[1], whose edges are named 4 .. 7.
 * The polygon reaches from middle - reach to middle + reach in x. Returns where it then is:
 * `polygon` itself, which is overwritten, or `spare`. */
static corner *clip_to_rectangle(corner *polygon, corner *spare, int *count, const double middle[2],
                                 const double reach[2], const double bound[2])
{
    for (uint32_t line = 0; line < 4; ++line) {
        int k = line < 2 ? 0 : 1;
        double sign = line % 2 == 0 ? 1 : -1, past[MAX_CORNERS];
        if (!(sign * middle[k] + reach[k] > bound[k])) {
            continue;
        }
        for (int i = 0; i < *count; ++i) {
            past[i] = sign * polygon[i].x[k] - bound[k];
        }
        *count = clip(polygon, past, *count, 4 + line, spare);
        corner *clipped = spare;
        spare = polygon;
        polygon = clipped;
    }
    return polygon;
}

/* One box's face as reference, axis k towards the other box, and that box's facing face. */
static void face_contact(const box_side *box, const box_side *other, int k, double size,
                         double margin, bool flipped, pe_hits *hits)
{
    double side = box->offset[k] < 0 ? -1 : 1; /* n = side * axis[k] */
    int ku = k < 2 ? k + 1 : 0, kv = k > 0 ? k - 1 : 2;

    /* The facing face: the axis of the other box most opposed to n. */
    int m = 0;
    for (int q = 1; q < 3; ++q) {
        m = fabs(box->r[k][q]) > fabs(box->r[k][m]) + 1e-9 ? q : m;
    }
    double facing = side * box->r[k][m] > 0 ? -1 : 1;
    int mu = m < 2 ? m + 1 : 0, mv = m > 0 ? m - 1 : 2;

    /* Its middle and half edges, with heights in the last place. */
    const double *e = other->extent;
    const double *row[3] = {box->r[ku], box->r[kv], box->r[k]};
    double origin[3] = {box->offset[ku], box->offset[kv], box->offset[k]}, middle[3], u[3], v[3];
    for (int q = 0; q < 3; ++q) {
        double sign = q < 2 ? 1 : side;
        middle[q] = sign * (origin[q] + facing * e[m] * row[q][m]);
        u[q] = sign * e[mu] * row[q][mu];
        v[q] = sign * e[mv] * row[q][mv];
    }
    middle[2] -= box->extent[k];
    corner buffer[2][MAX_CORNERS];
    for (uint32_t c = 0; c < 4; ++c) {
        double su = c == 0 || c == 3 ? -1 : 1, sv = c < 2 ? -1 : 1;
        buffer[0][c] = (corner){
            .x = {middle[0] + su * u[0] + sv * v[0], middle[1] + su * u[1] + sv * v[1]},
            .height = middle[2] + su * u[2] + sv * v[2],
            .edge = c,
        };
    }
    int count = 4;
    double slack = CLIP_SLACK * size;
    const double bound[2] = {box->extent[ku] + slack, box->extent[kv] + slack};
    const double reach[2] = {fabs(u[0]) + fabs(v[0]), fabs(u[1]) + fabs(v[1])};
    const corner *polygon = clip_to_rectangle(buffer[0], buffer[1], &count, middle, reach, bound);

    uint32_t faces = (uint32_t)flipped << 6 | (uint32_t)(2 * k + (side > 0)) << 3 |
                     (uint32_t)(2 * m + (facing > 0));
    pe_vec3 n = pe_scale(side, axis_of(box, k)), tu = axis_of(box, ku), tv = axis_of(box, kv);
    hits->normal = flipped ? pe_scale(-1, n) : n;
    hits->normal_on_b = flipped;
    for (int i = 0; i < count && hits->count < PE_MAX_POINTS; ++i) {
        const corner *c = &polygon[i];
        if (c->height > margin) {
            hits->end_margin = pe_min(hits->end_margin, c->height);
            continue;
        }
        hits->least_margin = pe_max(hits->least_margin, c->height);
        pe_vec3 x = pe_madd(pe_madd(box->pose->position, c->x[0], tu), c->x[1], tv);
        uint32_t edge_in = polygon[i > 0 ? i - 1 : count - 1].edge;
        hits->item[hits->count++] = (pe_hit){
            .position = pe_madd(x, box->extent[k] + 0.5 * c->height, n),
            .separation = c->height,
            .feature = faces << 6 | edge_in << 3 | c->edge,
        };
    }
}

void pe_collide_box_box(pe_placed a, pe_placed b, double margin, pe_hits *hits)
{
    box_pair p;
    axis_choice face_a, face_b;
    describe(a, b, &p);
    if (!test_faces(&p, margin, &face_a, &face_b)) {
        return;
    }
    double face = pe_max(face_a.separation, face_b.separation);
    axis_choice edge = {.separation = face};
    if (!test_edges(&p, margin, &edge)) {
        return;
    }
    double size = pe_min(a.size, b.size);
    hits->least_margin = edge.separation;
    if (edge.separation > face + EDGE_BIAS * size) {
        edge_contact(&p, edge, hits);
    } else if (face_b.separation > face_a.separation + FACE_BIAS * size) {
        face_contact(&p.b, &p.a, face_b.i, size, margin, true, hits);
    } else {
        face_contact(&p.a, &p.b, face_a.i, size, margin, false, hits);
    }
}
