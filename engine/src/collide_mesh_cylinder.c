/* A cylinder against a mesh: against each triangle near it, as a hull without thickness.
 *
 * What a triangle gives counts when its direction is one that the mesh has there: the triangle's own
 * normal, or one between those of the faces at the edge or vertex that is nearest. So the rim of a
 * triangle inside a face gives nothing of its own. A triangle that is cut so deep that the shortest
 * way off it leads into the solid, or along it, gives nothing either. Where no triangle gives an
 * overlap but some are cut, the cylinder is pushed out along the normal of one of these, by what of
 * it lies under the triangle there: the one where that is least. */
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
    pe_face faces[2];
    pe_edge edges[3];
    int corners[6], vertex_first[4], vertex_edges[6];
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
} scene;

static void make_hull(const scene *s, const pe_facet *f, thin_hull *h)
{
    static const int corners[6] = {0, 1, 2, 0, 2, 1}, first[4] = {0, 2, 4, 6};
    static const int edges_at[6] = {0, 2, 0, 1, 1, 2};
    pe_vec3 middle = pe_scale(1.0 / 3, pe_add(f->x[0], pe_add(f->x[1], f->x[2])));
    double radius = 0;
    for (int k = 0; k < 3; ++k) {
        h->vertices[k] = pe_sub(f->x[k], middle);
        h->edges[k] = (pe_edge){{k, k < 2 ? k + 1 : 0}, {0, 1}, true};
        h->vertex_first[k] = first[k];
        radius = pe_max(radius, pe_length(h->vertices[k]));
    }
    h->vertex_first[3] = first[3];
    for (int i = 0; i < 6; ++i) {
        h->corners[i] = corners[i];
        h->vertex_edges[i] = edges_at[i];
    }
    h->faces[0] = (pe_face){.normal = f->normal, .corner_count = 3};
    h->faces[1] = (pe_face){.normal = pe_scale(-1, f->normal), .first_corner = 3, .corner_count = 3};
    h->geometry = (pe_geometry){
        .convex = true,
        .vertex_count = 3,
        .face_count = 2,
        .edge_count = 3,
        .corner_count = 6,
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
    return (uint64_t)(uint32_t)triangle << 32 | (name * 0x9E3779B97F4A7C15u) >> 32;
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

/* Out along a direction, by what of the cylinder lies that way from a point of the mesh in it. */
static void push_out(scene *s, pe_vec3 n, pe_vec3 on_b, double depth, int triangle)
{
    double way = way_out_of_cylinder(s, on_b, n);
    if (-way - depth > s->fallback.separation) {
        pe_vec3 on_a = pe_madd(on_b, way, n);
        s->fallback = touch_of(triangle, 0, n, on_a, -way - depth);
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

static void try_facet(scene *s, int triangle, double bound)
{
    pe_facet f;
    pe_solid_facet(&s->solid, triangle, &f);
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
            push_out(s, pe_scale(-1, f.normal), x, 0, triangle);
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
    pe_node box = pe_box_node(pe_v3(0, 0, 0), pe_v3(shape->radius, shape->radius,
                                                    shape->half_height));
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
