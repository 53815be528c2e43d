/* The features of two solids that touch or come within reach: see collide_mesh.c for the rules. */
#include "collide_mesh.h"

/* Sine of the angle by which a contact's normal may lie outside what a feature faces, so that all
 * corners of a face that lies on another, nearly, are found. */
static const double FACING = 0.1;
/* The same for features that face each other strictly: rounding, and how a body at rest sways. */
static const double STRICT = 1e-6;
/* The same for the nearest features of a rounded shape: rounding alone. */
static const double ROUNDING = 1e-9;
/* Edges at a smaller angle than this, in rad, are parallel: their ends say as much. */
static const double LEAST_SINE = 1e-4;
typedef struct finder {
    const pe_solid_pair *pair;
    double reach, depth, bound; /* bound: the larger of the two */
    pe_touches *list;
} finder;

/* Whether no edge at the vertex leads back along -d by more than the angle: d in its axes. */
static bool faces(const pe_solid *solid, int vertex, pe_vec3 d, double length, double sine)
{
    for (int i = solid->vertex_first[vertex]; i < solid->vertex_first[vertex + 1]; ++i) {
        const pe_edge *edge = &solid->edges[solid->vertex_edges[i]];
        int other = edge->vertex[edge->vertex[0] == vertex];
        pe_vec3 u = pe_sub(solid->vertices[other], solid->vertices[vertex]);
        double rise = pe_dot(d, u), least = sine * length;
        if (rise < 0 && rise * rise > least * least * pe_dot(u, u)) {
            return false;
        }
    }
    return true;
}

bool pe_vertex_faces(const pe_solid *solid, int vertex, pe_vec3 normal, bool *strict)
{
    *strict = faces(solid, vertex, normal, 1, STRICT);
    return *strict || faces(solid, vertex, normal, 1, FACING);
}

static void add_vertex_face(const finder *f, int vertex, pe_vec3 x, const pe_facet *face,
                            double height, bool dent, bool strict)
{
    pe_touch touch = {
        .feature = pe_touch_feature(PE_VERTEX_FACE, vertex, face->face),
        .kind = PE_VERTEX_FACE,
        .normal = pe_scale(-1, face->normal),
        .on_a = x,
        .separation = height - f->pair->radius,
        .dent = dent,
        .strict = strict,
    };
    pe_touches_add(f->list, &touch);
}

static void add_face_vertex(const finder *f, int vertex, pe_vec3 x, const pe_facet *face,
                            double height, bool dent, bool strict)
{
    pe_touch touch = {
        .feature = pe_touch_feature(PE_FACE_VERTEX, vertex, face->face),
        .kind = PE_FACE_VERTEX,
        .normal = face->normal,
        .on_a = pe_madd(x, -height, face->normal),
        .separation = height,
        .dent = dent,
        .strict = strict,
    };
    pe_touches_add(f->list, &touch);
}

static bool within(const finder *f, const pe_facet *of, int k, double height)
{
    return (of->owns >> k & 1) != 0 && height <= f->reach &&
           height >= -pe_max(f->depth, f->pair->slack);
}

static void try_vertices(const finder *f, const pe_facet *a, const pe_facet *b,
                         const double above_a[3], const double above_b[3])
{
    const pe_solid_pair *pair = f->pair;
    bool dent, strict;
    for (int k = 0; k < 3; ++k) {
        if (within(f, a, k, above_b[k]) &&
            pe_facet_holds_dented(&pair->b, NULL, b, a->x[k], pair->slack, f->depth, &dent) &&
            pe_vertex_faces(&pair->a, a->vertices[k], pe_unrotate(&pair->trees.turn, b->normal),
                            &strict)) {
            add_vertex_face(f, a->vertices[k], a->x[k], b, above_b[k], dent, strict);
        }
        if (a->face >= 0 && within(f, b, k, above_a[k]) &&
            pe_facet_holds_dented(&pair->a, &pair->trees, a, b->x[k], pair->slack, f->depth,
                                  &dent) &&
            pe_vertex_faces(&pair->b, b->vertices[k], a->normal, &strict)) {
            add_face_vertex(f, b->vertices[k], b->x[k], a, above_a[k], dent, strict);
        }
    }
}

/* Two convex edges whose lines are nearest inside both. With u, v their directions and c = u x v,
 * the normal n = +-c/|c| rises along the faces of the first one by +-(v.n0) |u|^2/|c| and
 * -+(v.n1) |u|^2/|c| (for c x u has no part along v but that), and likewise with the second: the
 * signs of four products say whether both edges face each other (Gregorius 2013). */
static void try_edges(const finder *f, const pe_ridge *a, const pe_ridge *b)
{
    bool core = f->pair->a.core;
    double la = a->length, lb = b->length;
    double b0 = lb * pe_dot(a->along, b->normal[0]), b1 = -lb * pe_dot(a->along, b->normal[1]);
    double a0 = core ? 0 : la * pe_dot(b->along, a->normal[0]);
    double a1 = core ? 0 : -la * pe_dot(b->along, a->normal[1]);
    double sign = a0 + a1 + b0 + b1 > 0 ? 1 : -1, most = FACING * la * lb;
    if (pe_min(pe_min(sign * a0, sign * a1), pe_min(sign * b0, sign * b1)) < -most) {
        return;
    }
    pe_vec3 c = pe_cross(a->along, b->along), apart = pe_sub(b->x, a->x);
    double c2 = pe_dot(c, c);
    if (c2 <= LEAST_SINE * LEAST_SINE * a->length2 * b->length2) {
        return;
    }
    double scale = sign / sqrt(c2), separation = scale * pe_dot(apart, c);
    if (separation > f->reach || separation < -pe_max(f->depth, f->pair->slack)) {
        return;
    }
    double least = pe_min(pe_min(sign * a0, sign * a1), pe_min(sign * b0, sign * b1));
    double length = fabs(1 / scale);
    if (least < -FACING * length) {
        return;
    }
    double s = pe_dot(pe_cross(apart, b->along), c) / c2;
    double t = pe_dot(pe_cross(apart, a->along), c) / c2;
    double past_a = f->pair->slack / la, past_b = f->pair->slack / lb;
    if (s < -past_a || s > 1 + past_a || t < -past_b || t > 1 + past_b) {
        return;
    }
    pe_vec3 n = pe_scale(scale, c);
    pe_touch touch = {
        .feature = pe_touch_feature(PE_EDGE_EDGE, a->edge, b->edge),
        .kind = PE_EDGE_EDGE,
        .normal = n,
        .on_a = pe_madd(a->x, s, a->along),
        .separation = separation - f->pair->radius,
        .strict = least >= -STRICT * length,
        .along_a = a->along,
        .along_b = b->along,
    };
    pe_touches_add(f->list, &touch);
}

/* A point of the core and one of b that face each other across a gap. */
static void add_points(const finder *f, pe_touch_kind kind, int name_a, int name_b, pe_vec3 on_a,
                       pe_vec3 apart, double distance)
{
    pe_touch touch = {
        .feature = pe_touch_feature(kind, name_a, name_b),
        .kind = kind,
        .normal = pe_scale(1 / distance, apart),
        .on_a = on_a,
        .separation = distance - f->pair->radius,
    };
    pe_touches_add(f->list, &touch);
}

/* An end of the core and an edge of b, or one of its vertices. */
static void try_end_edge(const finder *f, int end, pe_vec3 x, const pe_ridge *b)
{
    const pe_solid_pair *pair = f->pair;
    double t = pe_dot(pe_sub(x, b->x), b->along) / b->length2;
    bool at_vertex = t <= 0 || t >= 1;
    int vertex = pair->b.edges[b->edge].vertex[t >= 1];
    pe_vec3 y = at_vertex ? pair->b.vertices[vertex] : pe_madd(b->x, t, b->along);
    pe_vec3 apart = pe_sub(y, x), out = pe_scale(-1, apart);
    double distance = pe_length(apart);
    if (distance > f->reach || !(distance > pair->slack) ||
        !faces(&pair->a, end, pe_unrotate(&pair->trees.turn, out), distance, FACING)) {
        return;
    }
    if (at_vertex ? faces(&pair->b, vertex, apart, distance, ROUNDING)
                  : pe_ridge_faces(b, out, distance, ROUNDING)) {
        add_points(f, at_vertex ? PE_VERTEX_VERTEX : PE_VERTEX_EDGE, end,
                   at_vertex ? vertex : b->edge, x, apart, distance);
    }
}

/* The inside of the core's segment and a vertex of b. */
static void try_segment_vertex(const finder *f, const pe_ridge *segment, int vertex, pe_vec3 y)
{
    double s = pe_dot(pe_sub(y, segment->x), segment->along) / segment->length2;
    pe_vec3 x = pe_madd(segment->x, s, segment->along), apart = pe_sub(y, x);
    double distance = pe_length(apart);
    if (s > 0 && s < 1 && distance <= f->reach && distance > f->pair->slack &&
        faces(&f->pair->b, vertex, apart, distance, ROUNDING)) {
        add_points(f, PE_EDGE_VERTEX, segment->edge, vertex, x, apart, distance);
    }
}

static void try_core(const finder *f, const pe_facet *a, const pe_facet *b)
{
    bool point = (a->owns >> 1 & 1) == 0;
    for (int j = 0; j < b->ridge_count; ++j) {
        for (int k = 0; k < 2; ++k) {
            if ((a->owns >> k & 1) != 0) {
                try_end_edge(f, a->vertices[k], a->x[k], &b->ridges[j]);
            }
        }
        if (!point) {
            try_edges(f, a->ridges, &b->ridges[j]);
        }
    }
    for (int k = 0; k < 3 && !point; ++k) {
        if ((b->owns >> k & 1) != 0) {
            try_segment_vertex(f, a->ridges, b->vertices[k], b->x[k]);
        }
    }
}

static bool try_facets(void *context, pe_facet *a, pe_facet *b)
{
    const finder *f = context;
    double above_a[3] = {0}, above_b[3];
    if (!pe_facet_heights(b, a, f->bound, above_b) ||
        (a->face >= 0 && !pe_facet_heights(a, b, f->bound, above_a))) {
        return true;
    }
    try_vertices(f, a, b, above_a, above_b);
    pe_facet_ridges(&f->pair->a, &f->pair->trees, a);
    pe_facet_ridges(&f->pair->b, NULL, b);
    if (f->pair->a.core) {
        try_core(f, a, b);
        return !f->list->failed;
    }
    for (int i = 0; i < a->ridge_count; ++i) {
        for (int j = 0; j < b->ridge_count; ++j) {
            try_edges(f, &a->ridges[i], &b->ridges[j]);
        }
    }
    return !f->list->failed;
}

void pe_touches_find(const pe_solid_pair *pair, double reach, double depth, pe_touches *list)
{
    finder f = {pair, reach, depth, pe_max(reach, depth), list};
    pe_near_facets(pair, &f.bound, try_facets, &f);
}
