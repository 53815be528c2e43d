/* Meshes of triangles for the tests of the narrow phase. Whatever fails fails the test. */
#ifndef PLUMB_TEST_MESH_H
#define PLUMB_TEST_MESH_H

#include "placed_shape.h"

/* Lengths in m; mesh_free frees it. */
typedef struct test_mesh {
    pe_vec3 *vertices;
    uint32_t (*triangles)[3];
    int vertex_count, triangle_count;
} test_mesh;

/* About z, by the radii of its ring and its tube. */
test_mesh mesh_torus(double ring, double tube, int around, int sides);

/* The prism over a polygon, counter-clockwise, from z = 0 to `height`; the polygon is cut into
 * triangles that are given. */
test_mesh mesh_prism(const double (*corners)[2], int count, const uint32_t (*cut)[3], int cut_count,
                     double height);

/* About the origin. */
test_mesh mesh_cube(double side);

/* An L of two bars, 2 m long and 1 m thick, about the corner at the origin; 2 m high along z. */
test_mesh mesh_angle_bar(void);

/* A floor of n x n squares of 1 m, each cut in two, 1 m thick; its top is z = 0. */
test_mesh mesh_floor(int n);

/* Borrows the mesh. */
pe_geometry_def mesh_def(const test_mesh *m);
void mesh_free(test_mesh *m);

/* Takes the mesh; free_geometry frees what it becomes. */
pe_geometry *mesh_geometry(test_mesh m);
void free_geometry(pe_geometry *g);

/* The quaternion need not be unit. */
pe_pose pose_at(pe_vec3 position, pe_quat q);

/* The mesh's own frame at the place, not its centre of mass. */
placed_shape mesh_at(pe_geometry *g, pe_vec3 position, pe_quat q);

#endif
