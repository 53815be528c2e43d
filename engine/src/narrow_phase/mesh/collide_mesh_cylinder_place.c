/* Where on a mesh a triangle is nearest to a cylinder, and whether the mesh has that direction
 * there.
 */
#include "collide_mesh_cylinder.h"

/* Sine of the angle up to which a direction is a face's normal. */
static const double ALONG_NORMAL = 1e-6;
/* Sine of the angle by which a direction may lie outside what an edge or a vertex faces. */
static const double OUTSIDE = 1e-6;
/* In units of the smaller shape: corners of a triangle that are level along a direction. */
static const double LEVEL = 1e-8;

/* A face at the edge that has the direction but for a small angle; -1: none. */
static int face_beside(const pe_solid *mesh, int edge, pe_vec3 out)
{
    for (int k = 0; k < 2; ++k) {
        int face = mesh->edges[edge].face[k];
        pe_vec3 normal = mesh->faces[face].normal, across = pe_cross(out, normal);
        if (pe_dot(out, normal) > 0 && pe_dot(across, across) <= PE_BESIDE * PE_BESIDE) {
            return face;
        }
    }
    return -1;
}

static pe_cylinder_place beside_face(int face)
{
    return (pe_cylinder_place){PE_BESIDE_FACE, face, pe_touch_feature(PE_EDGE_VERTEX, 1, face)};
}

static pe_cylinder_place at_edge(const pe_solid *mesh, int edge, pe_vec3 out, bool by_faces)
{
    int face = by_faces ? face_beside(mesh, edge, out) : -1;
    return face >= 0
               ? beside_face(face)
               : (pe_cylinder_place){PE_AT_EDGE, -1, pe_touch_feature(PE_VERTEX_EDGE, 0, edge)};
}

static pe_cylinder_place at_vertex(const pe_solid *mesh, int vertex, pe_vec3 out, bool by_faces)
{
    const int *first = mesh->vertex_first;
    for (int i = first[vertex]; i < first[vertex + 1] && by_faces; ++i) {
        int face = face_beside(mesh, mesh->vertex_edges[i], out);
        if (face >= 0) {
            return beside_face(face);
        }
    }
    return (pe_cylinder_place){PE_AT_VERTEX, -1, pe_touch_feature(PE_VERTEX_VERTEX, 0, vertex)};
}

pe_cylinder_place pe_cylinder_find_place(const pe_solid *mesh, double size, pe_facet *f,
                                         pe_vec3 out, bool by_faces)
{
    pe_vec3 across = pe_cross(out, f->normal);
    if (pe_dot(out, f->normal) > 0 && pe_dot(across, across) <= ALONG_NORMAL * ALONG_NORMAL) {
        return (pe_cylinder_place){PE_ON_FACE, f->face,
                                   pe_touch_feature(PE_VERTEX_FACE, PE_AT_NEAREST, f->face)};
    }
    double along[3], most = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        along[k] = pe_dot(out, f->x[k]);
        most = pe_max(most, along[k]);
    }
    int ridge = 0;
    pe_facet_ridges(mesh, NULL, f);
    double level = LEVEL * size;
    for (int k = 0; k < 3; ++k) {
        bool owned = (f->owns >> (3 + k) & 1) != 0;
        if (along[k] >= most - level && along[k < 2 ? k + 1 : 0] >= most - level) {
            if (owned && pe_ridge_faces(&f->ridges[ridge], out, 1, OUTSIDE)) {
                return at_edge(mesh, f->edges[k], out, by_faces);
            }
        }
        ridge += owned;
    }
    for (int k = 0; k < 3; ++k) {
        bool strict, owned = (f->owns >> k & 1) != 0;
        if (along[k] >= most - level && owned &&
            pe_vertex_faces(mesh, f->vertices[k], pe_scale(-1, out), &strict) && strict) {
            return at_vertex(mesh, f->vertices[k], out, by_faces);
        }
    }
    return (pe_cylinder_place){PE_NOWHERE, -1, pe_touch_feature(PE_EDGE_VERTEX, 0, f->face)};
}
