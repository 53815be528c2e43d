#include "mesh_for_tests.h"

#include "catalogue/solids.h"

#include <stdlib.h>

static test_mesh mesh_of(pl_solid solid)
{
    test_mesh m = {
        .vertices = calloc((size_t)solid.vertex_count, sizeof *m.vertices),
        .triangles = calloc((size_t)solid.triangle_count, sizeof *m.triangles),
        .vertex_count = solid.vertex_count,
        .triangle_count = solid.triangle_count,
    };
    for (int i = 0; i < solid.vertex_count; ++i) {
        const double *v = solid.vertices[i];
        m.vertices[i] = pe_v3(v[0], v[1], v[2]);
    }
    for (int i = 0; i < 3 * solid.triangle_count; ++i) {
        m.triangles[i / 3][i % 3] = (uint32_t)solid.triangles[i / 3][i % 3];
    }
    pl_solid_free(&solid);
    return m;
}

test_mesh mesh_torus(double ring, double tube, int around, int sides)
{
    return mesh_of(pl_solid_torus(ring, tube, around, sides));
}

test_mesh mesh_prism(const double (*corners)[2], int count, const uint32_t (*cut)[3], int cut_count,
                     double height)
{
    test_mesh m = {
        .vertices = calloc((size_t)(2 * count), sizeof *m.vertices),
        .triangles = calloc((size_t)(2 * (cut_count + count)), sizeof *m.triangles),
        .vertex_count = 2 * count,
    };
    uint32_t n = (uint32_t)count;
    for (uint32_t i = 0; i < n; ++i) {
        m.vertices[i] = pe_v3(corners[i][0], corners[i][1], 0);
        m.vertices[n + i] = pe_v3(corners[i][0], corners[i][1], height);
        uint32_t j = (i + 1) % n;
        uint32_t side[2][3] = {{i, j, n + j}, {i, n + j, n + i}};
        for (int k = 0; k < 6; ++k) {
            m.triangles[m.triangle_count + k / 3][k % 3] = side[k / 3][k % 3];
        }
        m.triangle_count += 2;
    }
    for (int i = 0; i < cut_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            m.triangles[m.triangle_count][k] = cut[i][2 - k];
            m.triangles[m.triangle_count + 1][k] = n + cut[i][k];
        }
        m.triangle_count += 2;
    }
    return m;
}

test_mesh mesh_cube(double side)
{
    double h = 0.5 * side;
    const double corners[4][2] = {{-h, -h}, {h, -h}, {h, h}, {-h, h}};
    static const uint32_t cut[2][3] = {{0, 1, 2}, {0, 2, 3}};
    test_mesh m = mesh_prism(corners, 4, cut, 2, side);
    for (int i = 0; i < m.vertex_count; ++i) {
        m.vertices[i].z -= h;
    }
    return m;
}

test_mesh mesh_angle_bar(void)
{
    static const double corners[6][2] = {{-1, -1}, {2, -1}, {2, 0}, {0, 0}, {0, 2}, {-1, 2}};
    static const uint32_t cut[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
    return mesh_prism(corners, 6, cut, 4, 2);
}

test_mesh mesh_floor(int n)
{
    int grid = (n + 1) * (n + 1);
    test_mesh m = {
        .vertices = calloc((size_t)(2 * grid), sizeof *m.vertices),
        .triangles = calloc((size_t)(4 * n * n + 8 * n), sizeof *m.triangles),
        .vertex_count = 2 * grid,
    };
    for (int i = 0; i < grid; ++i) {
        double x = i % (n + 1) - 0.5 * n, y = i / (n + 1) - 0.5 * n;
        m.vertices[i] = pe_v3(x, y, 0);
        m.vertices[grid + i] = pe_v3(x, y, -1);
    }
    for (int i = 0; i < n * n; ++i) {
        uint32_t a = (uint32_t)(i / n * (n + 1) + i % n), b = a + 1, d = a + (uint32_t)n + 1;
        uint32_t g = (uint32_t)grid, c = d + 1;
        uint32_t quad[4][3] = {{a, b, c}, {a, c, d}, {g + a, g + c, g + b}, {g + a, g + d, g + c}};
        for (int k = 0; k < 12; ++k) {
            m.triangles[m.triangle_count + k / 3][k % 3] = quad[k / 3][k % 3];
        }
        m.triangle_count += 4;
    }
    for (int side = 0; side < 4; ++side) {
        for (int i = 0; i < n; ++i) {
            int w = n + 1, p, q;
            p = side == 0 ? i : side == 1 ? i * w + n : side == 2 ? n * w + n - i : (n - i) * w;
            q = side == 0   ? i + 1
                : side == 1 ? (i + 1) * w + n
                : side == 2 ? n * w + n - i - 1
                            : (n - i - 1) * w;
            uint32_t a = (uint32_t)p, b = (uint32_t)q, g = (uint32_t)grid;
            uint32_t pair[2][3] = {{g + a, g + b, b}, {g + a, b, a}};
            for (int k = 0; k < 6; ++k) {
                m.triangles[m.triangle_count + k / 3][k % 3] = pair[k / 3][k % 3];
            }
            m.triangle_count += 2;
        }
    }
    return m;
}

pe_geometry_def mesh_def(const test_mesh *m)
{
    return (pe_geometry_def){m->vertices, (const uint32_t(*)[3])m->triangles, m->vertex_count,
                             m->triangle_count, false};
}

void mesh_free(test_mesh *m)
{
    free(m->vertices);
    free(m->triangles);
}

pe_geometry *mesh_geometry(test_mesh m)
{
    pe_geometry_def def = mesh_def(&m);
    pe_allocator allocator = pe_allocator_default();
    pe_geometry *g = NULL;
    pe_error error = {0};
    if (pe_geometry_make(&def, &allocator, &g, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    mesh_free(&m);
    return g;
}

void free_geometry(pe_geometry *g)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_free(g, &allocator);
}

pe_pose pose_at(pe_vec3 position, pe_quat q)
{
    q = pe_quat_unit(q);
    return (pe_pose){position, q, pe_matrix_of(q)};
}

placed_shape mesh_at(pe_geometry *g, pe_vec3 position, pe_quat q)
{
    placed_shape b = {.shape = {.kind = PE_SHAPE_MESH}, .geometry = g};
    pe_pose frame = pose_at(position, q);
    b.pose = pose_at(pe_add(position, pe_rotate(&frame.rotation, g->frame.centre)),
                     pe_quat_product(frame.orientation, g->frame.orientation));
    return b;
}
