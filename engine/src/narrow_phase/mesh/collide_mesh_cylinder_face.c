/* A cylinder over a face of a mesh, triangle by triangle, along the face's normal. A cap that lies
 * along the face, nearly, has four points of its rim in directions that stay with the mesh, for the
 * cap may spin under them; its lowest point; the face's corners below it, and where the face's
 * edges cross its rim. Of a side these are the ends of its lowest line over the face. Else the
 * cylinder's lowest point is all. */
#include "collide_mesh_cylinder.h"

/* Most cosine between a face's normal and the axis of a cylinder whose side lies along it, nearly.
 */
static const double SIDE_ON_FACE = 3e-3;
/* In units of the smaller shape: a cap tilted by less, from end to end, has no lowest point. */
static const double LEVEL = 6e-9;
/* In units of the smaller shape: an edge that is less far inside the rim crosses it nowhere. */
static const double TANGENT = 1e-6;

typedef struct view {
    const pe_cylinder *c;
    const pe_solid *mesh;
    const pe_facet *f;
    double size, low, high, slack;
    pe_touches *list;
} view;

pe_touch pe_cylinder_touch(const pe_facet *f, int point, pe_vec3 on_a, double height)
{
    return (pe_touch){
        .feature = pe_touch_feature(PE_VERTEX_FACE, point, f->face),
        .kind = PE_VERTEX_FACE,
        .normal = pe_scale(-1, f->normal),
        .on_a = on_a,
        .separation = height,
        .strict = true,
    };
}

/* Adds a point of the cylinder that is over the triangle. */
static void add(const view *v, int point, pe_vec3 x)
{
    double height = pe_dot(v->f->normal, x) - v->f->offset;
    if (height >= v->low && height <= v->high) {
        pe_touch touch = pe_cylinder_touch(v->f, point, x, height);
        pe_touches_add(v->list, &touch);
    }
}

static void try_point(const view *v, int point, pe_vec3 x)
{
    if (pe_facet_holds(v->f, x, v->slack)) {
        add(v, point, x);
    }
}

static bool is_corner(const pe_solid *mesh, int vertex)
{
    return mesh->vertex_first[vertex + 1] > mesh->vertex_first[vertex];
}

/* Where the edge from p to q, seen from the cap's middle in its plane, crosses the rim. */
static void add_crossings(const view *v, int edge, pe_vec3 middle, pe_vec3 p, pe_vec3 q)
{
    double r = v->c->radius;
    pe_vec3 step = pe_sub(q, p);
    double length2 = pe_dot(step, step), along = -pe_dot(p, step);
    double inside = r - pe_length(pe_madd(p, along / length2, step));
    if (!(inside > TANGENT * v->size)) {
        return;
    }
    double reach = sqrt((2 * r - inside) * inside * length2);
    double in = (along - reach) / length2, out = (along + reach) / length2;
    if (in > 0 && in < 1) {
        add(v, pe_cylinder_point_of(PE_AT_ENTRY, edge), pe_add(middle, pe_madd(p, in, step)));
    }
    if (out > 0 && out < 1) {
        add(v, pe_cylinder_point_of(PE_AT_EXIT, edge), pe_add(middle, pe_madd(p, out, step)));
    }
}

static void add_cap(const view *v, double rise)
{
    const pe_cylinder *c = v->c;
    const pe_facet *f = v->f;
    pe_vec3 middle = pe_madd(c->centre, rise > 0 ? -c->half_height : c->half_height, c->axis);
    pe_vec3 t1, t2, at[3];
    double unused, sine;
    pe_tangents(f->normal, &t1, &t2);
    t1 = pe_scale(c->radius, pe_outward(c->axis, t1, &unused));
    t2 = pe_cross(c->axis, t1);
    try_point(v, PE_AT_RIM, pe_add(middle, t1));
    try_point(v, PE_AT_RIM + 1, pe_add(middle, t2));
    try_point(v, PE_AT_RIM + 2, pe_sub(middle, t1));
    try_point(v, PE_AT_RIM + 3, pe_sub(middle, t2));
    pe_vec3 up = pe_outward(c->axis, f->normal, &sine);
    if (2 * c->radius * sine > LEVEL * v->size) {
        try_point(v, PE_AT_LOWEST, pe_madd(middle, -c->radius, up));
    }
    for (int k = 0; k < 3; ++k) {
        pe_vec3 from = pe_sub(f->x[k], middle);
        at[k] = pe_madd(from, -pe_dot(from, c->axis) / rise, f->normal);
        bool below = pe_dot(at[k], at[k]) <= c->radius * c->radius;
        if (below && is_corner(v->mesh, f->vertices[k])) {
            add(v, pe_cylinder_point_of(PE_AT_CORNER, f->vertices[k]), pe_add(middle, at[k]));
        }
    }
    for (int k = 0; k < 3; ++k) {
        if (f->edges[k] >= 0) {
            add_crossings(v, f->edges[k], middle, at[k], at[k < 2 ? k + 1 : 0]);
        }
    }
}

/* The part of the line x + z axis over the triangle is from end[0] to end[1], bounded by the edges
 * bound[]; -1: none. An edge that the whole line keeps inside, or beside by the slack, is none. */
static void clip(const view *v, pe_vec3 x, double end[2], int bound[2])
{
    const pe_facet *f = v->f;
    double half = v->c->half_height;
    end[0] = -half;
    end[1] = half;
    bound[0] = bound[1] = -1;
    for (int k = 0; k < 3; ++k) {
        pe_vec3 u = pe_sub(f->x[k < 2 ? k + 1 : 0], f->x[k]), inward = pe_cross(f->normal, u);
        double length = pe_length(u), depth = pe_dot(pe_sub(x, f->x[k]), inward);
        double climb = pe_dot(v->c->axis, inward);
        if (depth - half * fabs(climb) >= -v->slack * length) {
            continue;
        }
        int side = climb < 0;
        double at = climb != 0 ? -depth / climb : HUGE_VAL;
        if (side == 0 ? at > end[0] : at < end[1]) {
            end[side] = at;
            bound[side] = k;
        }
    }
}

static void add_line(const view *v)
{
    const pe_cylinder *c = v->c;
    double unused, end[2];
    int bound[2];
    pe_vec3 x = pe_madd(c->centre, -c->radius, pe_outward(c->axis, v->f->normal, &unused));
    clip(v, x, end, bound);
    for (int k = 0; k < 2 && end[0] <= end[1]; ++k) {
        int edge = bound[k] >= 0 ? v->f->edges[bound[k]] : -1;
        if (bound[k] < 0 || edge >= 0) {
            add(v,
                bound[k] < 0 ? PE_AT_LINE_END + k
                             : pe_cylinder_point_of(k == 0 ? PE_AT_ENTRY : PE_AT_EXIT, edge),
                pe_madd(x, end[k], c->axis));
        }
    }
}

void pe_cylinder_touches_on_facet(const pe_cylinder *c, const pe_solid *mesh, const pe_facet *f,
                                  double size, double low, double high, pe_touches *list)
{
    view v = {c, mesh, f, size, low, high, PE_SLACK * size, list};
    double rise = pe_dot(c->axis, f->normal);
    if (fabs(rise) >= PE_CAP_ON_FACE) {
        add_cap(&v, rise);
    } else if (fabs(rise) <= SIDE_ON_FACE) {
        add_line(&v);
    } else {
        try_point(&v, PE_AT_LOWEST, pe_cylinder_support(c, pe_scale(-1, f->normal)));
    }
}

/* Cuts the polygon off where height[] is above 0; it may gain one corner. */
static int cut(pe_vec3 *polygon, const double *height, int count)
{
    enum { ROOM = 6 };
    pe_vec3 kept[ROOM];
    int kept_count = 0;
    for (int i = 0; i < count; ++i) {
        int next = i + 1 < count ? i + 1 : 0;
        double p = height[i], q = height[next];
        if (p <= 0 && kept_count < ROOM) {
            kept[kept_count++] = polygon[i];
        }
        if ((p > 0) != (q > 0) && kept_count < ROOM) {
            kept[kept_count++] =
                pe_madd(polygon[i], p / (p - q), pe_sub(polygon[next], polygon[i]));
        }
    }
    for (int i = 0; i < kept_count; ++i) {
        polygon[i] = kept[i];
    }
    return kept_count;
}

/* Where the axis meets the polygon's plane, if inside it. */
static bool meets_axis(const pe_cylinder *c, const pe_facet *f, const pe_vec3 *polygon, int count,
                       pe_vec3 *x)
{
    double rise = pe_dot(f->normal, c->axis);
    if (fabs(rise) < 1e-9) {
        return false;
    }
    double height = pe_dot(f->normal, c->centre) - f->offset;
    *x = pe_madd(c->centre, -height / rise, c->axis);
    for (int i = 0; i < count; ++i) {
        pe_vec3 u = pe_sub(polygon[i + 1 < count ? i + 1 : 0], polygon[i]);
        if (pe_dot(pe_cross(f->normal, u), pe_sub(*x, polygon[i])) < 0) {
            return false;
        }
    }
    return true;
}

bool pe_cylinder_facet_point(const pe_cylinder *c, const pe_facet *f, pe_vec3 *x)
{
    pe_vec3 polygon[6] = {f->x[0], f->x[1], f->x[2]};
    double height[6];
    int count = 3;
    for (double side = -1; side < 2; side += 2) {
        for (int i = 0; i < count; ++i) {
            height[i] = side * pe_dot(c->axis, pe_sub(polygon[i], c->centre)) - c->half_height;
        }
        count = cut(polygon, height, count);
    }
    if (count >= 3 && meets_axis(c, f, polygon, count, x)) {
        return true;
    }
    double least = HUGE_VAL;
    for (int i = 0; i < count; ++i) {
        pe_vec3 step = pe_sub(polygon[i + 1 < count ? i + 1 : 0], polygon[i]);
        pe_vec3 p = pe_across(c->axis, pe_sub(polygon[i], c->centre));
        pe_vec3 u = pe_across(c->axis, step);
        double square = pe_dot(u, u), t = square > 0 ? -pe_dot(p, u) / square : 0;
        t = pe_max(0, pe_min(1, t));
        pe_vec3 across = pe_madd(p, t, u);
        double distance2 = pe_dot(across, across);
        if (distance2 < least) {
            least = distance2;
            *x = pe_madd(polygon[i], t, step);
        }
    }
    return least <= c->radius * c->radius;
}

double pe_cylinder_translation(const pe_cylinder *c, pe_vec3 x, pe_vec3 n)
{
    pe_vec3 from = pe_sub(x, c->centre), p = pe_across(c->axis, from), e = pe_across(c->axis, n);
    double rise = pe_dot(n, c->axis), z = pe_dot(from, c->axis);
    double a = pe_dot(e, e), b = pe_dot(p, e), d = c->radius * c->radius - pe_dot(p, p);
    double side = a > 0 ? (sqrt(pe_max(0, b * b + a * d)) - b) / a : HUGE_VAL;
    double cap = rise != 0 ? (c->half_height - (rise < 0 ? -z : z)) / fabs(rise) : HUGE_VAL;
    return pe_max(0, pe_min(side, cap));
}
