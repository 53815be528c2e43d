/* A cylinder against a mesh: against each triangle near it, as a hull without thickness.
 *
 * What a triangle gives counts when its direction is one that the mesh has there: the triangle's own
 * normal, or one between those of the faces at the edge or vertex that is nearest. So the rim of a
 * triangle inside a face gives nothing of its own. A triangle that is cut so deep that the shortest
 * way off it leads into the solid, or along it, pushes the cylinder out along its normal instead,
 * by the cylinder's deepest point. Where not even that lies over a triangle, the one along whose
 * normal the cylinder is least deep decides. */
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
    pe_touch fallback;
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
static bool is_faced(const scene *s, const pe_facet *f, pe_vec3 out)
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
    pe_ridge ridges[3];
    int ridge = 0;
    pe_ridges_of(&s->solid, NULL, f, ridges);
    double level = LEVEL * s->size;
    for (int k = 0; k < 3; ++k) {
        bool owned = (f->owns >> (3 + k) & 1) != 0;
        if (along[k] >= most - level && along[k < 2 ? k + 1 : 0] >= most - level) {
            return owned && pe_ridge_faces(&ridges[ridge], out, 1, OUTSIDE);
        }
        ridge += owned;
    }
    for (int k = 0; k < 3; ++k) {
        bool strict, owned = (f->owns >> k & 1) != 0;
        if (along[k] == most && owned &&
            pe_vertex_faces(&s->solid, f->vertices[k], pe_scale(-1, out), &strict)) {
            return strict;
        }
    }
    return false;
}

/* The cylinder's last point along d, in the mesh's axes. */
static pe_vec3 last_point(const scene *s, pe_vec3 d)
{
    const pe_shape *shape = s->cylinder.shape;
    pe_vec3 own = pe_unrotate(&s->trees.turn, d);
    double across = sqrt(own.x * own.x + own.y * own.y);
    double f = across > 0 ? shape->radius / across : 0;
    pe_vec3 x = pe_v3(f * own.x, f * own.y, own.z < 0 ? -shape->half_height : shape->half_height);
    return pe_add(pe_rotate(&s->trees.turn, x), s->trees.offset);
}

/* Names a point by its triangle and a hash of its name on the hull. */
static uint64_t feature_of(int triangle, uint64_t name)
{
    return (uint64_t)(uint32_t)triangle << 32 | (name * 0x9E3779B97F4A7C15u) >> 32;
}

static void add(scene *s, int triangle, uint64_t name, pe_vec3 n, pe_vec3 on_a, double separation)
{
    pe_touch touch = {
        .feature = feature_of(triangle, name),
        .kind = PE_VERTEX_FACE,
        .normal = n,
        .on_a = on_a,
        .separation = separation,
        .strict = true,
    };
    pe_touches_add(&s->list, &touch);
}

/* Out along the triangle's normal, by the cylinder's deepest point. */
static void push_out(scene *s, const pe_facet *f, int triangle)
{
    pe_vec3 n = pe_scale(-1, f->normal), x = last_point(s, n);
    double height = pe_dot(f->normal, x) - f->offset;
    if (!(height < 0)) {
        return;
    }
    if (pe_facet_holds(f, x, PE_SLACK * s->size)) {
        add(s, triangle, 0, n, x, height);
    } else if (height > s->fallback.separation) {
        s->fallback.feature = feature_of(triangle, 0);
        s->fallback.normal = n;
        s->fallback.on_a = x;
        s->fallback.separation = height;
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
        push_out(s, &f, triangle);
        return;
    }
    for (int i = 0; i < hits.count; ++i) {
        const pe_hit *hit = &hits.item[i];
        pe_vec3 x = pe_unrotate(&pose->rotation, pe_sub(hit->position, pose->position));
        pe_vec3 on_a = pe_madd(x, -0.5 * hit->separation, n);
        add(s, triangle, hit->feature, n, on_a, hit->separation);
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
    if (s.list.count == 0 && s.fallback.separation > -HUGE_VAL) {
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
