/* Meshes of triangles for the tests of the narrow phase. Any failure fails the test. */
#ifndef PLUMB_TEST_MESH_H
#define PLUMB_TEST_MESH_H

#include "catalogue/solids.h"
#include "placed_shape.h"
#include "solid_forms.h"

/* Lengths in m; mesh_free frees it. */
typedef struct test_mesh {
    pe_vec3 *vertices;
    uint32_t (*triangles)[3];
    int vertex_count, triangle_count;
} test_mesh;

/* Copies; the first one frees the solid. */
test_mesh mesh_of_solid(pl_solid solid, pe_vec3 shift);
test_mesh mesh_of_form(const form *f);

/* A torus about z, by the radii of its ring and its tube. */
test_mesh mesh_torus(double ring, double tube, int around, int sides);

/* A cube about the origin. */
test_mesh mesh_cube(double side);

/* An L of two bars, 2 m long and 1 m thick, about the corner at the origin; 2 m high along z. */
test_mesh mesh_angle_bar(void);

/* A floor of n x n squares of 1 m, each cut in two, 1 m thick; its top is z = 0. */
test_mesh mesh_floor(int n);

/* The definition points into the mesh. */
pe_geometry_def mesh_def(const test_mesh *m, bool convex);
void mesh_free(test_mesh *m);

/* Makes a geometry, to be freed by free_geometry, and frees the mesh. */
pe_geometry *mesh_geometry(test_mesh m);
void free_geometry(pe_geometry *g);

/* The quaternion need not be unit. */
pe_pose pose_at(pe_vec3 position, pe_quat q);

/* The mesh with its own frame, not its centre of mass, at the position. */
placed_shape mesh_at(pe_geometry *g, pe_vec3 position, pe_quat q);

#endif
