/* Vertices and triangles of the forms, in an order that the laws of contact depend on. */
#include "solid_forms.h"

static const double two_pi = 6.283185307179586;

static void add_triangle(form *f, int a, int b, int c)
{
    uint32_t *t = f->triangles[f->triangle_count++];
    t[0] = (uint32_t)a;
    t[1] = (uint32_t)b;
    t[2] = (uint32_t)c;
}

static void add_quad(form *f, int a, int b, int c, int d)
{
    add_triangle(f, a, b, c);
    add_triangle(f, a, c, d);
}

form form_prism(const double (*outline)[2], int count, double low, double high)
{
    form f = {.vertex_count = 2 * count};
    for (int i = 0; i < count; ++i) {
        f.vertices[i] = pe_v3(outline[i][0], outline[i][1], low);
        f.vertices[count + i] = pe_v3(outline[i][0], outline[i][1], high);
        int j = (i + 1) % count;
        add_quad(&f, i, j, count + j, count + i);
    }
    for (int i = 1; i + 1 < count; ++i) {
        add_triangle(&f, 0, i + 1, i);
        add_triangle(&f, count, count + i, count + i + 1);
    }
    return f;
}

form form_frustum(int sides, double top, double shift)
{
    double outline[FORM_VERTICES / 2][2];
    for (int i = 0; i < sides; ++i) {
        outline[i][0] = cos(two_pi * i / sides);
        outline[i][1] = sin(two_pi * i / sides);
    }
    form f = form_prism((const double(*)[2])outline, sides, -1, 1);
    for (int i = sides; i < 2 * sides; ++i) {
        f.vertices[i].x = top * f.vertices[i].x + shift;
        f.vertices[i].y *= top;
    }
    return f;
}

/* Whether all points lie behind the plane of three, which are counter-clockwise from outside. */
static bool is_face(const pe_vec3 *p, int count, int i, int j, int k)
{
    pe_vec3 n = pe_cross(pe_sub(p[j], p[i]), pe_sub(p[k], p[i]));
    for (int m = 0; m < count; ++m) {
        if (m != i && m != j && m != k && pe_dot(n, pe_sub(p[m], p[i])) >= 0) {
            return false;
        }
    }
    return true;
}

form form_hull(const pe_vec3 *points, int count)
{
    form f = {0};
    int name[24];
    for (int i = 0; i < count; ++i) {
        name[i] = -1;
    }
    for (int i = 0; i < count; ++i) {
        for (int j = i + 1; j < count; ++j) {
            for (int k = i + 1; k < count; ++k) {
                if (k == j || !is_face(points, count, i, j, k)) {
                    continue;
                }
                const int corner[3] = {i, j, k};
                for (int c = 0; c < 3; ++c) {
                    if (name[corner[c]] < 0) {
                        name[corner[c]] = f.vertex_count;
                        f.vertices[f.vertex_count++] = points[corner[c]];
                    }
                }
                add_triangle(&f, name[i], name[j], name[k]);
            }
        }
    }
    return f;
}

form form_tetrahedron(void)
{
    static const pe_vec3 p[4] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    return form_hull(p, 4);
}

form form_icosahedron(void)
{
    double g = 0.5 * (1 + sqrt(5));
    pe_vec3 p[12];
    for (int i = 0; i < 4; ++i) {
        double s = i & 1 ? 1 : -1, t = i & 2 ? g : -g;
        p[3 * i] = pe_v3(0, s, t);
        p[3 * i + 1] = pe_v3(s, t, 0);
        p[3 * i + 2] = pe_v3(t, 0, s);
    }
    return form_hull(p, 12);
}

static uint32_t middle_of(form *f, uint32_t i, uint32_t j)
{
    pe_vec3 x = pe_add(f->vertices[i], f->vertices[j]);
    x = pe_scale(pe_length(f->vertices[i]) / pe_length(x), x);
    for (uint32_t k = 0; k < (uint32_t)f->vertex_count; ++k) {
        if (pe_length(pe_sub(f->vertices[k], x)) < 1e-9) {
            return k;
        }
    }
    f->vertices[f->vertex_count] = x;
    return (uint32_t)f->vertex_count++;
}

static form finer(const form *from)
{
    form f = *from;
    f.triangle_count = 0;
    for (int i = 0; i < from->triangle_count; ++i) {
        const uint32_t *t = from->triangles[i];
        uint32_t m[3];
        for (int k = 0; k < 3; ++k) {
            m[k] = middle_of(&f, t[k], t[(k + 1) % 3]);
        }
        for (int k = 0; k < 4; ++k) {
            uint32_t *to = f.triangles[f.triangle_count++];
            to[0] = k < 3 ? t[k] : m[0];
            to[1] = k < 3 ? m[k] : m[1];
            to[2] = k < 3 ? m[(k + 2) % 3] : m[2];
        }
    }
    return f;
}

form form_icosphere(void)
{
    form f = form_icosahedron();
    f = finer(&f);
    return finer(&f);
}

form form_cube(void)
{
    form f = {.vertex_count = 8};
    for (int i = 0; i < 8; ++i) {
        f.vertices[i] = pe_v3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    }
    add_quad(&f, 0, 2, 3, 1);
    add_quad(&f, 4, 5, 7, 6);
    add_quad(&f, 0, 1, 5, 4);
    add_quad(&f, 2, 6, 7, 3);
    add_quad(&f, 0, 4, 6, 2);
    add_quad(&f, 1, 3, 7, 5);
    return f;
}

form form_random_hull(check_random *random, int count)
{
    pe_vec3 p[24];
    for (int i = 0; i < count; ++i) {
        double q[4];
        check_quaternion(random, q);
        p[i] = pe_scale(1 / sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), pe_v3(q[1], q[2], q[3]));
        p[i] = pe_scale(check_uniform(random, 0.7, 1), p[i]);
    }
    return form_hull(p, count);
}

form form_l_shape(void)
{
    static const double outline[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    return form_prism(outline, 6, 0, 0.5);
}

form form_torus(double major, double minor, int around, int across)
{
    form f = {.vertex_count = around * across};
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            double u = two_pi * i / around, v = two_pi * j / across, r = major + minor * cos(v);
            f.vertices[i * across + j] = pe_v3(r * cos(u), r * sin(u), minor * sin(v));
            int i2 = (i + 1) % around, j2 = (j + 1) % across;
            add_quad(&f, i * across + j, i2 * across + j, i2 * across + j2, i * across + j2);
        }
    }
    return f;
}

void form_scale(form *f, pe_vec3 factors)
{
    for (int i = 0; i < f->vertex_count; ++i) {
        f->vertices[i] = pe_mul(factors, f->vertices[i]);
    }
}
