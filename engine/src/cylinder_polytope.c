/* All local maxima of the separation, as named in cylinder.h. Each is either in closed form or the
 * peak of one circle (pe_circle_peak); where the maximum over a family cannot lie outside certain
 * directions (an edge's are between the normals of its faces) these alone are looked at, so that
 * every value that is found is the true separation along its direction. */
#include "cylinder_polytope.h"

/* In units of the smaller shape. */
static const double BIAS = 4e-10;

typedef struct search {
    const pe_polytope *p;
    const pe_cylinder *c;
    double bias;
    pe_meeting_gap best;
    double high, low; /* m: of the vertices along the axis, from the cylinder's centre */
    int high_vertex, low_vertex;
    int nearest;      /* vertex nearest to the cylinder; -1: one is inside */
    double nearest_distance;
    pe_vec3 nearest_normal; /* from the vertex */
    int radial;             /* vertex nearest to the axis */
    double radial_distance;
} search;

static void offer(search *s, double distance, pe_vec3 normal, pe_meeting kind, int index)
{
    if (distance > s->best.distance + s->bias) {
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

static void look_at_vertices(search *s)
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

/* The true separation along d, which the vertex suggested. */
static void offer_from_vertex(search *s, pe_vec3 d, int vertex)
{
    int last = pe_polytope_support(s->p, d, vertex);
    double distance = pe_dot(d, pe_sub(s->c->centre, s->p->vertices[last])) -
                      pe_cylinder_reach(s->c, d);
    offer(s, distance, d, PE_CORNER_CYLINDER, last);
}

/* The corner nearest to the cylinder from outside, and that nearest to the axis, whether in or out:
 * if a corner meets the cap, side or rim at all, it is one of these. */
static void test_vertices(search *s)
{
    double enough = s->best.distance + s->bias;
    if (s->nearest_distance > 0 && s->nearest_distance > enough) {
        offer_from_vertex(s, pe_scale(1 / s->nearest_distance, s->nearest_normal), s->nearest);
    }
    if (s->radial_distance > 0 && s->radial_distance - s->c->radius > enough) {
        double distance;
        pe_vec3 x = pe_sub(s->c->centre, s->p->vertices[s->radial]);
        offer_from_vertex(s, pe_cylinder_outward(s->c, x, &distance), s->radial);
    }
}

/* Across edge and axis, along the circle's t or against it: where the edge is outermost. */
static void test_edge_side(search *s, int index, const pe_circle *circle, pe_vec3 w,
                           const pe_turn *from, const pe_turn *to)
{
    for (double side = -1; side < 2; side += 2) {
        bool outermost = from == NULL || (side * from->x >= 0 && side * to->x <= 0);
        double distance = side * pe_dot(w, circle->t) - s->c->radius;
        if (outermost && distance > s->best.distance + s->bias) {
            double length;
            pe_vec3 d = pe_scale(side, pe_cylinder_outward(s->c, circle->t, &length));
            offer(s, pe_dot(w, d) - s->c->radius, d, PE_EDGE_SIDE, index);
        }
    }
}

static void test_edge(search *s, int index)
{
    const pe_polytope *p = s->p;
    const pe_edge *edge = &p->edges[index];
    pe_vec3 v = p->vertices[edge->vertex[0]];
    pe_vec3 e = pe_sub(p->vertices[edge->vertex[1]], v);
    e = pe_scale(1 / pe_length(e), e);
    pe_circle circle;
    if (!pe_circle_make(s->c, e, &circle)) {
        return; /* its corners are as near to the side */
    }
    pe_vec3 w = pe_sub(s->c->centre, v);
    pe_turn turn[2];
    const pe_turn *from = NULL, *to = NULL;
    if (edge->face[0] >= 0) {
        for (int k = 0; k < 2; ++k) {
            pe_vec3 n = p->faces[edge->face[k]].normal;
            turn[k] = (pe_turn){pe_dot(n, circle.u), pe_dot(n, circle.t)};
        }
        from = &turn[0];
        to = &turn[1];
    }
    test_edge_side(s, index, &circle, w, from, to);
    for (double side = -1; side < 2; side += 2) {
        pe_vec3 d;
        double value;
        if (pe_circle_peak(&circle, s->c, w, side, from, to, s->best.distance + s->bias, &d,
                           &value)) {
            offer(s, value, d, PE_EDGE_RIM, index);
        }
    }
}

bool pe_cylinder_polytope_gap(const pe_polytope *p, const pe_cylinder *c, double size,
                              bool face_first, double limit, pe_meeting_gap *gap)
{
    search s = {.p = p, .c = c, .bias = BIAS * size, .best = {.distance = -HUGE_VAL}};
    look_at_vertices(&s);
    if (face_first) {
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
    *gap = s.best;
    return s.best.distance <= limit;
}
