/* A cylinder against one triangle of a mesh, as a hull without thickness. */
#include "collide_mesh_cylinder.h"

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

/* Two faces back to back, and three without width between them, so that every edge has the normals
 * between which it is outermost. */
static void make_hull(const pe_facet *f, const pe_pose *mesh, double size, thin_hull *h)
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
        .size = size,
        .box_half = {radius, radius, radius},
    };
    h->shape = (pe_shape){.kind = PE_SHAPE_HULL};
    h->pose = *mesh;
    h->pose.position = pe_add(h->pose.position, pe_rotate(&h->pose.rotation, middle));
}

void pe_collide_cylinder_facet(pe_placed cylinder, const pe_facet *f, const pe_pose *mesh,
                               double size, double margin, pe_pair_manifold *hits)
{
    thin_hull hull;
    make_hull(f, mesh, size, &hull);
    pe_placed b = {&hull.shape, &hull.geometry, &hull.pose, size};
    pe_pair_manifold_clear(hits);
    pe_collide_cylinder_hull(cylinder, b, margin, hits);
}
