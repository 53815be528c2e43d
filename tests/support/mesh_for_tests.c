/* Meshes of forms, of the catalogue's solids, and a floor. */
#include "mesh_for_tests.h"

#include <stdlib.h>
#include <string.h>

static test_mesh make_mesh(int vertex_count, int triangle_count)
{
    test_mesh m = {
        .vertices = calloc((size_t)vertex_count, sizeof *m.vertices),
        .triangles = calloc((size_t)triangle_count, sizeof *m.triangles),
        .vertex_count = vertex_count,
    };
    assert_true(m.vertices != NULL && m.triangles != NULL);
    return m;
}

static void add_triangle(test_mesh *m, int a, int b, int c)
{
    uint32_t *t = m->triangles[m->triangle_count++];
    t[0] = (uint32_t)a;
    t[1] = (uint32_t)b;
    t[2] = (uint32_t)c;
}

static void add_quad(test_mesh *m, int a, int b, int c, int d)
{
    add_triangle(m, a, b, c);
    add_triangle(m, a, c, d);
}

test_mesh mesh_of_solid(pl_solid solid, pe_vec3 shift)
{
    test_mesh m = make_mesh(solid.vertex_count, solid.triangle_count);
    for (int i = 0; i < solid.vertex_count; ++i) {
        const double *v = solid.vertices[i];
        m.vertices[i] = pe_add(shift, pe_v3(v[0], v[1], v[2]));
    }
    for (int i = 0; i < solid.triangle_count; ++i) {
        const int *t = solid.triangles[i];
        add_triangle(&m, t[0], t[1], t[2]);
    }
    pl_solid_free(&solid);
    return m;
}

test_mesh mesh_of_form(const form *f)
{
    test_mesh m = make_mesh(f->vertex_count, f->triangle_count);
    m.triangle_count = f->triangle_count;
    memcpy(m.vertices, f->vertices, (size_t)f->vertex_count * sizeof *m.vertices);
    memcpy(m.triangles, f->triangles, (size_t)f->triangle_count * sizeof *m.triangles);
    return m;
}

test_mesh mesh_torus(double ring, double tube, int around, int sides)
{
    return mesh_of_solid(pl_solid_torus(ring, tube, around, sides), pe_v3(0, 0, 0));
}

test_mesh mesh_cube(double side)
{
    form f = form_cube();
    form_scale(&f, pe_v3(0.5 * side, 0.5 * side, 0.5 * side));
    return mesh_of_form(&f);
}

test_mesh mesh_angle_bar(void)
{
    static const double outline[6][2] = {{-1, -1}, {2, -1}, {2, 0}, {0, 0}, {0, 2}, {-1, 2}};
    form f = form_prism(outline, 6, 0, 2);
    return mesh_of_form(&f);
}

test_mesh mesh_floor(int n)
{
    int w = n + 1, grid = w * w;
    test_mesh m = make_mesh(2 * grid, 4 * n * n + 8 * n);
    for (int i = 0; i < grid; ++i) {
        double x = i % w - 0.5 * n, y = i / w - 0.5 * n;
        m.vertices[i] = pe_v3(x, y, 0);
        m.vertices[grid + i] = pe_v3(x, y, -1);
    }
    for (int i = 0; i < n * n; ++i) {
        int a = i / n * w + i % n, b = a + 1, d = a + w, c = d + 1, g = grid;
        add_quad(&m, a, b, c, d);
        add_triangle(&m, g + a, g + c, g + b);
        add_triangle(&m, g + a, g + d, g + c);
    }
    for (int side = 0; side < 4; ++side) {
        for (int i = 0; i < n; ++i) {
            int at[2];
            for (int k = 0; k < 2; ++k) {
                int j = i + k;
                at[k] = side == 0   ? j
                        : side == 1 ? j * w + n
                        : side == 2 ? n * w + n - j
                                    : (n - j) * w;
            }
            add_quad(&m, grid + at[0], grid + at[1], at[1], at[0]);
        }
    }
    return m;
}

pe_geometry_def mesh_def(const test_mesh *m, bool convex)
{
    return (pe_geometry_def){m->vertices, (const uint32_t(*)[3])m->triangles, m->vertex_count,
                             m->triangle_count, convex};
}

void mesh_free(test_mesh *m)
{
    free(m->vertices);
    free(m->triangles);
}

pe_geometry *mesh_geometry(test_mesh m)
{
    pe_geometry_def def = mesh_def(&m, false);
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
