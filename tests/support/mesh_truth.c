/* Distances of triangles, segments and points, each pair by itself. */
#include "mesh_truth.h"

#include "segment_distance.h"
#include "solid_forms.h"

typedef struct triangle {
    pe_vec3 v[3], normal, centre;
    double radius; /* about the centre */
} triangle;

typedef struct soup {
    int count;
    triangle item[FORM_TRIANGLES];
} soup;

static pe_vec3 normal_of(const triangle *t)
{
    pe_vec3 n = pe_cross(pe_sub(t->v[1], t->v[0]), pe_sub(t->v[2], t->v[0]));
    return pe_scale(1 / pe_length(n), n);
}

static void take_triangles(const placed *p, soup *s)
{
    s->count = p->solid->triangle_count;
    for (int i = 0; i < s->count; ++i) {
        triangle *t = &s->item[i];
        for (int k = 0; k < 3; ++k) {
            pe_vec3 local = p->solid->vertices[p->solid->triangles[i][k]];
            t->v[k] = pe_add(p->pose.position, pe_rotate(&p->pose.rotation, local));
        }
        t->centre = pe_scale(1.0 / 3, pe_add(t->v[0], pe_add(t->v[1], t->v[2])));
        t->normal = normal_of(t);
        t->radius = 0;
        for (int k = 0; k < 3; ++k) {
            t->radius = pe_max(t->radius, pe_length(pe_sub(t->v[k], t->centre)));
        }
    }
}

/* Whether the foot of x on the plane is within the triangle. */
static bool is_over(const triangle *t, pe_vec3 x)
{
    for (int k = 0; k < 3; ++k) {
        pe_vec3 side = pe_sub(t->v[(k + 1) % 3], t->v[k]);
        if (pe_dot(t->normal, pe_cross(side, pe_sub(x, t->v[k]))) < 0) {
            return false;
        }
    }
    return true;
}

static double clamp(double x)
{
    return pe_min(1, pe_max(0, x));
}

static double point_triangle(pe_vec3 x, const triangle *t)
{
    if (is_over(t, x)) {
        return fabs(pe_dot(t->normal, pe_sub(x, t->v[0])));
    }
    double least = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        least = pe_min(least, point_to_segment(x, t->v[k], t->v[(k + 1) % 3]));
    }
    return least;
}

/* Between the ends, or where the common normal of the lines meets both within. Of lines that are
 * nearly parallel this normal is uncertain, but not how far the points that it meets are apart. */
static double segment_segment(pe_vec3 p, pe_vec3 q, pe_vec3 r, pe_vec3 s)
{
    double least = ends_to_segments(p, q, r, s);
    pe_vec3 u = pe_sub(q, p), v = pe_sub(s, r), w = pe_sub(r, p), n = pe_cross(u, v);
    double n2 = pe_dot(n, n);
    if (n2 > 0) {
        double t = clamp(pe_dot(pe_cross(w, v), n) / n2);
        least = pe_min(least, point_to_segment(pe_madd(p, t, u), r, s));
    }
    return least;
}

/* Whether the segment goes through the triangle. */
static bool pierces(pe_vec3 p, pe_vec3 q, const triangle *t)
{
    pe_vec3 n = t->normal;
    double high = pe_dot(n, pe_sub(p, t->v[0])), low = pe_dot(n, pe_sub(q, t->v[0]));
    return high * low < 0 && is_over(t, pe_madd(p, high / (high - low), pe_sub(q, p)));
}

static double segment_triangle(pe_vec3 p, pe_vec3 q, const triangle *t)
{
    if (pierces(p, q, t)) {
        return 0;
    }
    double least = pe_min(point_triangle(p, t), point_triangle(q, t));
    for (int k = 0; k < 3; ++k) {
        least = pe_min(least, segment_segment(p, q, t->v[k], t->v[(k + 1) % 3]));
    }
    return least;
}

static double triangle_triangle(const triangle *t, const triangle *o)
{
    double least = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        least = pe_min(least, segment_triangle(t->v[k], t->v[(k + 1) % 3], o));
        least = pe_min(least, point_triangle(o->v[k], t));
        if (pierces(o->v[k], o->v[(k + 1) % 3], t)) {
            return 0;
        }
    }
    return least;
}

static double to_surfaces(const soup *a, const soup *b)
{
    /* The centres lie on the surfaces: triangles farther by both radii need not be tested. */
    double least = HUGE_VAL;
    for (int i = 0; i < a->count * b->count; ++i) {
        pe_vec3 d = pe_sub(b->item[i % b->count].centre, a->item[i / b->count].centre);
        least = pe_min(least, pe_dot(d, d));
    }
    least = sqrt(least);
    for (int i = 0; i < a->count && least > 0; ++i) {
        const triangle *t = &a->item[i];
        for (int j = 0; j < b->count; ++j) {
            const triangle *o = &b->item[j];
            double reach = t->radius + o->radius + least;
            pe_vec3 d = pe_sub(o->centre, t->centre);
            if (pe_dot(d, d) <= reach * reach) {
                least = pe_min(least, triangle_triangle(t, o));
            }
        }
    }
    return least;
}

static mesh_interval exactly(double distance)
{
    return (mesh_interval){distance, distance};
}

/* A cylinder lies within the capsule of its axis and radius: a triangle farther from that than the
 * nearest so far needs no search. */
static mesh_interval cylinder_triangle(const placed *a, pe_vec3 p, pe_vec3 q, const triangle *t,
                                       mesh_interval least)
{
    if (segment_triangle(p, q, t) - a->shape.radius >= least.high) {
        return least;
    }
    static const pe_shape hull = {.kind = PE_SHAPE_HULL};
    const pe_pose at = {{0, 0, 0}, {1, 0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    truth_difference m = truth_subtract((truth_solid){&a->shape, NULL, 0, &a->pose},
                                        (truth_solid){&hull, t->v, 3, &at});
    truth_distance d = truth_signed_distance(&m, 1e-12 * a->solid->size);
    return (mesh_interval){pe_min(least.low, pe_max(0, d.low)),
                           pe_min(least.high, pe_max(0, d.high))};
}

/* Of a sphere, a capsule or a cylinder. */
static mesh_interval round_distance(const placed *a, const soup *b)
{
    pe_vec3 half = pe_scale(a->shape.kind == PE_SHAPE_SPHERE ? 0 : a->shape.half_height,
                            pe_axis(&a->pose.rotation, 2));
    pe_vec3 p = pe_sub(a->pose.position, half), q = pe_add(a->pose.position, half);
    mesh_interval least = exactly(HUGE_VAL);
    for (int i = 0; i < b->count; ++i) {
        const triangle *t = &b->item[i];
        if (a->shape.kind == PE_SHAPE_CYLINDER) {
            least = cylinder_triangle(a, p, q, t, least);
        } else {
            double d =
                a->shape.kind == PE_SHAPE_SPHERE ? point_triangle(p, t) : segment_triangle(p, q, t);
            least = exactly(pe_min(least.low, pe_max(0, d - a->shape.radius)));
        }
    }
    return least;
}

mesh_interval mesh_distance(const pair *p)
{
    soup a, b;
    take_triangles(&p->b, &b);
    if (p->a.shape.kind == PE_SHAPE_PLANE) {
        double least = HUGE_VAL;
        for (int i = 0; i < 3 * b.count; ++i) {
            pe_vec3 above = pe_sub(b.item[i / 3].v[i % 3], p->a.pose.position);
            least = pe_min(least, pe_dot(p->a.shape.normal, above));
        }
        return exactly(pe_max(0, least));
    }
    if (p->a.solid->triangle_count == 0) {
        return is_in_polyhedron(&p->b, p->a.pose.position) ? exactly(0) : round_distance(&p->a, &b);
    }
    take_triangles(&p->a, &a);
    if (is_in_polyhedron(&p->b, a.item[0].v[0]) || is_in_polyhedron(&p->a, b.item[0].v[0])) {
        return exactly(0);
    }
    return exactly(to_surfaces(&a, &b));
}

double surface_distance(const placed *p, pe_vec3 x)
{
    soup s;
    take_triangles(p, &s);
    double least = HUGE_VAL;
    for (int i = 0; i < s.count; ++i) {
        least = pe_min(least, point_triangle(x, &s.item[i]));
    }
    return least;
}

bool is_in_polyhedron(const placed *p, pe_vec3 x)
{
    pe_vec3 local = pe_unrotate(&p->pose.rotation, pe_sub(x, p->pose.position));
    double angle = 0;
    for (int i = 0; i < p->solid->triangle_count; ++i) {
        const int *t = p->solid->triangles[i];
        pe_vec3 a = pe_sub(p->solid->vertices[t[0]], local);
        pe_vec3 b = pe_sub(p->solid->vertices[t[1]], local);
        pe_vec3 c = pe_sub(p->solid->vertices[t[2]], local);
        double la = pe_length(a), lb = pe_length(b), lc = pe_length(c);
        double below = la * lb * lc + pe_dot(a, b) * lc + pe_dot(b, c) * la + pe_dot(c, a) * lb;
        angle += 2 * atan2(pe_dot(a, pe_cross(b, c)), below);
    }
    return angle > 6.283185307179586; /* half of the full 4 pi */
}
