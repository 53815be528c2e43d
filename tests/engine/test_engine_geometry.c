/* Geometries of hulls and meshes: mass by closed forms, faces and edges by Euler's formula, the
 * tree, and invalid solids. */
#include "check.h"
#include "counting_allocator.h"
#include "mesh_for_tests.h"

static pe_geometry *make(const test_mesh *m, bool convex)
{
    pe_geometry_def def = mesh_def(m, convex);
    pe_allocator allocator = pe_allocator_default();
    pe_geometry *g = NULL;
    pe_error error = {0};
    if (pe_geometry_make(&def, &allocator, &g, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    return g;
}

static double least(pe_vec3 v)
{
    return pe_min(v.x, pe_min(v.y, v.z));
}

static double most(pe_vec3 v)
{
    return pe_max(v.x, pe_max(v.y, v.z));
}

static void test_mass_equals_closed_forms_at_any_offset(void **state)
{
    (void)state;
    const pe_vec3 shifts[] = {{0, 0, 0}, {3, -2, 5}, {1e5, 2e5, -3e5}};
    for (int i = 0; i < 3; ++i) {
        double far = 1e-15 * (1 + pe_length(shifts[i]));
        double height;
        test_mesh box = mesh_of_solid(pl_solid_box(1, 2, 3), shifts[i]);
        test_mesh tetrahedron = mesh_of_solid(pl_solid_tetrahedron(2, &height), shifts[i]);
        pe_geometry *b = make(&box, true), *t = make(&tetrahedron, false);
        assert_close(b->frame.volume, 48, 100 * far, 1e-14);
        assert_at_most(pe_length(pe_sub(b->frame.centre, shifts[i])), 10 * far);
        assert_close(b->frame.inertia.x, (4 + 9) / 3.0, 100 * far, 1e-14);
        assert_close(b->frame.inertia.y, (9 + 1) / 3.0, 100 * far, 1e-14);
        assert_close(b->frame.inertia.z, (1 + 4) / 3.0, 100 * far, 1e-14);
        /* Its axes are the frame's own. */
        assert_true(b->frame.orientation.w == 1);
        /* A regular tetrahedron: edge^2 / 20 about every axis. */
        assert_close(t->frame.volume, 8 / (6 * sqrt(2)), 100 * far, 1e-14);
        assert_close(least(t->frame.inertia), 0.2, 100 * far, 1e-13);
        assert_close(most(t->frame.inertia), 0.2, 100 * far, 1e-13);
        free_geometry(b);
        free_geometry(t);
        mesh_free(&box);
        mesh_free(&tetrahedron);
    }
}

/* An L is two boxes. */
static void test_principal_axes_of_l_equal_two_boxes(void **state)
{
    (void)state;
    const double l = 1, t = 0.3, w = 0.5;
    test_mesh in = mesh_of_solid(pl_solid_angle(l, t, w), pe_v3(0, 0, 0));
    pe_geometry *g = make(&in, false);
    double foot = l * t, stem = (l - t) * t, area = foot + stem;
    double cx = (foot * l / 2 + stem * t / 2) / area,
           cz = (foot * t / 2 + stem * (l + t) / 2) / area;
    assert_close(g->frame.volume, area * w, 0, 1e-14);
    assert_close(g->frame.centre.x, cx, 0, 1e-14);
    assert_close(g->frame.centre.y, w / 2, 0, 1e-14);
    assert_close(g->frame.centre.z, cz, 0, 1e-14);
    /* Second moments of the area about its centre. */
    double fx = l / 2 - cx, fz = t / 2 - cz, sx = t / 2 - cx, sz = (l + t) / 2 - cz;
    double xx = foot * (l * l / 12 + fx * fx) + stem * (t * t / 12 + sx * sx);
    double zz = foot * (t * t / 12 + fz * fz) + stem * ((l - t) * (l - t) / 12 + sz * sz);
    double xz = foot * fx * fz + stem * sx * sz;
    xx /= area, zz /= area, xz /= area;
    double mean = (xx + zz) / 2, root = sqrt((xx - zz) * (xx - zz) / 4 + xz * xz);
    /* Whatever their order. */
    double want[3] = {mean - root + w * w / 12, mean + root + w * w / 12, xx + zz};
    pe_vec3 i = g->frame.inertia;
    double sum = i.x + i.y + i.z, squares = pe_dot(i, i), product = i.x * i.y * i.z;
    assert_close(sum, want[0] + want[1] + want[2], 0, 1e-13);
    assert_close(squares, want[0] * want[0] + want[1] * want[1] + want[2] * want[2], 0, 1e-13);
    assert_close(product, want[0] * want[1] * want[2], 0, 1e-13);
    /* The engine's vertices are the caller's, moved: turned back they are where they were. */
    for (int k = 0; k < g->vertex_count; ++k) {
        pe_vec3 back = pe_add(g->frame.centre, pe_rotate(&g->rotation, g->vertices[k]));
        assert_at_most(pe_length(pe_sub(back, in.vertices[k])), 1e-15);
    }
    free_geometry(g);
    mesh_free(&in);
}

static void check_counts(pl_solid solid, bool convex, int faces, int edges, int euler)
{
    test_mesh in = mesh_of_solid(solid, pe_v3(0, 0, 0));
    pe_geometry *g = make(&in, convex);
    assert_int_equal(g->face_count, faces);
    assert_int_equal(g->edge_count, edges);
    assert_int_equal(g->vertex_count - g->edge_count + g->face_count, euler);
    free_geometry(g);
    mesh_free(&in);
}

static void test_flat_triangles_make_one_face(void **state)
{
    (void)state;
    double height;
    check_counts(pl_solid_box(1, 2, 3), true, 6, 12, 2);
    check_counts(pl_solid_tetrahedron(1, &height), true, 4, 6, 2);
    check_counts(pl_solid_icosahedron(1, &height), true, 20, 30, 2);
    check_counts(pl_solid_prism(64, 1, 1), true, 66, 192, 2);
    check_counts(pl_solid_angle(1, 0.3, 0.5), false, 8, 18, 2);
    /* The rings of sides that look up and down are one flat ring each. */
    check_counts(pl_solid_torus(1, 0.25, 24, 12), false, 24 * 10 + 2, 24 * 22, 2);
}

static void test_convex_faces_hold_corners_above_all_vertices(void **state)
{
    (void)state;
    test_mesh in = mesh_of_solid(pl_solid_prism(64, 1, 0.2), pe_v3(3, 4, 5));
    pe_geometry *g = make(&in, true);
    assert_int_equal(g->corner_count, 2 * g->edge_count);
    for (int f = 0; f < g->face_count; ++f) {
        const pe_face *face = &g->faces[f];
        assert_close(pe_length(face->normal), 1, 1e-15, 0);
        pe_vec3 turning = pe_v3(0, 0, 0);
        for (int k = 0; k < face->corner_count; ++k) {
            pe_vec3 v = g->vertices[g->corners[face->first_corner + k]];
            pe_vec3 next =
                g->vertices[g->corners[face->first_corner + (k + 1) % face->corner_count]];
            assert_close(pe_dot(face->normal, v), face->offset, 1e-14, 0);
            turning = pe_add(turning, pe_cross(v, next));
        }
        assert_true(pe_dot(turning, face->normal) > 0); /* counter-clockwise */
        for (int v = 0; v < g->vertex_count; ++v) {
            assert_at_most(pe_dot(face->normal, g->vertices[v]), face->offset + 1e-15);
        }
    }
    free_geometry(g);
    mesh_free(&in);
}

static void test_tree_boxes_hold_triangles_and_child_boxes(void **state)
{
    (void)state;
    test_mesh in = mesh_of_solid(pl_solid_torus(1, 0.25, 25, 10), pe_v3(0, 0, 0));
    pe_geometry *g = make(&in, false);
    int triangles = 0;
    for (int i = 0; i < g->node_count; ++i) {
        const pe_node *node = &g->nodes[i];
        if (node->right < 0) {
            triangles += node->count;
        } else {
            const pe_node *left = &g->nodes[i + 1], *right = &g->nodes[node->right];
            assert_int_equal(left->first, node->first);
            assert_int_equal(left->count + right->count, node->count);
        }
        for (int t = node->first; t < node->first + node->count; ++t) {
            for (int k = 0; k < 3; ++k) {
                pe_vec3 d =
                    pe_rotate(&node->axes, pe_sub(g->vertices[g->triangles[t][k]], node->centre));
                assert_at_most(fabs(d.x), node->half.x + 4e-15);
                assert_at_most(fabs(d.y), node->half.y + 4e-15);
                assert_at_most(fabs(d.z), node->half.z + 4e-15);
                int edge = g->triangle_edges[t][k];
                const pe_edge *e = edge < 0 ? NULL : &g->edges[edge];
                assert_true(e == NULL || e->face[0] == g->triangle_face[t] ||
                            e->face[1] == g->triangle_face[t]);
            }
        }
    }
    assert_int_equal(triangles, g->triangle_count);
    free_geometry(g);
    mesh_free(&in);
}

static void check_refused(const pe_geometry_def *def, const char *part)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry *g;
    pe_error error = {0};
    assert_int_equal(pe_geometry_make(def, &allocator, &g, &error), PE_BAD_ARGUMENT);
    assert_null(g);
    assert_contains(error.message, part);
}

/* Long tetrahedra with the volume length width^2 / 6, in directions whose coordinates are rounded. */
static void test_needles_are_refused_or_measured(void **state)
{
    (void)state;
    const uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    const double length = 1e6;
    int refused = 0, measured = 0;
    check_random random = {7};
    for (int i = 0; i < 400; ++i) {
        const double width = length * pow(10, check_uniform(&random, -10, -1));
        const pe_vec3 any = pe_v3(check_uniform(&random, -1, 1), check_uniform(&random, -1, 1), 1);
        const pe_vec3 along = pe_scale(1 / pe_length(any), any);
        pe_vec3 u, v;
        pe_tangents(along, &u, &v);
        const pe_vec3 vertices[4] = {pe_v3(0, 0, 0), pe_scale(length, along),
                                     pe_madd(pe_scale(0.5 * length, along), width, u),
                                     pe_madd(pe_scale(0.4 * length, along), width, v)};
        const pe_geometry_def def = {
            .vertices = vertices, .triangles = triangles, .vertex_count = 4, .triangle_count = 4};
        pe_allocator allocator = pe_allocator_default();
        pe_geometry *g = NULL;
        pe_error error = {0};
        if (pe_geometry_make(&def, &allocator, &g, &error) == PE_OK) {
            measured += 1;
            assert_close(g->frame.volume, length * width * width / 6, 0, 0.1);
            free_geometry(g);
        } else {
            refused += 1;
            assert_non_null(strstr(error.message, "more than the rounding of their corners"));
        }
    }
    assert_true(refused > 50 && measured > 50);
}

static void test_invalid_solids_are_refused_with_the_place(void **state)
{
    (void)state;
    test_mesh in = mesh_of_solid(pl_solid_box(1, 1, 1), pe_v3(0, 0, 0));
    pe_geometry_def def = mesh_def(&in, false);
    def.triangle_count = 11;
    check_refused(&def, "is open");
    def = mesh_def(&in, false);
    for (int i = 0; i < 12; ++i) {
        uint32_t first = in.triangles[i][0];
        in.triangles[i][0] = in.triangles[i][1];
        in.triangles[i][1] = first;
    }
    check_refused(&def, "counter-clockwise");
    for (int i = 1; i < 12; ++i) {
        uint32_t first = in.triangles[i][0];
        in.triangles[i][0] = in.triangles[i][1];
        in.triangles[i][1] = first;
    }
    check_refused(&def, "same direction");
    in.triangles[0][1] = 8;
    check_refused(&def, "triangle 0: expected three vertices of 8");
    in.vertices[3].y = NAN;
    check_refused(&def, "vertex 3: expected finite numbers");
    def.vertex_count = 3;
    check_refused(&def, "4 vertices");
    mesh_free(&in);

    in = mesh_of_solid(pl_solid_angle(1, 0.3, 0.5), pe_v3(0, 0, 0));
    def = mesh_def(&in, true);
    check_refused(&def, "dented at the edge between vertices");
    mesh_free(&in);
}

static void test_failing_allocations_leave_no_memory(void **state)
{
    (void)state;
    test_mesh in = mesh_of_solid(pl_solid_prism(8, 1, 1), pe_v3(0, 0, 0));
    pe_geometry_def def = mesh_def(&in, true);
    bool made = false;
    for (int k = 0; !made; ++k) {
        counter counting = {.fail_at = k};
        pe_allocator allocator = {count_allocate, count_release, &counting};
        pe_geometry *g;
        pe_status status = pe_geometry_make(&def, &allocator, &g, NULL);
        made = status == PE_OK;
        assert_true(made || status == PE_NO_MEMORY);
        pe_geometry_free(g, &allocator);
        assert_int_equal(counting.living, 0);
    }
    mesh_free(&in);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mass_equals_closed_forms_at_any_offset),
        cmocka_unit_test(test_principal_axes_of_l_equal_two_boxes),
        cmocka_unit_test(test_flat_triangles_make_one_face),
        cmocka_unit_test(test_convex_faces_hold_corners_above_all_vertices),
        cmocka_unit_test(test_tree_boxes_hold_triangles_and_child_boxes),
        cmocka_unit_test(test_needles_are_refused_or_measured),
        cmocka_unit_test(test_invalid_solids_are_refused_with_the_place),
        cmocka_unit_test(test_failing_allocations_leave_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
