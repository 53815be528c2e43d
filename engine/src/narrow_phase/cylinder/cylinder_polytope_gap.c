/* The signed distance of a polytope and a cylinder: all local maxima of the separation, as listed
 * in cylinder.h.
 *
 * Each maximum is either in closed form or the peak of one circle of directions (pe_rim_peak). If
 * the maximum over a family lies within certain directions (an edge's are between the normals of
 * its faces), only these are tested, so that every value found is the true separation along its
 * direction. */
#include "cylinder_gap.h"
#include "narrow_phase/tolerances.h"

typedef struct search {
    const pe_polytope *p;
    const pe_cylinder *c;
    const pe_gap_query *query;
    double rounding, tie; /* m */
    pe_meeting_gap best;
    double high, low; /* m: of the vertices along the axis, from the cylinder's centre */
    int high_vertex, low_vertex;
    int nearest; /* vertex nearest to the cylinder; -1: one is inside */
    double nearest_distance;
    pe_vec3 nearest_normal; /* from the vertex */
    int radial;             /* vertex nearest to the axis */
    double radial_distance;
} search;

/* The separation that another meeting must exceed to become the best. */
static double to_beat(const search *s)
{
    bool flat = s->best.kind == PE_FACE_CYLINDER || s->best.kind == PE_CORNER_CAP;
    return s->best.distance + (flat ? s->query->bias : s->rounding);
}

static void offer(search *s, double distance, pe_vec3 normal, pe_meeting kind, int index)
{
    if (distance > to_beat(s)) {
        s->best = (pe_meeting_gap){distance, normal, kind, index};
    }
}

static void test_faces(search *s)
{
    for (int i = 0; i < s->p->face_count; ++i) {
        const pe_face *face = &s->p->faces[i];
        double to_centre = pe_dot(face->normal, s->c->centre) - face->offset;
        if (to_centre > s->best.distance) {
            offer(s, to_centre - pe_cylinder_reach(s->c, face->normal), face->normal,
                  PE_FACE_CYLINDER, i);
        }
    }
}

static void test_caps(search *s)
{
    double half = s->c->half_height;
    offer(s, -s->high - half, s->c->axis, PE_CORNER_CAP, s->high_vertex);
    offer(s, s->low - half, pe_scale(-1, s->c->axis), PE_CORNER_CAP, s->low_vertex);
}

/* Finds the extreme vertices: along the axis, nearest to the cylinder, nearest to the axis. */
static void find_vertices(search *s)
{
    const pe_cylinder *c = s->c;
    double least2 = HUGE_VAL, radial2 = HUGE_VAL;
    s->high = -HUGE_VAL;
    s->low = HUGE_VAL;
    for (int i = 0; i < s->p->vertex_count; ++i) {
        pe_vec3 x = pe_sub(s->p->vertices[i], c->centre);
        double z = pe_dot(x, c->axis);
        pe_vec3 across = pe_madd(x, -z, c->axis);
        double r2 = pe_dot(across, across);
        if (z > s->high) {
            s->high = z;
            s->high_vertex = i;
        }
        if (z < s->low) {
            s->low = z;
            s->low_vertex = i;
        }
        if (r2 < radial2) {
            radial2 = r2;
            s->radial = i;
        }
        double over = fabs(z) - c->half_height;
        pe_vec3 out = over > 0 ? pe_scale(z > 0 ? over : -over, c->axis) : pe_v3(0, 0, 0);
        if (r2 > c->radius * c->radius) {
            out = pe_madd(out, 1 - c->radius / sqrt(r2), across);
        }
        double distance2 = pe_dot(out, out);
        if (distance2 < least2) {
            least2 = distance2;
            s->nearest = i;
            s->nearest_normal = pe_scale(-1, out);
        }
    }
    s->radial_distance = sqrt(radial2);
    s->nearest_distance = sqrt(least2);
}

static double separation_along(const search *s, pe_vec3 d, int last)
{
    return pe_dot(d, pe_sub(s->c->centre, s->p->vertices[last])) - pe_cylinder_reach(s->c, d);
}

/* Offers the separation along d, suggested by the vertex, unless another vertex is farther out. */
static void offer_from_vertex(search *s, pe_vec3 d, int vertex)
{
    const pe_vec3 *v = s->p->vertices;
    int last = pe_polytope_support(s->p, d, vertex);
    if (pe_dot(d, pe_sub(v[last], v[vertex])) <= s->tie) {
        offer(s, separation_along(s, d, last), d, PE_CORNER_CYLINDER, vertex);
    }
}

/* The vertex nearest to the cylinder from outside, and the vertex nearest to the axis, inside or
 * outside: if a vertex meets the cap, side or rim, it is one of these. */
static void test_vertices(search *s)
{
    if (s->nearest_distance > 0 && s->nearest_distance > to_beat(s)) {
        offer_from_vertex(s, pe_scale(1 / s->nearest_distance, s->nearest_normal), s->nearest);
    }
    if (s->radial_distance - s->c->radius > to_beat(s)) {
        double distance;
        pe_vec3 x = pe_sub(s->c->centre, s->p->vertices[s->radial]), other;
        pe_vec3 d = pe_outward(s->c->axis, x, &distance);
        if (!(distance > 0)) {
            pe_tangents(s->c->axis, &d, &other);
        }
        offer_from_vertex(s, d, s->radial);
    }
}

/* Across edge and axis, along the circle's t or against it: valid where the edge is outermost. */
static void test_edge_side(search *s, int index, const pe_rim_query *q)
{
    for (double side = -1; side < 2; side += 2) {
        bool outermost = !q->bounded || (side * q->bound[0].x >= 0 && side * q->bound[1].x <= 0);
        double distance = side * pe_dot(q->to_centre, q->t) - s->c->radius;
        if (outermost && distance > to_beat(s)) {
            double length;
            pe_vec3 d = pe_scale(side, pe_outward(s->c->axis, q->t, &length));
            offer(s, pe_dot(q->to_centre, d) - s->c->radius, d, PE_EDGE_SIDE, index);
        }
    }
}

/* Whether no direction between the edge's two face normals can be better than the best. With x the
 * cylinder's nearest point over one of the faces and v on the edge, (x - v).d bounds the separation
 * along every d. The bound is largest at one of the normals unless it grows from both. */
static bool is_edge_excluded(const search *s, const pe_face *f, const pe_face *g)
{
    double cosine = pe_dot(f->normal, g->normal);
    pe_vec3 x = pe_cylinder_support(s->c, pe_scale(-1, f->normal));
    double over_f = pe_dot(f->normal, x) - f->offset, over_g = pe_dot(g->normal, x) - g->offset;
    bool grows = over_g > over_f * cosine && over_f > over_g * cosine;
    return (over_f < 0 && over_g < 0) || !grows ? pe_max(over_f, over_g) <= to_beat(s) : false;
}

static void test_edge(search *s, int index)
{
    const pe_polytope *p = s->p;
    const pe_edge *edge = &p->edges[index];
    if (edge->face[0] >= 0) {
        const pe_face *f = &p->faces[edge->face[0]], *g = &p->faces[edge->face[1]];
        if (is_edge_excluded(s, f, g) || is_edge_excluded(s, g, f)) {
            return;
        }
    }
    pe_vec3 v = p->vertices[edge->vertex[0]];
    pe_vec3 e = pe_sub(p->vertices[edge->vertex[1]], v);
    e = pe_scale(1 / pe_length(e), e);
    pe_rim_query q;
    if (!pe_rim_query_make(s->c, e, pe_sub(s->c->centre, v), &q)) {
        return; /* its vertices are as near to the side */
    }
    q.bounded = edge->face[0] >= 0;
    for (int k = 0; k < 2 && q.bounded; ++k) {
        pe_vec3 n = p->faces[edge->face[k]].normal;
        q.bound[k] = (pe_turn){pe_dot(n, q.u), pe_dot(n, q.t)};
    }
    test_edge_side(s, index, &q);
    for (double side = -1; side < 2; side += 2) {
        pe_vec3 d;
        double value;
        if (pe_rim_peak(&q, side, to_beat(s), &d, &value)) {
            offer(s, value, d, PE_EDGE_RIM, index);
        }
    }
}

double pe_cylinder_edge_place(const pe_polytope *p, const pe_cylinder *c, const pe_meeting_gap *gap)
{
    const pe_edge *edge = &p->edges[gap->index];
    pe_vec3 v = p->vertices[edge->vertex[0]];
    pe_vec3 step = pe_sub(p->vertices[edge->vertex[1]], v), to, along = step;
    if (gap->kind == PE_EDGE_SIDE) {
        to = c->centre; /* the axis */
        along = pe_across(c->axis, step);
    } else {
        pe_vec3 rim = pe_cylinder_support(c, pe_scale(-1, gap->normal));
        to = pe_madd(rim, -gap->distance, gap->normal);
    }
    double square = pe_dot(along, along);
    double place = square > 0 ? pe_dot(pe_sub(to, v), along) / square : 0.5;
    return pe_max(0, pe_min(1, place));
}

/* Makes the direction exact. Near the transition from one meeting to another both are equally good
 * to rounding, with directions that are only as exact as the root of that. For shapes that are
 * apart, the cylinder's nearest point to the edge's place, or to the vertex, gives all digits. */
static void refine(search *s)
{
    pe_meeting_gap *best = &s->best;
    bool at_edge = best->kind == PE_EDGE_SIDE || best->kind == PE_EDGE_RIM;
    if (best->distance < PE_NEAREST_POINT_GAP * s->query->size ||
        !(at_edge || best->kind == PE_CORNER_CYLINDER)) {
        return;
    }
    const pe_vec3 *v = s->p->vertices;
    pe_vec3 x;
    if (at_edge) {
        const int *vertex = s->p->edges[best->index].vertex;
        x = pe_madd(v[vertex[0]], pe_cylinder_edge_place(s->p, s->c, best),
                    pe_sub(v[vertex[1]], v[vertex[0]]));
    } else {
        x = v[best->index];
    }
    pe_vec3 between = pe_sub(pe_cylinder_nearest(s->c, x), x);
    pe_vec3 d = pe_scale(1 / pe_length(between), between);
    int last = pe_polytope_support(s->p, d, -1);
    if (separation_along(s, d, last) > best->distance - 0.1 * s->tie) {
        best->normal = d;
    }
}

bool pe_cylinder_polytope_gap(const pe_polytope *p, const pe_cylinder *c, const pe_gap_query *query,
                              pe_meeting_gap *gap)
{
    double limit = query->limit;
    search s = {.p = p,
                .c = c,
                .query = query,
                .rounding = PE_MAXIMUM_ROUNDING * query->size,
                .tie = PE_SUPPORT_TIE * query->size,
                .best = {.distance = -HUGE_VAL}};
    find_vertices(&s);
    if (query->face_first) {
        test_faces(&s);
        test_caps(&s);
    } else {
        test_caps(&s);
        test_faces(&s);
    }
    if (s.best.distance <= limit) {
        test_vertices(&s);
    }
    for (int i = 0; i < p->edge_count && s.best.distance <= limit; ++i) {
        test_edge(&s, i);
    }
    if (s.best.distance <= limit) {
        refine(&s);
    }
    *gap = s.best;
    return s.best.distance <= limit;
}
