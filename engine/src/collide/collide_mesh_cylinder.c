/* A cylinder against a mesh: against each triangle near it, as a hull without thickness, and each
 * vertex in it.
 *
 * What a triangle gives counts when its direction is one that the mesh has there: the triangle's
 * own normal, or one between those of the faces at the edge or vertex that is nearest. So the rim
 * of a triangle inside a face gives nothing of its own. A triangle that is cut so deep that the
 * shortest way off it leads into the solid, or along it, gives nothing either. Where no triangle
 * gives an overlap but some are cut, the cylinder is pushed out along the normal of one of these,
 * by what of it lies under the triangle there: the one where that is least. */
#include "collide_mesh.h"

/* Sine of the angle up to which a direction is a face's normal. */
static const double ALONG_NORMAL = 1e-6;
/* Sine of the angle by which a direction may lie outside what an edge or a vertex faces. */
static const double OUTSIDE = 1e-6;
/* In units of the smaller shape: corners of a triangle that are level along a direction. */
static const double LEVEL = 1e-8;

/* A triangle as a hull, in axes about its middle. */
typedef struct thin_hull {
    pe_vec3 vertices[3];
    pe_face faces[5];
    pe_edge edges[6];
    int corners[12], vertex_first[4], vertex_edges[12];
    pe_geometry geometry;
    pe_shape shape;
    pe_pose pose;
} thin_hull;

typedef struct scene {
    pe_placed cylinder, mesh;
    pe_solid solid;
    pe_bvh_pair trees; /* of the cylinder's box and the mesh */
    double size, reach;
    pe_touches list;
    pe_touch fallback; /* of triangles that give nothing, the least deep way out */
    bool is_over;      /* its point lies over its triangle: better than one that does not */
} scene;

/* Two faces back to back, and three without width between them, so that every edge has the normals
 * between which it is outermost. */
static void make_hull(const scene *s, const pe_facet *f, thin_hull *h)
{
    static const int corners[12] = {0, 1, 2, 0, 2, 1, 0, 1, 1, 2, 2, 0}, first[4] = {0, 4, 8, 12};
    static const int edges_at[12] = {0, 1, 4, 5, 0, 1, 2, 3, 2, 3, 4, 5};
    pe_vec3 middle = pe_scale(1.0 / 3, pe_add(f->x[0], pe_add(f->x[1], f->x[2])));
    double radius = 0;
    h->faces[0] = (pe_face){.normal = f->normal, .corner_count = 3};
    h->faces[1] =
        (pe_face){.normal = pe_scale(-1, f->normal), .first_corner = 3, .corner_count = 3};
    for (int k = 0; k < 3; ++k) {
        int next = k < 2 ? k + 1 : 0;
        h->vertices[k] = pe_sub(f->x[k], middle);
        h->edges[2 * k] = (pe_edge){{k, next}, {0, 2 + k}, true};
        h->edges[2 * k + 1] = (pe_edge){{k, next}, {2 + k, 1}, true};
        h->vertex_first[k] = first[k];
        radius = pe_max(radius, pe_length(h->vertices[k]));
        pe_vec3 out = pe_cross(pe_sub(f->x[next], f->x[k]), f->normal);
        out = pe_scale(1 / pe_length(out), out);
        h->faces[2 + k] = (pe_face){.normal = out,
                                    .offset = pe_dot(out, h->vertices[k]),
                                    .first_corner = 6 + 2 * k,
                                    .corner_count = 2};
    }
    h->vertex_first[3] = first[3];
    for (int i = 0; i < 12; ++i) {
        h->corners[i] = corners[i];
        h->vertex_edges[i] = edges_at[i];
    }
    h->geometry = (pe_geometry){
        .convex = true,
        .vertex_count = 3,
        .face_count = 5,
        .edge_count = 6,
        .corner_count = 12,
        .vertices = h->vertices,
        .faces = h->faces,
        .edges = h->edges,
        .corners = h->corners,
        .vertex_first = h->vertex_first,
        .vertex_edges = h->vertex_edges,
        .bounding_radius = radius,
        .size = s->size,
        .box_half = {radius, radius, radius},
    };
    h->shape = (pe_shape){.kind = PE_SHAPE_HULL};
    h->pose = *s->mesh.pose;
    h->pose.position = pe_add(h->pose.position, pe_rotate(&h->pose.rotation, middle));
}

/* Whether the mesh has the direction `out`, away from it, at what of the triangle is last along it.
 */
static bool is_faced(const scene *s, pe_facet *f, pe_vec3 out)
{
    pe_vec3 across = pe_cross(out, f->normal);
    if (pe_dot(out, f->normal) > 0 && pe_dot(across, across) <= ALONG_NORMAL * ALONG_NORMAL) {
        return true;
    }
    double along[3], most = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        along[k] = pe_dot(out, f->x[k]);
        most = pe_max(most, along[k]);
    }
    int ridge = 0;
    pe_facet_ridges(&s->solid, NULL, f);
    double level = LEVEL * s->size;
    for (int k = 0; k < 3; ++k) {
        bool owned = (f->owns >> (3 + k) & 1) != 0;
        if (along[k] >= most - level && along[k < 2 ? k + 1 : 0] >= most - level) {
            if (owned && pe_ridge_faces(&f->ridges[ridge], out, 1, OUTSIDE)) {
                return true;
            }
        }
        ridge += owned;
    }
    for (int k = 0; k < 3; ++k) {
        bool strict, owned = (f->owns >> k & 1) != 0;
        if (along[k] >= most - level && owned &&
            pe_vertex_faces(&s->solid, f->vertices[k], pe_scale(-1, out), &strict) && strict) {
            return true;
        }
    }
    return false;
}

/* How far it is from a point in the cylinder, along the unit direction n, to its surface; both in
 * the mesh's axes. */
static double way_out_of_cylinder(const scene *s, pe_vec3 x, pe_vec3 n)
{
    const pe_shape *shape = s->cylinder.shape;
    pe_vec3 y = pe_unrotate(&s->trees.turn, pe_sub(x, s->trees.offset));
    pe_vec3 d = pe_unrotate(&s->trees.turn, n);
    double a = d.x * d.x + d.y * d.y, b = y.x * d.x + y.y * d.y;
    double c = shape->radius * shape->radius - y.x * y.x - y.y * y.y;
    double side = a > 0 ? (sqrt(pe_max(0, b * b + a * c)) - b) / a : HUGE_VAL;
    double z = d.z < 0 ? -y.z : y.z;
    double cap = d.z != 0 ? (shape->half_height - z) / fabs(d.z) : HUGE_VAL;
    return pe_max(0, pe_min(side, cap));
}

/* Names a point by its triangle and a hash of its name on the hull. */
static uint64_t feature_of(int triangle, uint64_t name)
{
    return (uint64_t)2 << 60 | (uint64_t)(uint32_t)triangle << 32 |
           (name * 0x9E3779B97F4A7C15u) >> 32;
}

static pe_touch touch_of(int triangle, uint64_t name, pe_vec3 n, pe_vec3 on_a, double separation)
{
    return (pe_touch){
        .feature = feature_of(triangle, name),
        .kind = PE_VERTEX_FACE,
        .normal = n,
        .on_a = on_a,
        .separation = separation,
        .strict = true,
    };
}

/* Takes the way out if it is better than the one so far. */
static void offer(scene *s, bool is_over, pe_touch touch)
{
    if (is_over > s->is_over ||
        (is_over == s->is_over && touch.separation > s->fallback.separation)) {
        s->is_over = is_over;
        s->fallback = touch;
    }
}

/* Out along a direction, by what of the cylinder lies that way from a point of the mesh in it. */
static void push_out(scene *s, pe_vec3 n, pe_vec3 on_b, double depth, int triangle)
{
    double way = way_out_of_cylinder(s, on_b, n);
    offer(s, false, touch_of(triangle, 0, n, pe_madd(on_b, way, n), -way - depth));
}

/* Out along the triangle's normal: by the cylinder's last point below it, if over the triangle, or
 * else from a point of the triangle in the cylinder. */
static void push_off(scene *s, const pe_facet *f, pe_vec3 on_b, int triangle)
{
    pe_vec3 n = pe_scale(-1, f->normal), own = pe_unrotate(&s->trees.turn, n);
    const pe_shape *shape = s->cylinder.shape;
    double across = sqrt(own.x * own.x + own.y * own.y);
    double r = across > 0 ? shape->radius / across : 0;
    pe_vec3 x = pe_v3(r * own.x, r * own.y, own.z < 0 ? -shape->half_height : shape->half_height);
    x = pe_add(pe_rotate(&s->trees.turn, x), s->trees.offset);
    double height = pe_dot(f->normal, x) - f->offset;
    if (height < 0 && pe_facet_holds(f, x, PE_SLACK * s->size)) {
        offer(s, true, touch_of(triangle, 0, n, x, height));
    } else {
        push_out(s, n, on_b, 0, triangle);
    }
}

/* From inside the solid, by the way that is shortest from the cylinder's centre. */
static void push_out_of_solid(scene *s)
{
    pe_vec3 x = s->trees.offset, in = pe_sub(x, pe_solid_nearest_point(&s->solid, x));
    double depth = pe_length(in);
    if (depth > 0) {
        push_out(s, pe_scale(1 / depth, in), x, depth, 0);
    }
}

/* A vertex in the cylinder, out through the nearer one of its cap and its side that it faces. */
static void try_vertex(scene *s, int vertex, pe_vec3 x)
{
    const pe_shape *shape = s->cylinder.shape;
    pe_vec3 y = pe_unrotate(&s->trees.turn, pe_sub(x, s->trees.offset));
    double from_axis = sqrt(y.x * y.x + y.y * y.y);
    double to_cap = shape->half_height - fabs(y.z), to_side = shape->radius - from_axis;
    if (!(to_cap > 0 && to_side > 0)) {
        return;
    }
    for (int side = 0; side < 2; ++side) {
        bool to_cap_now = (side == 0) == (to_cap <= to_side);
        pe_vec3 out = to_cap_now ? pe_v3(0, 0, y.z < 0 ? -1 : 1)
                                 : pe_scale(from_axis > 0 ? 1 / from_axis : 0, pe_v3(y.x, y.y, 0));
        pe_vec3 n = pe_rotate(&s->trees.turn, out);
        double depth = to_cap_now ? to_cap : to_side;
        bool strict;
        if (pe_vertex_faces(&s->solid, vertex, n, &strict) && strict && pe_dot(n, n) > 0.5) {
            pe_touch touch = {
                .feature = pe_touch_feature(PE_FACE_VERTEX, vertex, to_cap_now),
                .kind = PE_FACE_VERTEX,
                .normal = n,
                .on_a = pe_madd(x, depth, n),
                .separation = -depth,
                .strict = true,
            };
            pe_touches_add(&s->list, &touch);
            return;
        }
    }
}

static void try_facet(scene *s, int triangle, double bound)
{
    pe_facet f;
    pe_solid_facet(&s->solid, triangle, &f);
    for (int k = 0; k < 3; ++k) {
        if ((f.owns >> k & 1) != 0) {
            try_vertex(s, f.vertices[k], f.x[k]);
        }
    }
    thin_hull hull;
    make_hull(s, &f, &hull);
    pe_placed b = {&hull.shape, &hull.geometry, &hull.pose, s->size};
    pe_hits hits;
    pe_hits_none(&hits);
    pe_collide_cylinder_hull(s->cylinder, b, bound, &hits);
    if (hits.count == 0) {
        return;
    }
    const pe_pose *pose = s->mesh.pose;
    pe_vec3 n = pe_unrotate(&pose->rotation, hits.normal);
    if (!is_faced(s, &f, pe_scale(-1, n))) {
        const pe_hit *deepest = &hits.item[0];
        for (int i = 1; i < hits.count; ++i) {
            bool deeper = hits.item[i].separation < deepest->separation;
            deepest = deeper ? &hits.item[i] : deepest;
        }
        if (deepest->separation < 0) {
            pe_vec3 x = pe_madd(deepest->position, 0.5 * deepest->separation, hits.normal);
            x = pe_unrotate(&pose->rotation, pe_sub(x, pose->position));
            push_off(s, &f, x, triangle);
        }
        return;
    }
    for (int i = 0; i < hits.count; ++i) {
        const pe_hit *hit = &hits.item[i];
        pe_vec3 x = pe_unrotate(&pose->rotation, pe_sub(hit->position, pose->position));
        pe_vec3 on_a = pe_madd(x, -0.5 * hit->separation, n);
        pe_touch touch = touch_of(triangle, hit->feature, n, on_a, hit->separation);
        pe_touches_add(&s->list, &touch);
    }
}

int pe_collide_cylinder_mesh(pe_placed cylinder, pe_placed mesh, double margin, pe_workspace work,
                             pe_hits *patches)
{
    const pe_shape *shape = cylinder.shape;
    pe_node box =
        pe_box_node(pe_v3(0, 0, 0), pe_v3(shape->radius, shape->radius, shape->half_height));
    scene s = {
        .cylinder = cylinder,
        .mesh = mesh,
        .solid = pe_solid_of_geometry(mesh.geometry),
        .trees = pe_bvh_pair_between(&box, cylinder.pose, mesh.geometry->nodes, mesh.pose),
        .size = pe_min(cylinder.size, mesh.size),
        .list = {.work = work},
        .fallback = {.kind = PE_VERTEX_FACE, .separation = -HUGE_VAL, .strict = true},
    };
    double band = PE_BAND * pe_min(box.radius, mesh.geometry->bounding_radius);
    double look = margin * (1 + PE_LOOK_AHEAD) + PE_SLACK * s.size, bound = look;
    pe_bvh_walk walk;
    const pe_node *leaf_a, *leaf;
    pe_bvh_begin(&s.trees, &walk);
    while (!s.list.failed && pe_bvh_next(&s.trees, &walk, bound, &leaf_a, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            try_facet(&s, leaf->first + i, bound);
        }
        bound = pe_min(look, pe_max(0, pe_touches_least(&s.list) + band));
    }
    bool overlap = s.fallback.separation > -HUGE_VAL;
    if (s.list.count == 0 && !overlap && pe_solid_holds(&s.solid, s.trees.offset)) {
        push_out_of_solid(&s);
        overlap = s.fallback.separation > -HUGE_VAL;
    }
    if (overlap && !(pe_touches_least(&s.list) < 0)) {
        pe_touches_add(&s.list, &s.fallback);
    }
    pe_touches_sort(&s.list);
    pe_touches_settle(&s.list, 0, s.size);
    pe_patch_rules rules = {
        .size = s.size,
        .margin = margin,
        .limit = pe_touches_least(&s.list) + band,
        .least = -HUGE_VAL,
        .end_margin = bound < look ? HUGE_VAL : look,
    };
    return s.list.failed ? -1 : pe_touches_make_patches(&s.list, &rules, mesh.pose, patches);
}
