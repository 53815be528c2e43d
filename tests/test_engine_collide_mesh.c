/* Meshes: their triangles by brute force, what must not be felt (edges inside a face), what must be
 * (both walls of a corner), and meshes at rest in a world. */
#include "check.h"
#include "collide/collide_mesh.h"
#include "counting_allocator.h"
#include "geometry/shape.h"
#include "solids.h"
#include "world_for_tests.h"

#include <stdlib.h>

static const pe_vec3 up = {0, 0, 1};

/* ---- Meshes */

typedef struct mesh {
    pe_vec3 *vertices;
    uint32_t (*triangles)[3];
    int vertex_count, triangle_count;
} mesh;

static mesh mesh_of(pl_solid solid)
{
    mesh m = {
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

static mesh torus(double ring, double tube, int around, int sides)
{
    return mesh_of(pl_solid_torus(ring, tube, around, sides));
}

/* The prism over a polygon, counter-clockwise, from z = 0 to `height`; the polygon is cut into
 * triangles that are given. */
static mesh prism(const double (*corners)[2], int count, const uint32_t (*cut)[3], int cut_count,
                  double height)
{
    mesh m = {
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

static mesh cube(double side)
{
    double h = 0.5 * side;
    const double corners[4][2] = {{-h, -h}, {h, -h}, {h, h}, {-h, h}};
    static const uint32_t cut[2][3] = {{0, 1, 2}, {0, 2, 3}};
    mesh m = prism(corners, 4, cut, 2, side);
    for (int i = 0; i < m.vertex_count; ++i) {
        m.vertices[i].z -= h;
    }
    return m;
}

/* An L of two bars, 2 m long and 1 m thick, about the corner at the origin; 2 m high along z. */
static mesh angle_bar(void)
{
    static const double corners[6][2] = {{-1, -1}, {2, -1}, {2, 0}, {0, 0}, {0, 2}, {-1, 2}};
    static const uint32_t cut[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
    return prism(corners, 6, cut, 4, 2);
}

/* A floor of n x n squares of 1 m, each cut in two, 1 m thick; its top is z = 0. */
static mesh floor_mesh(int n)
{
    int grid = (n + 1) * (n + 1);
    mesh m = {
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

static pe_geometry_def def_of(const mesh *m)
{
    return (pe_geometry_def){m->vertices, (const uint32_t(*)[3])m->triangles, m->vertex_count,
                             m->triangle_count, false};
}

static void release(mesh *m)
{
    free(m->vertices);
    free(m->triangles);
}

/* Takes the mesh. */
static pe_geometry *geometry_of(mesh m)
{
    pe_geometry_def def = def_of(&m);
    pe_allocator allocator = pe_allocator_default();
    pe_geometry *g = NULL;
    pe_error error = {0};
    if (pe_geometry_make(&def, &allocator, &g, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    release(&m);
    return g;
}

static void free_geometry(pe_geometry *g)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_free(g, &allocator);
}

/* ---- Placed shapes */

typedef struct body {
    pe_shape shape;
    pe_pose pose;
    const pe_geometry *geometry;
} body;

static pe_pose pose_at(pe_vec3 position, pe_quat q)
{
    q = pe_quat_unit(q);
    return (pe_pose){position, q, pe_matrix_of(q)};
}

static const pe_quat unturned = {1, 0, 0, 0};

/* The mesh's own frame at the place, not its centre of mass. */
static body mesh_at(const pe_geometry *g, pe_vec3 position, pe_quat q)
{
    body b = {.shape = {.kind = PE_SHAPE_MESH}, .geometry = g};
    pe_pose frame = pose_at(position, q);
    b.pose = pose_at(pe_add(position, pe_rotate(&frame.rotation, g->frame.centre)),
                     pe_quat_product(frame.orientation, g->frame.orientation));
    return b;
}

static body shape_at(pe_shape shape, pe_vec3 position, pe_quat q)
{
    return (body){.shape = shape, .pose = pose_at(position, q)};
}

static body box_at(pe_vec3 half, pe_vec3 position, pe_quat q)
{
    return shape_at((pe_shape){.kind = PE_SHAPE_BOX, .half_extents = half}, position, q);
}

static body sphere_at(double radius, pe_vec3 position)
{
    return shape_at((pe_shape){.kind = PE_SHAPE_SPHERE, .radius = radius}, position, unturned);
}

static pe_placed placed(const body *b)
{
    return (pe_placed){&b->shape, b->geometry, &b->pose, pe_shape_size(&b->shape, b->geometry)};
}

typedef struct found {
    int count;
    pe_hits patch[PE_MAX_PATCHES];
} found;

static found collide(const body *a, const body *b, double margin)
{
    found f;
    pe_arena arena = {0};
    pe_allocator allocator = pe_allocator_default();
    f.count = pe_collide(placed(a), placed(b), margin, (pe_workspace){&arena, &allocator}, f.patch);
    pe_arena_free(&arena, &allocator);
    assert_true(f.count >= 0 && f.count <= PE_MAX_PATCHES);
    return f;
}

static double least_of(const found *f)
{
    double least = HUGE_VAL;
    for (int i = 0; i < f->count; ++i) {
        for (int k = 0; k < f->patch[i].count; ++k) {
            least = pe_min(least, f->patch[i].item[k].separation);
        }
    }
    return least;
}

static pe_quat random_turn(check_random *random)
{
    double q[4];
    check_quaternion(random, q);
    return (pe_quat){q[0], q[1], q[2], q[3]};
}

static pe_vec3 random_vector(check_random *random, double reach)
{
    double x = check_uniform(random, -reach, reach), y = check_uniform(random, -reach, reach);
    return pe_v3(x, y, check_uniform(random, -reach, reach));
}

/* ---- Trees */

static double distance_of_facets(const pe_facet *a, const pe_facet *b)
{
    double least = HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            pe_vec3 u = pe_sub(a->x[(i + 1) % 3], a->x[i]), v = pe_sub(b->x[(j + 1) % 3], b->x[j]);
            double s, t;
            pe_segments_nearest(a->x[i], u, b->x[j], v, &s, &t);
            least =
                pe_min(least, pe_length(pe_sub(pe_madd(a->x[i], s, u), pe_madd(b->x[j], t, v))));
        }
    }
    for (int side = 0; side < 2; ++side) {
        const pe_facet *over = side == 0 ? a : b, *of = side == 0 ? b : a;
        for (int k = 0; k < 3; ++k) {
            double height = pe_dot(over->normal, of->x[k]) - over->offset;
            least = pe_facet_holds(over, of->x[k], 0) ? pe_min(least, fabs(height)) : least;
        }
    }
    return least;
}

typedef struct tally {
    const pe_solid_pair *pair;
    double bound;
    long near; /* pairs within the bound, by their exact distance */
} tally;

static bool count_near(void *context, pe_facet *a, pe_facet *b)
{
    tally *t = context;
    t->near += distance_of_facets(a, b) <= t->bound;
    return true;
}

/* However they are found, and whatever direction parts the hulls. */
static void test_every_two_triangles_within_the_bound_are_handed_over(void **state)
{
    (void)state;
    pe_geometry *g = geometry_of(torus(0.35, 0.15, 10, 6));
    check_random random = {5};
    pe_arena arena = {0};
    pe_allocator allocator = pe_allocator_default();
    long total = 0;
    int gathered = 0;
    for (int i = 0; i < 60; ++i) {
        body a = mesh_at(g, pe_v3(0, 0, 0), random_turn(&random));
        body b = mesh_at(g, random_vector(&random, 0.6), random_turn(&random));
        pe_solid_pair pair;
        pe_solid_pair_make(placed(&a), placed(&b), &pair);
        double bound = check_uniform(&random, 0, 0.05);
        tally want = {.pair = &pair, .bound = bound};
        for (int m = 0; m < g->triangle_count; ++m) {
            pe_facet fa, fb;
            pe_facet_of_a(&pair, m, &fa);
            for (int n = 0; n < g->triangle_count; ++n) {
                pe_solid_facet(&pair.b, n, &fb);
                count_near(&want, &fa, &fb);
            }
        }
        tally plain = {.pair = &pair, .bound = bound};
        pe_near_facets(&pair, &bound, count_near, &plain);
        assert_int_equal(plain.near, want.near);
        if (!pe_solid_pair_part(&pair, bound)) {
            assert_int_equal(want.near, 0);
            continue;
        }
        tally parted = {.pair = &pair, .bound = bound};
        pe_near_facets(&pair, &bound, count_near, &parted);
        assert_int_equal(parted.near, want.near);
        assert_true(pe_solid_pair_gather(&pair, bound, (pe_workspace){&arena, &allocator}));
        gathered += pair.near_a != NULL;
        tally each = {.pair = &pair, .bound = bound};
        pe_near_facets(&pair, &bound, count_near, &each);
        assert_int_equal(each.near, want.near);
        total += want.near;
    }
    assert_true(total > 200 && gathered > 10);
    pe_arena_free(&arena, &allocator);
    free_geometry(g);
}

/* Winding number by solid angles, Van Oosterom and Strackee 1983. */
static bool winds_around(const pe_geometry *g, pe_vec3 x)
{
    double sum = 0;
    for (int i = 0; i < g->triangle_count; ++i) {
        pe_vec3 r[3];
        double l[3];
        for (int k = 0; k < 3; ++k) {
            r[k] = pe_sub(g->vertices[g->triangles[i][k]], x);
            l[k] = pe_length(r[k]);
        }
        sum += 2 * atan2(pe_dot(r[0], pe_cross(r[1], r[2])),
                         l[0] * l[1] * l[2] + pe_dot(r[0], r[1]) * l[2] +
                             pe_dot(r[1], r[2]) * l[0] + pe_dot(r[2], r[0]) * l[1]);
    }
    return sum > 6.28;
}

static void test_a_point_is_inside_exactly_when_the_surface_winds_around_it(void **state)
{
    (void)state;
    pe_geometry *both[2] = {geometry_of(torus(0.35, 0.15, 14, 8)), geometry_of(angle_bar())};
    check_random random = {9};
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
        const pe_geometry *g = both[i % 2];
        pe_solid solid = pe_solid_of_geometry(g);
        pe_vec3 x = random_vector(&random, 0.7 * g->bounding_radius);
        bool truth = winds_around(g, x);
        assert_int_equal(pe_solid_holds(&solid, x), truth);
        inside += truth;
    }
    assert_true(inside > 300);
    free_geometry(both[0]);
    free_geometry(both[1]);
}

/* ---- Contacts */

/* A cube upon a cube, moved sideways: the corners of the rectangle where they overlap. */
static void test_cubes_face_to_face_touch_at_the_corners_of_their_overlap(void **state)
{
    (void)state;
    pe_geometry *g = geometry_of(cube(1));
    check_random random = {3};
    for (int i = 0; i < 500; ++i) {
        double dx = check_uniform(&random, -0.9, 0.9), dy = check_uniform(&random, -0.9, 0.9);
        double gap = check_uniform(&random, -1e-3, 1e-3);
        gap = i % 3 == 0 ? 0 : gap;
        dx = i % 5 == 0 ? 0 : dx;
        body lower = mesh_at(g, pe_v3(0, 0, 0), unturned);
        body other = i % 2 == 0 ? mesh_at(g, pe_v3(dx, dy, 1 + gap), unturned)
                                : box_at(pe_v3(0.5, 0.5, 0.5), pe_v3(dx, dy, 1 + gap), unturned);
        found f = collide(&lower, &other, 0.01);
        assert_int_equal(f.count, 1);
        assert_int_equal(f.patch[0].count, 4);
        assert_close(f.patch[0].normal.z, 1, 1e-12, 0);
        double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        for (int k = 0; k < 4; ++k) {
            const pe_hit *h = &f.patch[0].item[k];
            assert_close(h->separation, gap, 1e-12, 0);
            assert_close(h->position.z, 0.5 + 0.5 * gap, 1e-12, 0);
            low[0] = pe_min(low[0], h->position.x), high[0] = pe_max(high[0], h->position.x);
            low[1] = pe_min(low[1], h->position.y), high[1] = pe_max(high[1], h->position.y);
        }
        assert_close(high[0] - low[0], 1 - fabs(dx), 1e-8, 0);
        assert_close(high[1] - low[1], 1 - fabs(dy), 1e-8, 0);
    }
    free_geometry(g);
}

/* Bars laid crosswise have no vertex in each other's face. */
static void test_crossed_bars_touch_at_the_corners_of_their_overlap(void **state)
{
    (void)state;
    static const double corners[4][2] = {{-2, -0.25}, {2, -0.25}, {2, 0.25}, {-2, 0.25}};
    static const uint32_t cut[2][3] = {{0, 1, 2}, {0, 2, 3}};
    pe_geometry *g = geometry_of(prism(corners, 4, cut, 2, 0.5));
    for (int i = -1; i < 2; ++i) {
        double gap = 1e-3 * i;
        body lower = mesh_at(g, pe_v3(0, 0, 0), unturned);
        body upper = mesh_at(g, pe_v3(0, 0, 0.5 + gap), (pe_quat){1, 0, 0, 1});
        found f = collide(&lower, &upper, 0.01);
        assert_int_equal(f.count, 1);
        assert_int_equal(f.patch[0].count, 4);
        for (int k = 0; k < 4; ++k) {
            const pe_hit *h = &f.patch[0].item[k];
            assert_close(h->separation, gap, 1e-12, 0);
            assert_close(fabs(h->position.x), 0.25, 1e-8, 0);
            assert_close(fabs(h->position.y), 0.25, 1e-8, 0);
        }
    }
    free_geometry(g);
}

static bool pushes_along(const found *f, pe_vec3 n, double depth)
{
    for (int i = 0; i < f->count; ++i) {
        for (int k = 0; k < f->patch[i].count; ++k) {
            if (pe_dot(f->patch[i].normal, n) > 1 - 1e-9 &&
                fabs(f->patch[i].item[k].separation + depth) < 1e-9) {
                return true;
            }
        }
    }
    return false;
}

/* A cube in the inner corner of an L, into both walls, deeper into the one or the other. */
static void test_a_cube_in_a_corner_feels_both_walls(void **state)
{
    (void)state;
    pe_geometry *bar = geometry_of(angle_bar()), *small = geometry_of(cube(1));
    static const double depths[] = {-1e-9, 0, 1e-9, 1e-6, 1e-4, 1e-3};
    for (int i = 0; i < 36; ++i) {
        double x = depths[i / 6], y = depths[i % 6];
        pe_vec3 at = pe_v3(0.5 - x, 0.5 - y, 1);
        body corner = mesh_at(bar, pe_v3(0, 0, 0), unturned);
        body one = mesh_at(small, at, unturned), other = box_at(pe_v3(0.5, 0.5, 0.5), at, unturned);
        found f = collide(&corner, &one, 0.01), g = collide(&other, &corner, 0.01);
        assert_true(pushes_along(&f, pe_v3(1, 0, 0), x) && pushes_along(&f, pe_v3(0, 1, 0), y));
        assert_true(pushes_along(&g, pe_v3(-1, 0, 0), x) && pushes_along(&g, pe_v3(0, -1, 0), y));
        int against_x = 0, against_y = 0;
        for (int p = 0; p < f.count; ++p) {
            against_x += f.patch[p].normal.x > 0.5 ? f.patch[p].count : 0;
            against_y += f.patch[p].normal.y > 0.5 ? f.patch[p].count : 0;
        }
        assert_int_equal(against_x, 4);
        assert_int_equal(against_y, 4);
    }
    free_geometry(bar);
    free_geometry(small);
}

static void slide(const pe_geometry *floor, body *slider, double height, check_random *random)
{
    body ground = mesh_at(floor, pe_v3(0, 0, 0), unturned);
    double gap = check_uniform(random, -1e-4, 1e-4);
    slider->pose.position =
        pe_v3(check_uniform(random, -2, 2), check_uniform(random, -2, 2), height + gap);
    found f = collide(&ground, slider, 1e-3);
    assert_int_equal(f.count, 1);
    assert_close(f.patch[0].normal.z, 1, 1e-9, 0);
    assert_close(least_of(&f), gap, 1e-12, 0);
}

static void test_what_slides_over_a_flat_floor_feels_none_of_its_inner_edges(void **state)
{
    (void)state;
    pe_geometry *floor = geometry_of(floor_mesh(6)), *small = geometry_of(cube(0.8));
    check_random random = {21};
    for (int i = 0; i < 1500; ++i) {
        double turn = check_uniform(&random, 0, 6.28);
        pe_quat q = {cos(turn), 0, 0, sin(turn)};
        body ball = sphere_at(0.4, pe_v3(0, 0, 0));
        body box = box_at(pe_v3(0.4, 0.4, 0.4), pe_v3(0, 0, 0), q);
        body block = mesh_at(small, pe_v3(0, 0, 0), q);
        body pin = shape_at((pe_shape){.kind = PE_SHAPE_CAPSULE, .radius = 0.1, .half_height = 0.7},
                            pe_v3(0, 0, 0), pe_quat_product(q, (pe_quat){1, 1, 0, 0}));
        body can =
            shape_at((pe_shape){.kind = PE_SHAPE_CYLINDER, .radius = 0.5, .half_height = 0.2},
                     pe_v3(0, 0, 0), q);
        slide(floor, &ball, 0.4, &random);
        slide(floor, &box, 0.4, &random);
        slide(floor, &block, 0.4, &random);
        slide(floor, &pin, 0.1, &random);
        slide(floor, &can, 0.2, &random);
    }
    free_geometry(floor);
    free_geometry(small);
}

/* The smooth torus about z that the mesh of ring 0.35 and tube 0.15 stands for: to x from the
 * nearest point of its ring. */
static pe_vec3 from_ring(const body *b, pe_vec3 x)
{
    pe_mat3 frame = pe_matrix_of(
        pe_quat_product(b->pose.orientation, pe_quat_conjugate(b->geometry->frame.orientation)));
    pe_vec3 y = pe_unrotate(&frame, pe_sub(x, b->pose.position));
    double r = sqrt(y.x * y.x + y.y * y.y);
    return pe_rotate(&frame, pe_sub(y, pe_v3(0.35 * y.x / r, 0.35 * y.y / r, 0)));
}

static pe_vec3 out_of_torus(const body *b, pe_vec3 x)
{
    pe_vec3 out = from_ring(b, x);
    return pe_scale(1 / pe_length(out), out);
}

/* The gap of two such tori, from points along the ring of the first. */
static double gap_of_tori(const body *a, const body *b)
{
    enum { POINTS = 2000 };
    pe_mat3 frame = pe_matrix_of(
        pe_quat_product(a->pose.orientation, pe_quat_conjugate(a->geometry->frame.orientation)));
    double least = HUGE_VAL;
    for (int i = 0; i < POINTS; ++i) {
        double angle = 6.283185307179586 * i / POINTS;
        pe_vec3 x = pe_v3(0.35 * cos(angle), 0.35 * sin(angle), 0);
        x = pe_add(a->pose.position, pe_rotate(&frame, x));
        least = pe_min(least, pe_length(from_ring(b, x)));
    }
    return least - 2 * 0.15;
}

/* Rings through each other, touching or overlapping by up to a fifth of the tube: no normal leads
 * out of the one against the way out of the other. */
static void test_linked_rings_are_never_pulled_through_each_other(void **state)
{
    (void)state;
    pe_geometry *g = geometry_of(torus(0.35, 0.15, 25, 12));
    check_random random = {77};
    int contacts = 0;
    for (int i = 0; i < 400; ++i) {
        body a = mesh_at(g, pe_v3(0, 0, 0), unturned);
        pe_quat q = {1, 1 + check_uniform(&random, -0.3, 0.3), check_uniform(&random, -0.3, 0.3),
                     0};
        body b = mesh_at(
            g,
            pe_v3(0.35 + check_uniform(&random, -0.1, 0.1), 0, check_uniform(&random, -0.1, 0.1)),
            q);
        if (gap_of_tori(&a, &b) < -0.03) {
            continue;
        }
        found f = collide(&a, &b, 0.01);
        for (int p = 0; p < f.count; ++p) {
            for (int k = 0; k < f.patch[p].count; ++k) {
                pe_vec3 x = f.patch[p].item[k].position, n = f.patch[p].normal;
                assert_true(pe_dot(n, out_of_torus(&a, x)) > 0.5);
                assert_true(pe_dot(n, out_of_torus(&b, x)) < -0.5);
                contacts += 1;
            }
        }
    }
    assert_true(contacts > 200);
    free_geometry(g);
}

/* A vertex of a torus in the face of a cube: its depth below the face, by no tree. */
static void test_a_torus_on_a_cube_is_as_deep_as_its_lowest_vertices(void **state)
{
    (void)state;
    pe_geometry *ring = geometry_of(torus(0.35, 0.15, 25, 10)), *block = geometry_of(cube(2));
    check_random random = {31};
    for (int i = 0; i < 2000; ++i) {
        pe_quat q = random_turn(&random);
        body b = mesh_at(block, pe_v3(0, 0, -1), unturned), a = mesh_at(ring, up, q);
        double lowest = HUGE_VAL;
        for (int k = 0; k < ring->vertex_count; ++k) {
            lowest = pe_min(lowest, pe_rotate(&a.pose.rotation, ring->vertices[k]).z);
        }
        double gap = check_uniform(&random, -0.05, 0.02);
        a.pose.position = pe_v3(0, 0, gap - lowest);
        found f = collide(&b, &a, 0.03);
        assert_true(f.count >= 1);
        assert_close(least_of(&f), gap, 1e-12, 0);
        assert_close(f.patch[0].normal.z, 1, 1e-9, 0);
        assert_int_equal(f.count, 1);
    }
    free_geometry(ring);
    free_geometry(block);
}

static void test_a_wide_margin_finds_the_nearest_features_and_no_crowd(void **state)
{
    (void)state;
    pe_geometry *g = geometry_of(torus(0.35, 0.15, 100, 25));
    body a = mesh_at(g, pe_v3(0, 0, 0), unturned), b = mesh_at(g, pe_v3(0, 0, 5), unturned);
    found f = collide(&a, &b, 100);
    assert_true(f.count >= 1);
    assert_true(least_of(&f) > 4.69 && least_of(&f) < 4.71);
    assert_int_equal(collide(&a, &b, 4.6).count, 0);
    free_geometry(g);
}

static void test_a_solid_wholly_inside_another_is_pushed_out(void **state)
{
    (void)state;
    pe_geometry *block = geometry_of(cube(2)), *ring = geometry_of(torus(0.35, 0.15, 12, 8));
    body outer = mesh_at(block, pe_v3(0, 0, 0), unturned);
    body inner[4] = {
        mesh_at(ring, pe_v3(0, 0, 0.4), unturned),
        box_at(pe_v3(0.2, 0.2, 0.2), pe_v3(0, 0, 0.4), unturned),
        sphere_at(0.2, pe_v3(0, 0, 0.4)),
        shape_at((pe_shape){.kind = PE_SHAPE_CYLINDER, .radius = 0.2, .half_height = 0.2},
                 pe_v3(0, 0, 0.4), unturned),
    };
    for (int i = 0; i < 4; ++i) {
        found f = collide(&outer, &inner[i], 1e-3);
        assert_true(f.count >= 1);
        assert_true(least_of(&f) < -0.5);
        /* The nearest face is the top one. */
        assert_close(f.patch[0].normal.z, 1, 1e-9, 0);
    }
    free_geometry(block);
    free_geometry(ring);
}

static void test_features_stay_while_a_stack_sways(void **state)
{
    (void)state;
    pe_geometry *g = geometry_of(cube(1)), *ring = geometry_of(torus(0.35, 0.15, 25, 10));
    body lower = mesh_at(g, pe_v3(0, 0, 0), unturned);
    pe_shape plane = {.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}};
    body ground = shape_at(plane, pe_v3(0, 0, 0), unturned);
    check_random random = {13};
    double bottom = HUGE_VAL;
    for (int k = 0; k < ring->vertex_count; ++k) {
        bottom = pe_min(bottom, pe_add(ring->vertices[k], ring->frame.centre).z);
    }
    found first[2] = {{.count = 0}};
    for (int i = 0; i < 300; ++i) {
        pe_vec3 d = i == 0 ? pe_v3(0, 0, 0) : random_vector(&random, 1e-9);
        pe_vec3 r = i == 0 ? pe_v3(0, 0, 0) : random_vector(&random, 0.5e-9);
        pe_quat q = {1, r.x, r.y, r.z};
        body upper = mesh_at(g, pe_add(pe_v3(0.2, 0.3, 1), d), q);
        body hoop = mesh_at(ring, pe_add(pe_v3(0, 0, -bottom), d), q);
        found now[2] = {collide(&lower, &upper, 0.01), collide(&ground, &hoop, 0.01)};
        for (int k = 0; k < 2; ++k) {
            first[k] = i == 0 ? now[k] : first[k];
            assert_int_equal(now[k].count, first[k].count);
            for (int p = 0; p < now[k].count; ++p) {
                assert_int_equal(now[k].patch[p].count, first[k].patch[p].count);
                for (int m = 0; m < now[k].patch[p].count; ++m) {
                    assert_true(now[k].patch[p].item[m].feature ==
                                first[k].patch[p].item[m].feature);
                }
            }
        }
    }
    free_geometry(g);
    free_geometry(ring);
}

static void test_any_allocation_may_fail(void **state)
{
    (void)state;
    pe_geometry *g = geometry_of(torus(0.35, 0.15, 25, 10));
    body a = mesh_at(g, pe_v3(0, 0, 0), unturned);
    body b = mesh_at(g, pe_v3(0.1, 0, 0.05), (pe_quat){1, 0.2, 0.1, 0});
    counter c = {.fail_at = -1};
    pe_allocator allocator = {count_allocate, count_release, &c};
    int all = 0;
    for (int k = -1; k < all; ++k) {
        c = (counter){.fail_at = k};
        pe_arena arena = {0};
        pe_hits patches[PE_MAX_PATCHES];
        int count =
            pe_collide(placed(&a), placed(&b), 0.01, (pe_workspace){&arena, &allocator}, patches);
        all = k < 0 ? c.calls : all;
        assert_true(k < 0 ? count > 0 : count == -1);
        pe_arena_free(&arena, &allocator);
        assert_int_equal(c.living, 0);
    }
    assert_true(all >= 3);
    free_geometry(g);
}

/* ---- Meshes in a world */

static pe_geometry_id add_geometry(pe_world *world, mesh m)
{
    pe_geometry_def def = def_of(&m);
    pe_geometry_id id;
    pe_error error = {0};
    if (pe_geometry_create(world, &def, &id, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    release(&m);
    return id;
}

static pe_body_id add_mesh(pe_world *world, pe_geometry_id g, pe_vec3 position, pe_quat q)
{
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){.kind = PE_SHAPE_MESH, .geometry = g};
    def.position = position;
    def.orientation = pe_quat_unit(q);
    return add_body(world, &def);
}

static void test_meshes_rest_on_a_plane_and_on_each_other(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_material_id wood = add_material(world, 0.5, 0);
    add_plane(world, up, wood);
    pe_geometry_id small = add_geometry(world, cube(1)), bar = add_geometry(world, angle_bar());
    pe_geometry_id ring = add_geometry(world, torus(1, 0.3, 24, 8));
    double height = pl_torus_half_height(0.3, 8);
    pe_vec3 places[5] = {{0, 0, 0.5}, {0, 0, 1.5}, {0.2, 0.1, 2.5}, {5, 0, 0}, {-5, 0, height}};
    pe_body_id ids[5];
    for (int i = 0; i < 5; ++i) {
        pe_geometry_id g = i < 3 ? small : i == 3 ? bar : ring;
        ids[i] = add_mesh(world, g, places[i], unturned);
    }
    for (int i = 0; i < 600; ++i) {
        step(world, 1.0 / 60);
    }
    for (int i = 0; i < 5; ++i) {
        pe_body_state s = state_of(world, ids[i]);
        assert_close(s.position.x, places[i].x, 1e-6, 0);
        assert_close(s.position.y, places[i].y, 1e-6, 0);
        assert_close(s.position.z, places[i].z, 1e-6, 0);
    }
    pe_world_destroy(world);
}

/* The upper ring is held; the lower one hangs in it, swings, and stays in it. */
static void test_a_ring_hangs_in_a_ring(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_geometry_id ring = add_geometry(world, torus(1, 0.2, 25, 10));
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){.kind = PE_SHAPE_MESH, .geometry = ring};
    def.is_static = true;
    def.orientation = pe_quat_unit((pe_quat){1, 1, 0, 0});
    add_body(world, &def);
    pe_body_id lower = add_mesh(world, ring, pe_v3(0.1, 0, -1.3), (pe_quat){1, 1, 1, 1});
    for (int i = 0; i < 300; ++i) {
        pe_step_stats stats = step(world, 1.0 / 60);
        assert_at_most(stats.penetration_left, 0.02);
    }
    pe_body_state s = state_of(world, lower);
    /* The inner sides of both tubes touch: the middles are 2 (1 - 0.2) apart, about. */
    assert_close(s.position.z, -1.6, 0.1, 0);
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_two_triangles_within_the_bound_are_handed_over),
        cmocka_unit_test(test_a_point_is_inside_exactly_when_the_surface_winds_around_it),
        cmocka_unit_test(test_cubes_face_to_face_touch_at_the_corners_of_their_overlap),
        cmocka_unit_test(test_crossed_bars_touch_at_the_corners_of_their_overlap),
        cmocka_unit_test(test_a_cube_in_a_corner_feels_both_walls),
        cmocka_unit_test(test_what_slides_over_a_flat_floor_feels_none_of_its_inner_edges),
        cmocka_unit_test(test_linked_rings_are_never_pulled_through_each_other),
        cmocka_unit_test(test_a_torus_on_a_cube_is_as_deep_as_its_lowest_vertices),
        cmocka_unit_test(test_a_wide_margin_finds_the_nearest_features_and_no_crowd),
        cmocka_unit_test(test_a_solid_wholly_inside_another_is_pushed_out),
        cmocka_unit_test(test_features_stay_while_a_stack_sways),
        cmocka_unit_test(test_any_allocation_may_fail),
        cmocka_unit_test(test_meshes_rest_on_a_plane_and_on_each_other),
        cmocka_unit_test(test_a_ring_hangs_in_a_ring),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
