#include "solids.h"

#include "base/trigonometry.h"

#include <math.h>
#include <stdlib.h>

static void put_vertex(pl_solid *s, double x, double y, double z)
{
    double *v = s->vertices[s->vertex_count++];
    v[0] = x, v[1] = y, v[2] = z;
}

static void put_triangle(pl_solid *s, int a, int b, int c)
{
    int *t = s->triangles[s->triangle_count++];
    t[0] = a, t[1] = b, t[2] = c;
}

static void put_quad(pl_solid *s, int a, int b, int c, int d)
{
    put_triangle(s, a, b, c);
    put_triangle(s, a, c, d);
}

/* Room for so many; false, and nothing kept, when out of memory. */
static bool take(pl_solid *s, int vertices, int triangles)
{
    *s = (pl_solid){.vertices = calloc((size_t)vertices, sizeof *s->vertices),
                    .triangles = calloc((size_t)triangles, sizeof *s->triangles)};
    if (s->vertices == NULL || s->triangles == NULL) {
        pl_solid_free(s);
        return false;
    }
    return true;
}

void pl_solid_free(pl_solid *solid)
{
    free(solid->vertices);
    free(solid->triangles);
    *solid = (pl_solid){0};
}

pl_solid pl_solid_box(double half_x, double half_y, double half_z)
{
    pl_solid s;
    if (take(&s, 8, 12)) {
        for (int i = 0; i < 8; ++i) {
            put_vertex(&s, i & 1 ? half_x : -half_x, i & 2 ? half_y : -half_y,
                       i & 4 ? half_z : -half_z);
        }
        put_quad(&s, 0, 2, 3, 1);
        put_quad(&s, 4, 5, 7, 6);
        put_quad(&s, 0, 1, 5, 4);
        put_quad(&s, 2, 6, 7, 3);
        put_quad(&s, 0, 4, 6, 2);
        put_quad(&s, 1, 3, 7, 5);
    }
    return s;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; ++k) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        c[k] = a[i] * b[j] - a[j] * b[i];
    }
}

static void make_unit(double v[3])
{
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; ++k) {
        v[k] /= length;
    }
}

/* Turns the solid so that its first triangle lies below, level, at z = -*height. */
static void lay_on_first_face(pl_solid *s, double *height)
{
    double axis[3][3]; /* rows: the new axes in the old ones */
    double u[3], v[3], down[3];
    const int *t = s->triangles[0];
    for (int k = 0; k < 3; ++k) {
        u[k] = s->vertices[t[1]][k] - s->vertices[t[0]][k];
        v[k] = s->vertices[t[2]][k] - s->vertices[t[0]][k];
    }
    cross(u, v, down);
    make_unit(down);
    make_unit(u);
    for (int k = 0; k < 3; ++k) {
        axis[0][k] = u[k];
        axis[2][k] = -down[k];
    }
    cross(axis[2], axis[0], axis[1]);
    *height = dot(down, s->vertices[t[0]]);
    for (int i = 0; i < s->vertex_count; ++i) {
        double turned[3];
        for (int k = 0; k < 3; ++k) {
            turned[k] = dot(axis[k], s->vertices[i]);
        }
        for (int k = 0; k < 3; ++k) {
            s->vertices[i][k] = turned[k];
        }
    }
    for (int k = 0; k < 3; ++k) {
        s->vertices[s->triangles[0][k]][2] = -*height; /* level to the last digit */
    }
}

pl_solid pl_solid_tetrahedron(double edge, double *height)
{
    pl_solid s;
    if (take(&s, 4, 4)) {
        double c = edge / sqrt(8); /* four corners of a cube */
        put_vertex(&s, c, c, c);
        put_vertex(&s, c, -c, -c);
        put_vertex(&s, -c, c, -c);
        put_vertex(&s, -c, -c, c);
        put_triangle(&s, 0, 1, 2);
        put_triangle(&s, 0, 3, 1);
        put_triangle(&s, 0, 2, 3);
        put_triangle(&s, 1, 3, 2);
        lay_on_first_face(&s, height);
    }
    return s;
}

pl_solid pl_solid_icosahedron(double edge, double *height)
{
    static const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    pl_solid s;
    if (take(&s, 12, 20)) {
        /* Three golden rectangles. */
        double a = edge / 2, b = a * (1 + sqrt(5)) / 2;
        for (int k = 0; k < 3; ++k) {
            for (int i = 0; i < 4; ++i) {
                double v[3] = {0, 0, 0};
                v[k] = i & 1 ? a : -a;
                v[(k + 1) % 3] = i & 2 ? -b : b;
                put_vertex(&s, v[0], v[1], v[2]);
            }
        }
        for (int i = 0; i < 20; ++i) {
            put_triangle(&s, faces[i][0], faces[i][1], faces[i][2]);
        }
        lay_on_first_face(&s, height);
    }
    return s;
}

pl_solid pl_solid_prism(int sides, double radius, double half_height)
{
    pl_solid s;
    if (take(&s, 2 * sides, 4 * sides - 4)) {
        for (int i = 0; i < sides; ++i) {
            double x, y;
            pl_circle_point(2 * i + 1, 2 * sides, &x, &y);
            put_vertex(&s, radius * x, radius * y, -half_height);
            put_vertex(&s, radius * x, radius * y, half_height);
        }
        for (int i = 0; i < sides; ++i) {
            int next = (i + 1) % sides;
            put_quad(&s, 2 * i, 2 * next, 2 * next + 1, 2 * i + 1);
        }
        for (int i = 1; i + 1 < sides; ++i) {
            put_triangle(&s, 0, 2 * i + 2, 2 * i);
            put_triangle(&s, 1, 2 * i + 1, 2 * i + 3);
        }
    }
    return s;
}

/* The sides of a prism along y, from `front` to `back`, on a polygon of `count` corners (x, z), which is
 * counter-clockwise seen along y. Corner i has the vertices 2 i in front and 2 i + 1 behind. */
static void put_sides(pl_solid *s, const double (*corner)[2], int count, double front, double back)
{
    for (int i = 0; i < count; ++i) {
        put_vertex(s, corner[i][0], front, corner[i][1]);
        put_vertex(s, corner[i][0], back, corner[i][1]);
    }
    for (int i = 0; i < count; ++i) {
        int next = (i + 1) % count;
        put_quad(s, 2 * i, 2 * i + 1, 2 * next + 1, 2 * next);
    }
}

pl_solid pl_solid_angle(double length, double thickness, double width)
{
    const double l = length, t = thickness;
    const double corner[6][2] = {{0, 0}, {l, 0}, {l, t}, {t, t}, {t, l}, {0, l}}; /* x, z */
    pl_solid s;
    if (take(&s, 12, 20)) {
        put_sides(&s, corner, 6, 0, width);
        /* Each end as two quads that share the diagonal of the corner. */
        put_quad(&s, 0, 2, 4, 6);
        put_quad(&s, 0, 6, 8, 10);
        put_quad(&s, 1, 7, 5, 3);
        put_quad(&s, 1, 11, 9, 7);
    }
    return s;
}

pl_solid pl_solid_crack(double half, double half_width, double depth)
{
    const double w = half_width, bottom = -depth, end = -0.9 * depth;
    const double corner[8][2] = {{-half, bottom}, {half, bottom}, {half, 0}, {w, 0},
                                 {w, end},        {-w, end},      {-w, 0},   {-half, 0}}; /* x, z */
    static const int parts[3][4] = {{0, 5, 6, 7}, {0, 1, 4, 5}, {1, 2, 3, 4}}; /* of an end */
    pl_solid s;
    if (take(&s, 16, 28)) {
        put_sides(&s, corner, 8, -half, half);
        for (int i = 0; i < 3; ++i) {
            const int *p = parts[i];
            put_quad(&s, 2 * p[0], 2 * p[1], 2 * p[2], 2 * p[3]);
            put_quad(&s, 2 * p[3] + 1, 2 * p[2] + 1, 2 * p[1] + 1, 2 * p[0] + 1);
        }
    }
    return s;
}

pl_solid pl_solid_hole(double half, double half_width, double depth)
{
    enum { OUTER = 0, INNER = 8, TOP = 4 };
    static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    pl_solid s;
    if (take(&s, 16, 32)) {
        for (int ring = 0; ring < 4; ++ring) {
            const double reach = ring < 2 ? half : half_width, z = ring % 2 == 0 ? -depth : 0;
            for (int i = 0; i < 4; ++i) {
                put_vertex(&s, reach * corner[i][0], reach * corner[i][1], z);
            }
        }
        for (int i = 0; i < 4; ++i) {
            const int next = (i + 1) % 4;
            put_quad(&s, OUTER + TOP + i, OUTER + TOP + next, INNER + TOP + next, INNER + TOP + i);
            put_quad(&s, OUTER + next, OUTER + i, INNER + i, INNER + next);
            put_quad(&s, OUTER + i, OUTER + next, OUTER + TOP + next, OUTER + TOP + i);
            put_quad(&s, INNER + next, INNER + i, INNER + TOP + i, INNER + TOP + next);
        }
    }
    return s;
}

/* The faces of a grid of n by n quads, whose vertices begin at `first`, row by row; seen from above they
 * are counter-clockwise where `is_top`. */
static void put_grid(pl_solid *s, int first, int n, bool is_top)
{
    for (int row = 0; row < n; ++row) {
        for (int i = 0; i < n; ++i) {
            const int a = first + row * (n + 1) + i, d = a + n + 1;
            if (is_top) {
                put_quad(s, a, a + 1, d + 1, d);
            } else {
                put_quad(s, a, d, d + 1, a + 1);
            }
        }
    }
}

pl_solid pl_solid_slab(double half_x, double half_y, double half_z, int n)
{
    const int row = n + 1, layer = row * row;
    pl_solid s;
    if (take(&s, 2 * layer, 4 * n * n + 8 * n)) {
        for (int i = 0; i < 2 * layer; ++i) {
            const int x = i % row, y = i % layer / row;
            put_vertex(&s, half_x * (2.0 * x / n - 1), half_y * (2.0 * y / n - 1),
                       i < layer ? -half_z : half_z);
        }
        put_grid(&s, 0, n, false);
        put_grid(&s, layer, n, true);
        for (int i = 0; i < n; ++i) {
            const int left = i * row, right = left + n, back = n * row + i;
            put_quad(&s, i, i + 1, layer + i + 1, layer + i);
            put_quad(&s, back + 1, back, layer + back, layer + back + 1);
            put_quad(&s, left + row, left, layer + left, layer + left + row);
            put_quad(&s, right, right + row, layer + right + row, layer + right);
        }
    }
    return s;
}

pl_solid pl_solid_torus(double ring_radius, double tube_radius, int around, int sides)
{
    pl_solid s;
    if (take(&s, around * sides, 2 * around * sides)) {
        for (int i = 0; i < around; ++i) {
            double x, y;
            pl_circle_point(2 * i + 1, 2 * around, &x, &y);
            for (int k = 0; k < sides; ++k) {
                double out, up;
                pl_circle_point(2 * k + 1, 2 * sides, &out, &up);
                double r = ring_radius + tube_radius * out;
                put_vertex(&s, r * x, r * y, tube_radius * up);
            }
        }
        for (int i = 0; i < around; ++i) {
            int piece = i * sides, next = (i + 1) % around * sides;
            for (int k = 0; k < sides; ++k) {
                int up = (k + 1) % sides;
                put_quad(&s, piece + k, next + k, next + up, piece + up);
            }
        }
    }
    return s;
}

/* From the middle of a regular polygon to its side, its corners at 1. */
static double inner_radius(int sides)
{
    double x, y;
    pl_circle_point(1, 2 * sides, &x, &y);
    return x;
}

double pl_torus_half_height(double tube_radius, int sides)
{
    return tube_radius * inner_radius(sides);
}

double pl_torus_hole(double ring_radius, double tube_radius, int around, int sides)
{
    return (ring_radius - tube_radius * inner_radius(sides)) * inner_radius(around);
}

pl_shape pl_build_solid(pl_builder *builder, pl_solid *solid, bool convex, const char *name)
{
    const pl_polyhedron *made = NULL;
    const double(*vertices)[3] = (const double(*)[3])solid->vertices;
    if (builder->status == PL_OK && solid->vertices == NULL) {
        builder->status = pl_fail(builder->error, PL_NO_MEMORY, "no memory for %s", name);
    } else if (builder->status == PL_OK && convex) {
        builder->status = pl_scene_add_hull(builder->scene, name, vertices, solid->vertex_count,
                                            &made, builder->error);
    } else if (builder->status == PL_OK) {
        builder->status = pl_scene_add_mesh(builder->scene, name, vertices, solid->vertex_count,
                                            (const int(*)[3])solid->triangles,
                                            solid->triangle_count, &made, builder->error);
    }
    pl_solid_free(solid);
    return made != NULL ? pl_shape_of(made) : (pl_shape){.kind = PL_SHAPE_MESH};
}

pl_shape pl_build_stone(pl_builder *builder, const char *name, double least, double most)
{
    enum { POINTS = 14 };
    double points[POINTS][3], axes[3], q[4];
    for (int i = 0; i < 3; ++i) {
        axes[i] = pl_draw_uniform(&builder->random, least, most);
    }
    for (int i = 0; i < POINTS; ++i) {
        /* The image of z under a random rotation is uniform on the sphere. */
        pl_draw_orientation(&builder->random, q);
        points[i][0] = axes[0] * 2 * (q[1] * q[3] + q[0] * q[2]);
        points[i][1] = axes[1] * 2 * (q[2] * q[3] - q[0] * q[1]);
        points[i][2] = axes[2] * (1 - 2 * (q[1] * q[1] + q[2] * q[2]));
    }
    return pl_build_hull(builder, name, (const double(*)[3])points, POINTS);
}
