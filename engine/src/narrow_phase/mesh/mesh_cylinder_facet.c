/* A cylinder and a triangle of a mesh: its touches along the face's normal, its manifold as of two
 * convex shapes, and the feature of the mesh that a direction belongs to.
 *
 * Along a face's normal: a cap that lies nearly flat on the face has four points of its rim in
 * directions that stay with the mesh, for the cap may spin; its lowest point; the face's corners
 * below it; and the points where the face's edges cross its rim. A side has the ends of its lowest
 * line over the face. Otherwise the cylinder's lowest point is the only one. */
#include "mesh_cylinder_facet.h"

#include "narrow_phase/cylinder/cylinder_gap.h"
#include "narrow_phase/tolerances.h"

/* ---- Touches along the face's normal ---- */

typedef struct view {
    const pe_cylinder *c;
    const pe_solid *mesh;
    const pe_facet *f;
    double size, low, high, slack; /* m */
    pe_touches *list;
} view;

pe_touch pe_cylinder_touch(const pe_facet *f, int point, pe_vec3 on_a, double height)
{
    pe_touch touch = pe_touch_on_face(PE_VERTEX_FACE, point, on_a, f, height);
    touch.strict = true;
    return touch;
}

/* The id of a point that an edge or a vertex bounds. */
static int bounded_point(pe_rim_point point, int index)
{
    return (int)point + 4 * index;
}

/* Adds a point of the cylinder if its height is in range. */
static void add(const view *v, int point, pe_vec3 x)
{
    double height = pe_dot(v->f->normal, x) - v->f->offset;
    if (height >= v->low && height <= v->high) {
        pe_touch touch = pe_cylinder_touch(v->f, point, x, height);
        pe_touches_add(v->list, &touch);
    }
}

/* Adds a point of the cylinder if it is over the triangle. */
static void try_point(const view *v, int point, pe_vec3 x)
{
    if (pe_facet_contains(v->f, x, v->slack)) {
        add(v, point, x);
    }
}

/* Adds the points where the edge from p to q, seen from the cap's centre in its plane, crosses the
 * rim. */
static void add_crossings(const view *v, int edge, pe_vec3 middle, pe_vec3 p, pe_vec3 q)
{
    double r = v->c->radius;
    pe_vec3 step = pe_sub(q, p);
    double length2 = pe_dot(step, step), along = -pe_dot(p, step);
    double inside = r - pe_length(pe_madd(p, along / length2, step));
    if (!(inside > PE_TANGENT_EDGE * v->size)) {
        return;
    }
    double reach = sqrt((2 * r - inside) * inside * length2);
    double in = (along - reach) / length2, out = (along + reach) / length2;
    if (in > 0 && in < 1) {
        add(v, bounded_point(PE_AT_ENTRY, edge), pe_add(middle, pe_madd(p, in, step)));
    }
    if (out > 0 && out < 1) {
        add(v, bounded_point(PE_AT_EXIT, edge), pe_add(middle, pe_madd(p, out, step)));
    }
}

/* Adds the points of a cap. `rise`: axis . normal. */
static void add_cap(const view *v, double rise)
{
    const pe_cylinder *c = v->c;
    const pe_facet *f = v->f;
    pe_vec3 middle = pe_madd(c->centre, rise > 0 ? -c->half_height : c->half_height, c->axis);
    pe_vec3 t1, t2, arm[4], at[3];
    const int *first = v->mesh->vertex_first;
    double sine;
    pe_tangents(f->normal, &t1, &t2);
    pe_cylinder_rim(c, t1, arm);
    for (int k = 0; k < 4; ++k) {
        try_point(v, PE_AT_RIM + k, pe_add(middle, arm[k]));
    }
    pe_vec3 up = pe_outward(c->axis, f->normal, &sine);
    if (2 * c->radius * sine > PE_LEVEL_CAP * v->size) {
        try_point(v, PE_AT_LOWEST, pe_madd(middle, -c->radius, up));
    }
    for (int k = 0; k < 3; ++k) {
        pe_vec3 from = pe_sub(f->x[k], middle);
        at[k] = pe_madd(from, -pe_dot(from, c->axis) / rise, f->normal);
        bool below = pe_dot(at[k], at[k]) <= c->radius * c->radius;
        /* A vertex without edges is not a corner. */
        if (below && first[f->vertices[k] + 1] > first[f->vertices[k]]) {
            add(v, bounded_point(PE_AT_CORNER, f->vertices[k]), pe_add(middle, at[k]));
        }
    }
    for (int k = 0; k < 3; ++k) {
        if (f->edges[k] >= 0) {
            add_crossings(v, f->edges[k], middle, at[k], at[k < 2 ? k + 1 : 0]);
        }
    }
}

/* The part of the line x + z axis over the triangle, from end[0] to end[1], and the edges that
 * bound it; -1: none. An edge does not count if the whole line lies inside it, or outside by the
 * slack. */
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

/* Adds the ends of the side's lowest line over the triangle. */
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
                             : bounded_point(k == 0 ? PE_AT_ENTRY : PE_AT_EXIT, edge),
                pe_madd(x, end[k], c->axis));
        }
    }
}

void pe_cylinder_touches_on_facet(const pe_cylinder_mesh *pair, const pe_facet *f, double low,
                                  double high, pe_touches *list)
{
    const pe_cylinder *c = &pair->c;
    view v = {c, &pair->solid, f, pair->size, low, high, PE_MESH_SLACK * pair->size, list};
    double rise = pe_dot(c->axis, f->normal);
    if (fabs(rise) >= PE_FACE_ALONG_CAP) {
        add_cap(&v, rise);
    } else if (fabs(rise) <= PE_SIDE_ON_FACE) {
        add_line(&v);
    } else {
        try_point(&v, PE_AT_LOWEST, pe_cylinder_support(c, pe_scale(-1, f->normal)));
    }
}

/* ---- Points of the triangle in the cylinder ---- */

/* Cuts off the part of the polygon where height[] is above 0. It may gain one corner. */
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

/* The point where the axis meets the polygon's plane. False: it is not in the polygon. */
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

double pe_cylinder_exit(const pe_cylinder *c, pe_vec3 x, pe_vec3 n)
{
    pe_vec3 from = pe_sub(x, c->centre), p = pe_across(c->axis, from), e = pe_across(c->axis, n);
    double rise = pe_dot(n, c->axis), z = pe_dot(from, c->axis);
    double a = pe_dot(e, e), b = pe_dot(p, e), d = c->radius * c->radius - pe_dot(p, p);
    double side = a > 0 ? (sqrt(pe_max(0, b * b + a * d)) - b) / a : HUGE_VAL;
    double cap = rise != 0 ? (c->half_height - (rise < 0 ? -z : z)) / fabs(rise) : HUGE_VAL;
    return pe_max(0, pe_min(side, cap));
}

/* ---- The triangle as a convex shape ---- */

/* The triangle as a hull without thickness: two faces back to back, and three without width between
 * them, so that every edge has the normals between which it is outermost. */
static const int CORNERS[12] = {0, 1, 2, 0, 2, 1, 0, 1, 1, 2, 2, 0},
                 VERTEX_FIRST[4] = {0, 4, 8, 12};
static const int VERTEX_EDGES[12] = {0, 1, 4, 5, 0, 1, 2, 3, 2, 3, 4, 5};
static const pe_edge EDGES[6] = {
    {{0, 1}, {0, 2}, true}, {{0, 1}, {2, 1}, true}, {{1, 2}, {0, 3}, true},
    {{1, 2}, {3, 1}, true}, {{2, 0}, {0, 4}, true}, {{2, 0}, {4, 1}, true},
};

/* The hull, in axes about its centre. */
static void make_hull(const pe_facet *f, pe_vec3 centre, pe_polytope *p)
{
    *p = (pe_polytope){
        .vertex_count = 3,
        .edge_count = 6,
        .face_count = 5,
        .vertices = p->own_vertices,
        .edges = EDGES,
        .faces = p->own_faces,
        .corners = CORNERS,
        .vertex_first = VERTEX_FIRST,
        .vertex_edges = VERTEX_EDGES,
    };
    pe_face *faces = p->own_faces;
    faces[0] = (pe_face){.normal = f->normal, .corner_count = 3};
    faces[1] = (pe_face){.normal = pe_scale(-1, f->normal), .first_corner = 3, .corner_count = 3};
    for (int k = 0; k < 3; ++k) {
        p->own_vertices[k] = pe_sub(f->x[k], centre);
        pe_vec3 out = pe_cross(pe_sub(f->x[k < 2 ? k + 1 : 0], f->x[k]), f->normal);
        out = pe_scale(1 / pe_length(out), out);
        faces[2 + k] = (pe_face){.normal = out,
                                 .offset = pe_dot(out, p->own_vertices[k]),
                                 .first_corner = 6 + 2 * k,
                                 .corner_count = 2};
    }
}

void pe_collide_cylinder_facet(const pe_cylinder_mesh *pair, const pe_facet *f, double margin,
                               pe_pair_manifold *manifold)
{
    pe_vec3 centre = pe_scale(1.0 / 3, pe_add(f->x[0], pe_add(f->x[1], f->x[2])));
    pe_pose pose = *pair->mesh.pose;
    pose.position = pe_pose_to_world(pair->mesh.pose, centre);
    pe_polytope hull;
    make_hull(f, centre, &hull);
    pe_pair_manifold_clear(manifold);
    pe_cylinder_polytope_contact(&hull, &pose, pair->cylinder,
                                 (pe_gap_query){.size = pair->size, .limit = margin}, manifold);
}

/* ---- Places on the mesh ---- */

/* A face at the edge whose normal is the direction, except for a small angle; -1: none. */
static int face_along(const pe_solid *mesh, int edge, pe_vec3 out)
{
    for (int k = 0; k < 2; ++k) {
        int face = mesh->edges[edge].face[k];
        pe_vec3 normal = mesh->faces[face].normal, across = pe_cross(out, normal);
        if (pe_dot(out, normal) > 0 &&
            pe_dot(across, across) <= PE_NEXT_TO_FACE * PE_NEXT_TO_FACE) {
            return face;
        }
    }
    return -1;
}

/* A place at an edge or a vertex, or next to one of the `count` edges there. */
static pe_cylinder_place place_at(const pe_solid *mesh, pe_cylinder_place at, const int *edges,
                                  int count, pe_vec3 out)
{
    for (int i = 0; i < count; ++i) {
        int face = face_along(mesh, edges[i], out);
        if (face >= 0) {
            return (pe_cylinder_place){PE_NEXT_TO_EDGE, face,
                                       pe_touch_feature(PE_EDGE_VERTEX, 1, face)};
        }
    }
    return at;
}

pe_cylinder_place pe_cylinder_find_place(const pe_cylinder_mesh *pair, pe_facet *f, pe_vec3 out,
                                         bool by_faces)
{
    const pe_solid *mesh = &pair->solid;
    pe_vec3 across = pe_cross(out, f->normal);
    if (pe_dot(out, f->normal) > 0 && pe_dot(across, across) <= PE_ALONG_NORMAL * PE_ALONG_NORMAL) {
        return (pe_cylinder_place){PE_ON_FACE, f->face,
                                   pe_touch_feature(PE_VERTEX_FACE, PE_AT_NEAREST, f->face)};
    }
    double along[3], most = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        along[k] = pe_dot(out, f->x[k]);
        most = pe_max(most, along[k]);
    }
    const pe_ridge *ridge = f->ridges;
    pe_facet_ridges(mesh, NULL, f);
    double level = PE_LEVEL_CORNERS * pair->size;
    for (int k = 0; k < 3; ++k) {
        if (!pe_facet_owns_edge(f, k)) {
            continue;
        }
        if (along[k] >= most - level && along[k < 2 ? k + 1 : 0] >= most - level &&
            pe_ridge_faces(ridge, out, 1, PE_OUTSIDE_EDGE)) {
            pe_cylinder_place at = {PE_AT_EDGE, -1,
                                    pe_touch_feature(PE_VERTEX_EDGE, 0, f->edges[k])};
            return place_at(mesh, at, &f->edges[k], by_faces ? 1 : 0, out);
        }
        ++ridge;
    }
    for (int k = 0; k < 3; ++k) {
        int v = f->vertices[k];
        bool strict;
        if (along[k] >= most - level && pe_facet_owns_corner(f, k) &&
            pe_vertex_takes_normal(mesh, v, pe_scale(-1, out), &strict) && strict) {
            pe_cylinder_place at = {PE_AT_VERTEX, -1, pe_touch_feature(PE_VERTEX_VERTEX, 0, v)};
            int first = mesh->vertex_first[v], count = mesh->vertex_first[v + 1] - first;
            return place_at(mesh, at, mesh->vertex_edges + first, by_faces ? count : 0, out);
        }
    }
    return (pe_cylinder_place){PE_NOWHERE, -1, pe_touch_feature(PE_EDGE_VERTEX, 0, f->face)};
}
