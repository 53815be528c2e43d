/* Box against box: separating axes, then face clipping or the nearest points of two edges.
 *
 * Of the 15 axes (Gottschalk, Lin, Manocha 1996) the one of largest separation is taken, with a
 * bias towards faces, and towards the first box's: among axes that tie within rounding, a resting
 * stack must choose the same one at every step. A face contact clips the facing face of the other
 * box against the sides of the reference face (Sutherland and Hodgman 1974), at most 8 points, each
 * named by the two edges that bound it. */
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

/* The boxes in each other's terms. */
typedef struct box_pair {
    pe_vec3 axis_a[3], axis_b[3];
    double extent_a[3], extent_b[3];
    double r[3][3], abs_r[3][3]; /* r[i][j] = axis_a[i] . axis_b[j] */
    pe_vec3 offset;              /* from the centre of a to that of b, world */
    double offset_a[3], offset_b[3];
} box_pair;

static void describe(pe_placed a, pe_placed b, box_pair *p)
{
    pe_vec3 ea = a.shape->half_extents, eb = b.shape->half_extents;
    p->offset = pe_sub(b.pose->position, a.pose->position);
    for (int k = 0; k < 3; ++k) {
        p->axis_a[k] = pe_axis(&a.pose->rotation, k);
        p->axis_b[k] = pe_axis(&b.pose->rotation, k);
        p->extent_a[k] = pe_component(ea, k);
        p->extent_b[k] = pe_component(eb, k);
        p->offset_a[k] = pe_dot(p->axis_a[k], p->offset);
        p->offset_b[k] = pe_dot(p->axis_b[k], p->offset);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            p->r[i][j] = pe_dot(p->axis_a[i], p->axis_b[j]);
            p->abs_r[i][j] = fabs(p->r[i][j]);
        }
    }
}

/* The best face axis of each box; false as soon as one separates by more than the margin. */
static bool test_faces(const box_pair *p, double margin, axis_choice *a, axis_choice *b)
{
    *a = *b = (axis_choice){.separation = -HUGE_VAL};
    for (int k = 0; k < 3; ++k) {
        double reach_b = p->extent_b[0] * p->abs_r[k][0] + p->extent_b[1] * p->abs_r[k][1] +
                         p->extent_b[2] * p->abs_r[k][2];
        double s = fabs(p->offset_a[k]) - p->extent_a[k] - reach_b;
        if (s > margin) {
            return false;
        }
        if (s > a->separation) {
            *a = (axis_choice){.separation = s, .i = k};
        }
    }
    for (int k = 0; k < 3; ++k) {
        double reach_a = p->extent_a[0] * p->abs_r[0][k] + p->extent_a[1] * p->abs_r[1][k] +
                         p->extent_a[2] * p->abs_r[2][k];
        double s = fabs(p->offset_b[k]) - p->extent_b[k] - reach_a;
        if (s > margin) {
            return false;
        }
        if (s > b->separation) {
            *b = (axis_choice){.separation = s, .i = k};
        }
    }
    return true;
}

static bool test_edges(const box_pair *p, double margin, axis_choice *best)
{
    *best = (axis_choice){.separation = -HUGE_VAL};
    for (int i = 0; i < 3; ++i) {
        int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            double sine2 = 1 - p->r[i][j] * p->r[i][j];
            if (sine2 < LEAST_SINE * LEAST_SINE) {
                continue;
            }
            /* |offset . (a_i x b_j)| less the reach of both boxes along it, unnormalised. */
            double distance = fabs(p->offset_a[i2] * p->r[i1][j] - p->offset_a[i1] * p->r[i2][j]);
            double reach_a = p->extent_a[i1] * p->abs_r[i2][j] + p->extent_a[i2] * p->abs_r[i1][j];
            double reach_b = p->extent_b[j1] * p->abs_r[i][j2] + p->extent_b[j2] * p->abs_r[i][j1];
            double s = (distance - reach_a - reach_b) / sqrt(sine2);
            if (s > margin) {
                return false;
            }
            if (s > best->separation) {
                *best = (axis_choice){s, i, j};
            }
        }
    }
    return true;
}

/* The middle of the box's edge along axis k that lies farthest along the direction. Names the edge
 * by the signs of the two other axes. */
static pe_vec3 far_edge(const pe_vec3 axis[3], const double extent[3], pe_vec3 centre, int k,
                        pe_vec3 direction, uint32_t *name)
{
    pe_vec3 x = centre;
    *name = (uint32_t)k;
    for (int m = 1; m < 3; ++m) {
        int q = (k + m) % 3;
        bool positive = pe_dot(axis[q], direction) > 0;
        x = pe_madd(x, positive ? extent[q] : -extent[q], axis[q]);
        *name = *name << 1 | positive;
    }
    return x;
}

static void edge_contact(const box_pair *p, pe_vec3 centre_a, pe_vec3 centre_b, axis_choice edge,
                         pe_hits *hits)
{
    pe_vec3 u = p->axis_a[edge.i], v = p->axis_b[edge.j];
    pe_vec3 n = pe_cross(u, v);
    n = pe_scale((pe_dot(n, p->offset) < 0 ? -1 : 1) / pe_length(n), n);
    uint32_t name_a, name_b;
    pe_vec3 x = far_edge(p->axis_a, p->extent_a, centre_a, edge.i, n, &name_a);
    pe_vec3 y = far_edge(p->axis_b, p->extent_b, centre_b, edge.j, pe_scale(-1, n), &name_b);

    /* Nearest points x + s u and y + t v of the two lines, held to the edges. */
    pe_vec3 d = pe_sub(y, x);
    double c = p->r[edge.i][edge.j], du = pe_dot(d, u), dv = pe_dot(d, v);
    double sine2 = 1 - c * c;
    double ea = p->extent_a[edge.i], eb = p->extent_b[edge.j];
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
    double u, v, height;
    uint32_t edge;
} corner;

/* Keeps the part where sign * (along_v ? v : u) <= bound. Clip edges are named 4 .. 7. */
static int clip(const corner *in, int count, corner *out, double sign, bool along_v, double bound,
                uint32_t clip_edge)
{
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        const corner *p = &in[i], *q = &in[i + 1 < count ? i + 1 : 0];
        double dp = sign * (along_v ? p->v : p->u) - bound;
        double dq = sign * (along_v ? q->v : q->u) - bound;
        if (dp <= 0) {
            out[kept++] = *p;
        }
        if ((dp <= 0) != (dq <= 0)) {
            double t = dp / (dp - dq);
            out[kept++] = (corner){
                .u = p->u + t * (q->u - p->u),
                .v = p->v + t * (q->v - p->v),
                .height = p->height + t * (q->height - p->height),
                .edge = dp <= 0 ? clip_edge : p->edge,
            };
        }
    }
    return kept;
}

/* One box's face as reference, axis k towards the other box, and that box's facing face. */
static void face_contact(const pe_vec3 axis[3], const double extent[3], pe_vec3 centre, int k,
                         const pe_vec3 other_axis[3], const double other_extent[3],
                         pe_vec3 other_centre, double size, double margin, bool flipped,
                         pe_hits *hits)
{
    pe_vec3 offset = pe_sub(other_centre, centre);
    double side = pe_dot(axis[k], offset) < 0 ? -1 : 1;
    pe_vec3 n = pe_scale(side, axis[k]);
    int ku = (k + 1) % 3, kv = (k + 2) % 3;

    /* The facing face: the axis of the other box most opposed to n. */
    int m = 0;
    double cosine[3];
    for (int q = 0; q < 3; ++q) {
        cosine[q] = pe_dot(n, other_axis[q]);
        m = fabs(cosine[q]) > fabs(cosine[m]) + 1e-9 ? q : m;
    }
    double facing = cosine[m] > 0 ? -1 : 1;
    int mu = (m + 1) % 3, mv = (m + 2) % 3;
    pe_vec3 middle = pe_madd(offset, facing * other_extent[m], other_axis[m]);

    corner one[PE_MAX_POINTS + 4], two[PE_MAX_POINTS + 4];
    for (uint32_t c = 0; c < 4; ++c) {
        double su = c == 0 || c == 3 ? -1 : 1, sv = c < 2 ? -1 : 1;
        pe_vec3 x = pe_madd(pe_madd(middle, su * other_extent[mu], other_axis[mu]),
                            sv * other_extent[mv], other_axis[mv]);
        one[c] = (corner){pe_dot(axis[ku], x), pe_dot(axis[kv], x), pe_dot(n, x) - extent[k], c};
    }
    double slack = CLIP_SLACK * size;
    int count = clip(one, 4, two, 1, false, extent[ku] + slack, 4);
    count = clip(two, count, one, -1, false, extent[ku] + slack, 5);
    count = clip(one, count, two, 1, true, extent[kv] + slack, 6);
    count = clip(two, count, one, -1, true, extent[kv] + slack, 7);

    uint32_t faces = (uint32_t)flipped << 6 | (uint32_t)(2 * k + (side > 0)) << 3 |
                     (uint32_t)(2 * m + (facing > 0));
    hits->normal = flipped ? pe_scale(-1, n) : n;
    for (int i = 0; i < count && hits->count < PE_MAX_POINTS; ++i) {
        const corner *c = &one[i];
        if (c->height > margin) {
            continue;
        }
        pe_vec3 x = pe_madd(pe_madd(centre, c->u, axis[ku]), c->v, axis[kv]);
        uint32_t edge_in = one[i > 0 ? i - 1 : count - 1].edge;
        hits->item[hits->count++] = (pe_hit){
            .position = pe_madd(x, extent[k] + 0.5 * c->height, n),
            .separation = c->height,
            .feature = faces << 6 | edge_in << 3 | c->edge,
        };
    }
}

void pe_collide_box_box(pe_placed a, pe_placed b, double margin, pe_hits *hits)
{
    box_pair p;
    axis_choice face_a, face_b, edge;
    describe(a, b, &p);
    if (!test_faces(&p, margin, &face_a, &face_b) || !test_edges(&p, margin, &edge)) {
        return;
    }
    double size = pe_min(a.size, b.size);
    pe_vec3 ca = a.pose->position, cb = b.pose->position;
    if (edge.separation > pe_max(face_a.separation, face_b.separation) + EDGE_BIAS * size) {
        edge_contact(&p, ca, cb, edge, hits);
    } else if (face_b.separation > face_a.separation + FACE_BIAS * size) {
        face_contact(p.axis_b, p.extent_b, cb, face_b.i, p.axis_a, p.extent_a, ca, size, margin,
                     true, hits);
    } else {
        face_contact(p.axis_a, p.extent_a, ca, face_a.i, p.axis_b, p.extent_b, cb, size, margin,
                     false, hits);
    }
}
