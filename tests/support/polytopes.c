#include "polytopes.h"

enum { MOST_VERTICES = 160, MOST_TRIANGLES = 320 };

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

static placed_shape hull_of(const soup *s)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_def def = {.vertices = s->vertices,
                           .triangles = (const uint32_t(*)[3])s->triangles,
                           .vertex_count = s->vertex_count,
                           .triangle_count = s->triangle_count,
                           .convex = true};
    placed_shape b = {.shape = {.kind = PE_SHAPE_HULL}};
    pe_error error = {0};
    if (pe_geometry_make(&def, &allocator, &b.geometry, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    return b;
}

void release_hull(placed_shape *b)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_free(b->geometry, &allocator);
    b->geometry = NULL;
}

placed_shape hull_prism(int n, double radius, double half, double shear)
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

placed_shape box_of(double x, double y, double z)
{
    return (placed_shape){.shape = {.kind = PE_SHAPE_BOX, .half_extents = {x, y, z}}};
}

placed_shape capsule_of(double radius, double half)
{
    return (placed_shape){
        .shape = {.kind = PE_SHAPE_CAPSULE, .radius = radius, .half_height = half}};
}

placed_shape hull_box(double x, double y, double z)
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

static placed_shape random_hull(check_random *random)
{
    soup s = {.vertex_count = 4 + (int)check_uniform(random, 0, 14)};
    pe_vec3 stretch = random_vector_in(random, 0.3, 1.5);
    for (int i = 0; i < s.vertex_count; ++i) {
        pe_vec3 v = random_vector_in(random, -1, 1);
        s.vertices[i] = pe_mul(stretch, pe_scale(1 / pe_length(v), v));
    }
    wrap(&s);
    return hull_of(&s);
}

/* Numbers are drawn one after another: the order of arguments is not the language's to say. */
placed_shape random_solid(check_random *random, int kind)
{
    pe_vec3 x = random_vector_in(random, 0, 1);
    int sides = 3 + (int)check_uniform(random, 0, 6);
    switch (kind) {
    case SOLID_SPHERE:
        return (placed_shape){.shape = {.kind = PE_SHAPE_SPHERE, .radius = 0.2 + 0.6 * x.x}};
    case SOLID_CAPSULE:
        return capsule_of(0.1 + 0.7 * x.x, 0.1 + 1.4 * x.y);
    case SOLID_BOX:
        return box_of(0.1 + 1.1 * x.x, 0.1 + 1.1 * x.y, 0.1 + 1.1 * x.z);
    case SOLID_PRISM:
        return hull_prism(sides, 0.3 + 0.7 * x.x, 0.1 + 0.9 * x.y, 0.5 * x.z);
    default:
        return random_hull(random);
    }
}

void place_at_random(placed_shape *b, check_random *random)
{
    pe_vec3 x = random_vector_in(random, -1, 1);
    place(b, x, random_turn(random));
}
