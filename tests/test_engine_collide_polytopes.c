/* Spheres, capsules, boxes and hulls against each other: separation, normal and points against
 * brute force, which knows no simplex, no arc and no bound. Apart, the distance is the least over
 * all vertices and faces and all pairs of edges; overlapping, the depth is the least overlap over
 * all normals of faces and crosses of edges, each over all vertices. */
#include "check.h"
#include "collide_convex.h"
#include "geometry/shape.h"
#include "memory.h"

#include <string.h>

enum { MOST_VERTICES = 160, MOST_TRIANGLES = 320 };

typedef struct body {
    pe_shape shape;
    pe_geometry *geometry; /* owned */
    pe_pose pose;
} body;

/* ---- Shapes ---- */

/* Triangles of a solid, to be filled. */
typedef struct soup {
    pe_vec3 vertices[MOST_VERTICES];
    uint32_t triangles[MOST_TRIANGLES][3];
    int vertex_count, triangle_count;
} soup;

static void add_triangle(soup *s, int a, int b, int c)
{
    uint32_t *t = s->triangles[s->triangle_count++];
    t[0] = (uint32_t)a, t[1] = (uint32_t)b, t[2] = (uint32_t)c;
}

/* All triples of points with every other point behind them: of points in general position. */
static void wrap(soup *s)
{
    int n = s->vertex_count;
    for (int i = 0; i < n; ++i) {
        for (int j = i + 1; j < n; ++j) {
            for (int k = j + 1; k < n; ++k) {
                pe_vec3 a = s->vertices[i];
                pe_vec3 normal = pe_cross(pe_sub(s->vertices[j], a), pe_sub(s->vertices[k], a));
                int before = 0, behind = 0;
                for (int m = 0; m < n; ++m) {
                    double x = pe_dot(normal, pe_sub(s->vertices[m], a));
                    before += m != i && m != j && m != k && x > 0;
                    behind += m != i && m != j && m != k && x <= 0;
                }
                if (before == 0) {
                    add_triangle(s, i, j, k);
                } else if (behind == 0) {
                    add_triangle(s, i, k, j);
                }
            }
        }
    }
}

static body hull_of(const soup *s)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_def def = {.vertices = s->vertices,
                           .triangles = (const uint32_t(*)[3])s->triangles,
                           .vertex_count = s->vertex_count,
                           .triangle_count = s->triangle_count,
                           .convex = true};
    body b = {.shape = {.kind = PE_SHAPE_HULL}};
    pe_error error = {0};
    if (pe_geometry_make(&def, &allocator, &b.geometry, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    return b;
}

static void release(body *b)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_free(b->geometry, &allocator);
    b->geometry = NULL;
}

/* A prism about z with n sides, or, with the top moved, something skew. */
static body prism(int n, double radius, double half, double shear)
{
    static soup s;
    s = (soup){.vertex_count = 2 * n};
    for (int i = 0; i < n; ++i) {
        double angle = 2 * 3.141592653589793 * i / n;
        pe_vec3 v = pe_v3(radius * cos(angle), radius * sin(angle), -half);
        s.vertices[i] = v;
        s.vertices[n + i] = pe_v3(v.x + shear, v.y, half);
        int next = (i + 1) % n;
        add_triangle(&s, i, next, n + next);
        add_triangle(&s, i, n + next, n + i);
        if (i > 1) {
            add_triangle(&s, 0, i, i - 1);
            add_triangle(&s, n, n + i - 1, n + i);
        }
    }
    return hull_of(&s);
}

static body box_of(double x, double y, double z)
{
    return (body){.shape = {.kind = PE_SHAPE_BOX, .half_extents = {x, y, z}}};
}

static body capsule_of(double radius, double half)
{
    return (body){.shape = {.kind = PE_SHAPE_CAPSULE, .radius = radius, .half_height = half}};
}

/* The box as a hull, whose principal axes are those of the box in some order. */
static body box_hull(double x, double y, double z)
{
    soup s = {.vertex_count = 8};
    for (int i = 0; i < 8; ++i) {
        s.vertices[i] = pe_v3(i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z);
    }
    static const int quads[6][4] = {{4, 6, 2, 0}, {1, 3, 7, 5}, {1, 5, 4, 0},
                                    {2, 6, 7, 3}, {2, 3, 1, 0}, {4, 5, 7, 6}};
    for (int f = 0; f < 6; ++f) {
        add_triangle(&s, quads[f][0], quads[f][1], quads[f][2]);
        add_triangle(&s, quads[f][0], quads[f][2], quads[f][3]);
    }
    return hull_of(&s);
}

static pe_vec3 random_vector(check_random *random, double low, double high)
{
    double x = check_uniform(random, low, high), y = check_uniform(random, low, high);
    return pe_v3(x, y, check_uniform(random, low, high));
}

static body random_hull(check_random *random)
{
    soup s = {.vertex_count = 4 + (int)check_uniform(random, 0, 14)};
    pe_vec3 stretch = random_vector(random, 0.3, 1.5);
    for (int i = 0; i < s.vertex_count; ++i) {
        pe_vec3 v = random_vector(random, -1, 1);
        s.vertices[i] = pe_mul(stretch, pe_scale(1 / pe_length(v), v));
    }
    wrap(&s);
    return hull_of(&s);
}

enum { SPHERE, CAPSULE, BOX, HULL, PRISM, KINDS };

/* Numbers are drawn one after another: the order of arguments is not the language's to say. */
static body random_body(check_random *random, int kind)
{
    pe_vec3 x = random_vector(random, 0, 1);
    int sides = 3 + (int)check_uniform(random, 0, 6);
    switch (kind) {
    case SPHERE:
        return (body){.shape = {.kind = PE_SHAPE_SPHERE, .radius = 0.2 + 0.6 * x.x}};
    case CAPSULE:
        return capsule_of(0.1 + 0.7 * x.x, 0.1 + 1.4 * x.y);
    case BOX:
        return box_of(0.1 + 1.1 * x.x, 0.1 + 1.1 * x.y, 0.1 + 1.1 * x.z);
    case PRISM:
        return prism(sides, 0.3 + 0.7 * x.x, 0.1 + 0.9 * x.y, 0.5 * x.z);
    default:
        return random_hull(random);
    }
}

static void place(body *b, pe_vec3 position, pe_quat q)
{
    q = pe_quat_unit(q);
    b->pose = (pe_pose){position, q, pe_matrix_of(q)};
}

static pe_quat random_turn(check_random *random)
{
    double q[4];
    check_quaternion(random, q);
    return (pe_quat){q[0], q[1], q[2], q[3]};
}

static void place_at_random(body *b, check_random *random)
{
    pe_vec3 x = random_vector(random, -1, 1);
    place(b, x, random_turn(random));
}

static pe_placed of(const body *b)
{
    return (pe_placed){&b->shape, b->geometry, &b->pose, pe_shape_size(&b->shape, b->geometry)};
}

static double size_of(const body *a, const body *b)
{
    return pe_min(of(a).size, of(b).size);
}

/* ---- Brute force ---- */

/* The core in the world, and the radius of the ball that sweeps it. */
typedef struct core {
    int vertex_count, edge_count, face_count;
    pe_vec3 vertices[MOST_VERTICES];
    int edges[2 * MOST_VERTICES][2];
    struct {
        pe_vec3 normal;
        int count, corners[MOST_VERTICES];
    } faces[MOST_VERTICES];
    double radius;
} core;

static pe_vec3 to_world(const body *b, pe_vec3 x)
{
    return pe_add(b->pose.position, pe_rotate(&b->pose.rotation, x));
}

static void core_of_box(const body *b, core *c)
{
    pe_vec3 e = b->shape.half_extents;
    c->vertex_count = 8;
    for (int i = 0; i < 8; ++i) {
        c->vertices[i] =
            to_world(b, pe_v3(i & 1 ? e.x : -e.x, i & 2 ? e.y : -e.y, i & 4 ? e.z : -e.z));
        for (int k = 0; k < 3; ++k) {
            if (!(i >> k & 1)) {
                c->edges[c->edge_count][0] = i;
                c->edges[c->edge_count++][1] = i | 1 << k;
            }
        }
    }
    for (int k = 0; k < 3; ++k) {
        for (int side = 0; side < 2; ++side) {
            int u = 1 << (k + 1) % 3, v = 1 << (k + 2) % 3, base = side << k;
            int f = c->face_count++, corners[4] = {base, base | u, base | u | v, base | v};
            c->faces[f].normal = pe_scale(side ? 1 : -1, pe_axis(&b->pose.rotation, k));
            c->faces[f].count = 4;
            for (int i = 0; i < 4; ++i) {
                c->faces[f].corners[i] = corners[side ? i : 3 - i];
            }
        }
    }
}

static void core_of_hull(const body *b, core *c)
{
    const pe_geometry *g = b->geometry;
    c->vertex_count = g->vertex_count;
    c->edge_count = g->edge_count;
    c->face_count = g->face_count;
    for (int i = 0; i < g->vertex_count; ++i) {
        c->vertices[i] = to_world(b, g->vertices[i]);
    }
    for (int i = 0; i < g->edge_count; ++i) {
        c->edges[i][0] = g->edges[i].vertex[0];
        c->edges[i][1] = g->edges[i].vertex[1];
    }
    for (int i = 0; i < g->face_count; ++i) {
        c->faces[i].normal = pe_rotate(&b->pose.rotation, g->faces[i].normal);
        c->faces[i].count = g->faces[i].corner_count;
        for (int k = 0; k < g->faces[i].corner_count; ++k) {
            c->faces[i].corners[k] = g->corners[g->faces[i].first_corner + k];
        }
    }
}

static void core_of(const body *b, core *c)
{
    memset(c, 0, sizeof *c);
    c->radius = b->shape.radius;
    if (b->shape.kind == PE_SHAPE_BOX) {
        core_of_box(b, c);
    } else if (b->shape.kind == PE_SHAPE_HULL) {
        core_of_hull(b, c);
    } else if (b->shape.kind == PE_SHAPE_CAPSULE) {
        c->vertex_count = 2;
        c->edge_count = 1;
        c->edges[0][1] = 1;
        c->vertices[0] = to_world(b, pe_v3(0, 0, -b->shape.half_height));
        c->vertices[1] = to_world(b, pe_v3(0, 0, b->shape.half_height));
    } else {
        c->vertex_count = 1;
        c->vertices[0] = b->pose.position;
    }
}

static double farthest(const core *c, pe_vec3 d)
{
    double most = -HUGE_VAL;
    for (int i = 0; i < c->vertex_count; ++i) {
        most = pe_max(most, pe_dot(d, c->vertices[i]));
    }
    return most;
}

/* The gap of the shapes along a unit direction from a to b. */
static double gap_along(const core *a, const core *b, pe_vec3 d)
{
    return -farthest(b, pe_scale(-1, d)) - farthest(a, d) - a->radius - b->radius;
}

static pe_vec3 edge_of(const core *c, int i)
{
    return pe_sub(c->vertices[c->edges[i][1]], c->vertices[c->edges[i][0]]);
}

/* The largest gap over the finitely many directions that can have it when the cores overlap. */
static double gap_by_axes(const core *a, const core *b)
{
    double most = -HUGE_VAL;
    for (int i = 0; i < a->face_count; ++i) {
        most = pe_max(most, gap_along(a, b, a->faces[i].normal));
    }
    for (int i = 0; i < b->face_count; ++i) {
        most = pe_max(most, gap_along(a, b, pe_scale(-1, b->faces[i].normal)));
    }
    for (int i = 0; i < a->edge_count; ++i) {
        for (int j = 0; j < b->edge_count; ++j) {
            pe_vec3 n = pe_cross(edge_of(a, i), edge_of(b, j));
            double length = pe_length(n);
            if (length > 1e-9) {
                n = pe_scale(1 / length, n);
                most = pe_max(most, pe_max(gap_along(a, b, n), gap_along(a, b, pe_scale(-1, n))));
            }
        }
    }
    return most;
}

static double clamped(double x)
{
    return pe_max(0, pe_min(1, x));
}

static double point_to_segment(pe_vec3 x, pe_vec3 p, pe_vec3 q)
{
    pe_vec3 d = pe_sub(q, p);
    double t = clamped(pe_dot(pe_sub(x, p), d) / pe_dot(d, d));
    return pe_length(pe_sub(x, pe_madd(p, t, d)));
}

/* Ends against the other segment, and the inner crossing of the lines. */
static double segment_to_segment(pe_vec3 p, pe_vec3 q, pe_vec3 r, pe_vec3 s)
{
    double least = pe_min(pe_min(point_to_segment(p, r, s), point_to_segment(q, r, s)),
                          pe_min(point_to_segment(r, p, q), point_to_segment(s, p, q)));
    pe_vec3 u = pe_sub(q, p), v = pe_sub(s, r), d = pe_sub(r, p), w = pe_cross(u, v);
    double square = pe_dot(w, w);
    if (square > 1e-20) {
        double along_u = pe_dot(pe_cross(d, v), w) / square;
        double along_v = pe_dot(pe_cross(d, u), w) / square;
        if (along_u >= 0 && along_u <= 1 && along_v >= 0 && along_v <= 1) {
            least = pe_min(least, fabs(pe_dot(d, w)) / sqrt(square));
        }
    }
    return least;
}

/* Height of x over face f of c, if its foot is on the face. */
static double point_to_face(const core *c, int f, pe_vec3 x)
{
    pe_vec3 n = c->faces[f].normal;
    for (int k = 0; k < c->faces[f].count; ++k) {
        pe_vec3 p = c->vertices[c->faces[f].corners[k]];
        pe_vec3 q = c->vertices[c->faces[f].corners[(k + 1) % c->faces[f].count]];
        if (pe_dot(pe_cross(n, pe_sub(q, p)), pe_sub(x, p)) < 0) {
            return HUGE_VAL;
        }
    }
    double height = pe_dot(n, pe_sub(x, c->vertices[c->faces[f].corners[0]]));
    return height > -1e-12 ? pe_max(height, 0) : HUGE_VAL;
}

/* The distance of cores that are apart. */
static double distance_by_features(const core *a, const core *b)
{
    double least = HUGE_VAL;
    for (int swap = 0; swap < 2; ++swap) {
        const core *p = swap ? b : a, *q = swap ? a : b;
        for (int f = 0; f < p->face_count; ++f) {
            for (int v = 0; v < q->vertex_count; ++v) {
                least = pe_min(least, point_to_face(p, f, q->vertices[v]));
            }
        }
    }
    for (int i = 0; i < a->edge_count || i == 0; ++i) {
        for (int j = 0; j < b->edge_count || j == 0; ++j) {
            const pe_vec3 *va = a->vertices, *vb = b->vertices;
            const int *ea = a->edges[i], *eb = b->edges[j];
            least = pe_min(
                least, a->edge_count == 0 && b->edge_count == 0 ? pe_length(pe_sub(va[0], vb[0]))
                       : a->edge_count == 0 ? point_to_segment(va[0], vb[eb[0]], vb[eb[1]])
                       : b->edge_count == 0
                           ? point_to_segment(vb[0], va[ea[0]], va[ea[1]])
                           : segment_to_segment(va[ea[0]], va[ea[1]], vb[eb[0]], vb[eb[1]]));
        }
    }
    return least;
}

/* Signed: the distance, or less the depth. */
static double true_gap(const core *a, const core *b)
{
    double gap = gap_by_axes(a, b), radii = a->radius + b->radius;
    return gap + radii > 0 || (a->face_count == 0 && b->face_count == 0)
               ? distance_by_features(a, b) - radii
               : gap;
}

/* ---- Laws of one pair ---- */

static double least_separation(const pe_hits *hits)
{
    double least = HUGE_VAL;
    for (int i = 0; i < hits->count; ++i) {
        least = pe_min(least, hits->item[i].separation);
    }
    return least;
}

/* How far x lies outside the shape. */
static double outside(const core *c, pe_vec3 x)
{
    double most = -HUGE_VAL;
    for (int f = 0; f < c->face_count; ++f) {
        pe_vec3 on = c->vertices[c->faces[f].corners[0]];
        most = pe_max(most, pe_dot(c->faces[f].normal, pe_sub(x, on)));
    }
    return c->face_count > 0   ? most
           : c->edge_count > 0 ? point_to_segment(x, c->vertices[0], c->vertices[1]) - c->radius
                               : pe_length(pe_sub(x, c->vertices[0])) - c->radius;
}

static void check_points(const core *a, const core *b, const pe_hits *hits, double size)
{
    assert_in_range(hits->count, 1, PE_MAX_POINTS);
    assert_close(pe_length(hits->normal), 1, 1e-12, 0);
    for (int i = 0; i < hits->count; ++i) {
        const pe_hit *hit = &hits->item[i];
        assert_true(pe_is_finite(hit->position) && isfinite(hit->separation));
        pe_vec3 on_a = pe_madd(hit->position, -0.5 * hit->separation, hits->normal);
        pe_vec3 on_b = pe_madd(hit->position, 0.5 * hit->separation, hits->normal);
        /* Nearest points far from each other are known sideways to the root of rounding only. */
        double sideways = 2e-8 * size + 2e-8 * pe_max(0, hit->separation);
        assert_at_most(outside(a, on_a), sideways);
        assert_at_most(outside(b, on_b), sideways);
        for (int k = 0; k < i; ++k) {
            assert_true(hit->feature != hits->item[k].feature);
        }
    }
}

/* Everything that must hold of a pair at every pose. Returns the separation. */
static double check_pair(const body *x, const body *y)
{
    static core a, b; /* large */
    core_of(x, &a);
    core_of(y, &b);
    double size = size_of(x, y), truth = true_gap(&a, &b);
    /* Rounding leaves a length uncertain by eps and the direction of the nearest points by its
     * root: many sizes apart, the distance sets the scale. */
    double within = 1e-9 * size + 2e-12 * pe_max(1, truth);
    double turned = within + 1e-8 * pe_max(0, truth);
    pe_hits hits, swapped, none;
    collide_convex(of(x), of(y), 100, &hits);
    check_points(&a, &b, &hits, size);
    assert_close(least_separation(&hits), truth, within, 0);
    assert_close(gap_along(&a, &b, hits.normal), truth, turned, 0);
    collide_convex(of(y), of(x), 100, &swapped);
    check_points(&b, &a, &swapped, size);
    assert_close(least_separation(&swapped), truth, within, 0);
    /* Nothing comes beyond the margin, and something within it. */
    collide_convex(of(x), of(y), truth - 2 * turned, &none);
    assert_int_equal(none.count, 0);
    collide_convex(of(x), of(y), truth + 2 * within, &none);
    check_points(&a, &b, &none, size);
    return truth;
}

static void
test_separation_is_the_brute_force_one_along_the_normal_of_every_pair_of_kinds(void **state)
{
    (void)state;
    check_random random = {101};
    for (int i = 0; i < KINDS; ++i) {
        for (int j = i; j < KINDS; ++j) {
            int apart = 0, deep = 0;
            for (int pose = 0; pose < 200; ++pose) {
                body a = random_body(&random, i), b = random_body(&random, j);
                place_at_random(&a, &random);
                place_at_random(&b, &random);
                double gap = check_pair(&a, &b);
                /* Then where they just touch, and overlap and clear by little. */
                pe_hits hits;
                collide_convex(of(&a), of(&b), 100, &hits);
                for (int k = 0; k < 3; ++k) {
                    double shift = gap + (k == 0 ? 0 : k == 1 ? 1e-3 : -1e-3) * size_of(&a, &b);
                    body moved = b;
                    moved.pose.position = pe_madd(b.pose.position, -shift, hits.normal);
                    check_pair(&a, &moved);
                }
                apart += gap > 0;
                deep += gap < -0.1;
                release(&a);
                release(&b);
            }
            assert_true(apart > 10);
            assert_true(deep > 10);
        }
    }
}

static const pe_quat STRAIGHT = {.w = 1};

static void test_a_hull_that_is_a_box_separates_as_the_box_does(void **state)
{
    (void)state;
    check_random random = {103};
    for (int i = 0; i < 500; ++i) {
        pe_vec3 e = random_vector(&random, 0.1, 1);
        body a = box_of(e.x, e.y, e.z), hull = box_hull(e.x, e.y, e.z);
        body b = random_body(&random, i % KINDS);
        place_at_random(&a, &random);
        place_at_random(&b, &random);
        place(&hull, a.pose.position,
              pe_quat_product(a.pose.orientation, hull.geometry->frame.orientation));
        pe_hits one, two;
        collide_convex(of(&a), of(&b), 100, &one);
        collide_convex(of(&hull), of(&b), 100, &two);
        assert_close(least_separation(&one), least_separation(&two), 1e-9 * size_of(&a, &b), 0);
        release(&b);
        release(&hull);
    }
}

/* Faces in one plane, edges in line, corners on corners, centres on centres; exactly, and turned by
 * as little as rounding. */
static void test_degenerate_poses_keep_every_law(void **state)
{
    (void)state;
    check_random random = {107};
    const double turns[] = {0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3};
    const pe_vec3 offsets[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, {1, 1, 1}, {0.5, 0, 1}, {0, 0, 3}};
    body shapes[] = {box_of(0.5, 0.5, 0.5),     box_hull(0.5, 0.5, 0.5), prism(6, 0.5, 0.5, 0),
                     capsule_of(0.3, 0.5),      box_of(0.5, 1e-3, 0.5),  box_of(5e-4, 5e-4, 0.5),
                     prism(3, 5e-3, 2.5, 1e-3), capsule_of(1e-3, 0.5)};
    const int count = (int)(sizeof shapes / sizeof *shapes);
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
            for (int t = 0; t < 7; ++t) {
                for (int k = 0; k < 6; ++k) {
                    body a = shapes[i], b = shapes[j];
                    pe_vec3 d = random_vector(&random, -turns[t], turns[t]);
                    place(&a, pe_v3(0, 0, 0), STRAIGHT);
                    place(&b, offsets[k], (pe_quat){1, d.x, d.y, d.z});
                    check_pair(&a, &b);
                }
            }
        }
    }
    for (int i = 0; i < count; ++i) {
        release(&shapes[i]);
    }
}

static void test_nothing_depends_on_the_size_of_things_or_where_they_are(void **state)
{
    (void)state;
    check_random random = {109};
    for (int i = 0; i < 300; ++i) {
        for (double scale = 1e-3; scale < 2e3; scale *= 1e6) {
            pe_vec3 e = random_vector(&random, 0.1, 1), c = pe_scale(scale, e);
            body a = box_of(c.x, c.y, c.z), b = prism(5, 0.7 * scale, 0.4 * scale, 0.1 * scale);
            body one = box_of(e.x, e.y, e.z), two = prism(5, 0.7, 0.4, 0.1);
            pe_vec3 x = random_vector(&random, -1, 1);
            pe_quat q = random_turn(&random), r = random_turn(&random);
            place(&one, pe_v3(0, 0, 0), q);
            place(&two, x, r);
            place(&a, pe_v3(0, 0, 0), q);
            place(&b, pe_scale(scale, x), r);
            pe_hits here, large, there;
            collide_convex(of(&one), of(&two), 100, &here);
            collide_convex(of(&a), of(&b), 100 * scale, &large);
            assert_int_equal(here.count, large.count);
            assert_close(least_separation(&large), scale * least_separation(&here), 1e-9 * scale,
                         0);
            one.pose.position = pe_v3(1e4, -1e4, 1e4);
            two.pose.position = pe_add(x, one.pose.position);
            collide_convex(of(&one), of(&two), 100, &there);
            assert_close(least_separation(&there), least_separation(&here), 1e-11, 0);
            release(&b);
            release(&two);
        }
    }
}

static void test_stacked_hulls_keep_their_points_while_they_sway(void **state)
{
    (void)state;
    check_random random = {113};
    const int sides[] = {3, 4, 8, 64, 75};
    for (int n = 0; n < 5; ++n) {
        body a = prism(sides[n], 0.5, 0.5, 0), b = prism(sides[n], 0.5, 0.5, 0);
        place(&a, pe_v3(0, 0, 0), STRAIGHT);
        pe_hits first, now;
        pe_vec3 up = pe_v3(0, 0, 0);
        for (int i = 0; i < a.geometry->face_count; ++i) {
            bool cap = fabs(2 * a.geometry->faces[i].offset - 1) < 1e-9;
            up = cap ? a.geometry->faces[i].normal : up;
        }
        assert_close(pe_length(up), 1, 1e-12, 0);
        place(&b, up, STRAIGHT);
        collide_convex(of(&a), of(&b), 1e-3, &first);
        assert_int_equal(first.count, sides[n] < 8 ? sides[n] : 8);
        for (int i = 0; i < 200; ++i) {
            pe_vec3 d = random_vector(&random, -1e-9, 1e-9),
                    v = random_vector(&random, -1e-9, 1e-9);
            place(&b, pe_add(up, d), (pe_quat){1, v.x, v.y, v.z});
            collide_convex(of(&a), of(&b), 1e-3, &now);
            assert_int_equal(now.count, first.count);
            int known = 0;
            for (int j = 0; j < now.count; ++j) {
                for (int k = 0; k < first.count; ++k) {
                    known += now.item[j].feature == first.item[k].feature;
                }
            }
            /* Among many corners of equal depth the deepest one may take the last place. */
            assert_true(known >= (sides[n] > 8 ? first.count - 1 : first.count));
        }
        release(&a);
        release(&b);
    }
}

static void test_capsules_lie_on_two_points(void **state)
{
    (void)state;
    body long_one = capsule_of(0.1, 1), short_one = capsule_of(0.2, 0.5), box = box_of(2, 2, 0.5);
    pe_hits hits;
    place(&long_one, pe_v3(0, 0, 0), STRAIGHT);
    place(&short_one, pe_v3(0.3, 0, 0.8), STRAIGHT);
    collide_convex(of(&long_one), of(&short_one), 1e-3, &hits);
    assert_int_equal(hits.count, 2);
    for (int i = 0; i < 2; ++i) { /* what they have beside each other: z from 0.3 to 1 */
        assert_close(hits.item[i].separation, 0, 1e-15, 0);
        assert_close(hits.item[i].position.x, 0.1, 1e-15, 0);
        assert_close(hits.item[i].position.z, i == 0 ? 0.3 : 1, 1e-15, 0);
    }
    /* Over the edge of a box, which carries what is on it. */
    place(&box, pe_v3(0, 0, -0.5), STRAIGHT);
    place(&long_one, pe_v3(1.5, 0, 0.1), (pe_quat){.w = 1, .y = 1});
    collide_convex(of(&box), of(&long_one), 1e-3, &hits);
    assert_int_equal(hits.count, 2);
    assert_close(hits.normal.z, 1, 1e-15, 0);
    assert_close(pe_min(hits.item[0].position.x, hits.item[1].position.x), 0.5, 1e-12, 0);
    assert_close(pe_max(hits.item[0].position.x, hits.item[1].position.x), 2, 1e-12, 0);
}

static void test_cores_that_meet_are_parted_across(void **state)
{
    (void)state;
    body a = capsule_of(0.1, 1), b = capsule_of(0.2, 1), ball = {.shape = {PE_SHAPE_SPHERE}};
    ball.shape.radius = 0.2;
    const pe_quat turns[] = {{1, 0, 0, 0}, {1, 1, 0, 0}, {1, 1e-3, 0, 0}, {1, 1e-13, 0, 0}};
    for (int t = 0; t < 4; ++t) {
        place(&a, pe_v3(0, 0, 0), STRAIGHT);
        place(&b, pe_v3(0, 0, 0.1 * t), turns[t]);
        place(&ball, pe_v3(0, 0, 0.1 * t), STRAIGHT);
        pe_hits hits;
        collide_convex(of(&a), of(&b), 0, &hits);
        assert_close(least_separation(&hits), -0.3, 1e-12, 0);
        assert_close(hits.normal.z, 0, 1e-12, 0);
        collide_convex(of(&ball), of(&a), 0, &hits);
        assert_close(least_separation(&hits), -0.3, 1e-12, 0);
        assert_close(hits.normal.z, 0, 1e-12, 0);
    }
}

static void test_heights_over_a_plane_are_those_of_the_vertices(void **state)
{
    (void)state;
    check_random random = {127};
    for (int i = 0; i < 1000; ++i) {
        pe_vec3 n = random_vector(&random, -1, 1);
        body plane = {.shape = {.kind = PE_SHAPE_PLANE,
                                .normal = pe_scale(1 / pe_length(n), n),
                                .offset = check_uniform(&random, -1, 1)}};
        body b = i % 5 == 0 ? prism(75, 1, 0.1, 0.2) : random_body(&random, i % KINDS);
        place_at_random(&b, &random);
        if (i % 4 == 1) { /* standing, with many corners deep by nearly the same */
            release(&b);
            b = prism(64, 1, 0.1, 0);
            plane.shape.normal = pe_v3(0, 0, 1);
            pe_vec3 d = random_vector(&random, -4e-7, 4e-7);
            pe_quat tilt = {1, d.x, d.y, d.z};
            place(&b, b.pose.position, pe_quat_product(tilt, b.geometry->frame.orientation));
        }
        static core c;
        core_of(&b, &c);
        double truth =
            -farthest(&c, pe_scale(-1, plane.shape.normal)) - plane.shape.offset - c.radius;
        pe_hits hits;
        collide_convex(of(&plane), of(&b), 100, &hits);
        assert_in_range(hits.count, 1, PE_MAX_POINTS);
        assert_close(least_separation(&hits), truth, 1e-9 * of(&b).size, 0);
        for (int j = 0; j < hits.count; ++j) {
            const pe_hit *hit = &hits.item[j];
            pe_vec3 on_b = pe_madd(hit->position, 0.5 * hit->separation, hits.normal);
            assert_at_most(outside(&c, on_b), 1e-12);
            assert_close(pe_dot(plane.shape.normal, on_b) - plane.shape.offset, hit->separation,
                         1e-12, 0);
        }
        collide_convex(of(&plane), of(&b), truth - 1e-8, &hits);
        assert_int_equal(hits.count, 0);
        release(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            test_separation_is_the_brute_force_one_along_the_normal_of_every_pair_of_kinds),
        cmocka_unit_test(test_a_hull_that_is_a_box_separates_as_the_box_does),
        cmocka_unit_test(test_degenerate_poses_keep_every_law),
        cmocka_unit_test(test_nothing_depends_on_the_size_of_things_or_where_they_are),
        cmocka_unit_test(test_stacked_hulls_keep_their_points_while_they_sway),
        cmocka_unit_test(test_capsules_lie_on_two_points),
        cmocka_unit_test(test_cores_that_meet_are_parted_across),
        cmocka_unit_test(test_heights_over_a_plane_are_those_of_the_vertices),
    };
    return cmocka_run_group_tests_name("engine_collide_polytopes", tests, NULL, NULL);
}
