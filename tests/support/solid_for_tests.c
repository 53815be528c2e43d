#include "solid_for_tests.h"

#include "check.h"
#include "plumb/vec.h"

#include <math.h>
#include <string.h>

static const double two_pi = 6.28318530717958647692;

void known_clear(solid_surface *s)
{
    s->vertex_count = s->triangle_count = 0;
}

int known_add_vertex(solid_surface *s, double x, double y, double z)
{
    const double place[3] = {x, y, z};
    assert_in_range(s->vertex_count, 0, 8191);
    memcpy(s->vertices[s->vertex_count], place, sizeof place);
    return s->vertex_count++;
}

void known_add_triangle(solid_surface *s, int a, int b, int c)
{
    const int corner[3] = {a, b, c};
    assert_in_range(s->triangle_count, 0, 16383);
    memcpy(s->triangles[s->triangle_count++], corner, sizeof corner);
}

void known_make_tetrahedron(solid_surface *s, const double (*vertices)[3],
                            const int (*triangles)[3])
{
    known_clear(s);
    for (int i = 0; i < 4; ++i) {
        known_add_vertex(s, vertices[i][0], vertices[i][1], vertices[i][2]);
    }
    for (int i = 0; i < 4; ++i) {
        known_add_triangle(s, triangles[i][0], triangles[i][1], triangles[i][2]);
    }
}

static void add_quadrilateral(solid_surface *s, int a, int b, int c, int d)
{
    known_add_triangle(s, a, b, c);
    known_add_triangle(s, a, c, d);
}

void known_add_box(solid_surface *s, const double centre[3], const double half[3], bool inward)
{
    static const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const int first = s->vertex_count;
    for (int i = 0; i < 8; ++i) {
        known_add_vertex(s, centre[0] + (i & 1 ? 1 : -1) * half[0],
                         centre[1] + (i & 2 ? 1 : -1) * half[1],
                         centre[2] + (i & 4 ? 1 : -1) * half[2]);
    }
    for (int i = 0; i < 6; ++i) {
        const int *q = sides[i];
        add_quadrilateral(s, first + q[0], first + q[inward ? 3 : 1], first + q[2],
                          first + q[inward ? 1 : 3]);
    }
}

void known_add_rings(solid_surface *s, int sides, const double *radius, const double *height,
                     int rings, bool around)
{
    const int first = s->vertex_count;
    for (int j = 0; j < rings; ++j) {
        for (int i = 0; i < sides; ++i) {
            const double angle = two_pi * i / sides;
            known_add_vertex(s, radius[j] * cos(angle), radius[j] * sin(angle), height[j]);
        }
    }
    for (int j = 0; j < (around ? rings : rings - 1); ++j) {
        for (int i = 0; i < sides; ++i) {
            const int next = (i + 1) % sides, low = first + j * sides;
            const int high = first + (j + 1) % rings * sides;
            add_quadrilateral(s, low + i, low + next, high + next, high + i);
        }
    }
    for (int i = 1; i + 1 < sides && !around; ++i) {
        const int top = first + (rings - 1) * sides;
        known_add_triangle(s, first, first + i + 1, first + i);
        known_add_triangle(s, top, top + i, top + i + 1);
    }
}

solid_moments known_moments_of_rings(int sides, const double *radius, const double *height,
                                     int rings, bool around)
{
    static const double places[3] = {-0.77459666924148337704, 0, 0.77459666924148337704};
    static const double weights[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    const double angle = two_pi / sides;
    double volume = 0, first = 0, second = 0, polar = 0;
    for (int j = 0; j < (around ? rings : rings - 1); ++j) {
        const int k = (j + 1) % rings;
        for (int g = 0; g < 3; ++g) {
            const double t = (1 + places[g]) / 2;
            const double r = radius[j] + t * (radius[k] - radius[j]);
            const double z = height[j] + t * (height[k] - height[j]);
            const double dz = weights[g] * (height[k] - height[j]);
            const double area = sides / 2.0 * r * r * sin(angle);
            volume += area * dz;
            first += area * z * dz;
            second += area * z * z * dz;
            polar += sides / 12.0 * pow(r, 4) * sin(angle) * (2 + cos(angle)) * dz;
        }
    }
    solid_moments m = {.volume = volume, .mean = {0, 0, first / volume}};
    m.square[0][0] = m.square[1][1] = polar / 2 / volume;
    m.square[2][2] = second / volume - m.mean[2] * m.mean[2];
    return m;
}

solid_moments known_moments_of_boxes(const double (*centres)[3], const double (*halves)[3],
                                     const int *signs, int count)
{
    solid_moments m = {.volume = 0};
    for (int b = 0; b < count; ++b) {
        const double volume = signs[b] * 8 * halves[b][0] * halves[b][1] * halves[b][2];
        m.volume += volume;
        for (int i = 0; i < 3; ++i) {
            m.mean[i] += volume * centres[b][i];
        }
    }
    for (int i = 0; i < 3; ++i) {
        m.mean[i] /= m.volume;
    }
    for (int b = 0; b < count; ++b) {
        const double volume = signs[b] * 8 * halves[b][0] * halves[b][1] * halves[b][2];
        for (int n = 0; n < 9; ++n) {
            const int i = n / 3, j = n % 3;
            const double own = i == j ? halves[b][i] * halves[b][i] / 3 : 0;
            const double arms = (centres[b][i] - m.mean[i]) * (centres[b][j] - m.mean[j]);
            m.square[i][j] += volume / m.volume * (own + arms);
        }
    }
    return m;
}

static pl_vec move(const double rotation[4], const double shift[3], const double place[3])
{
    const pl_axes axes = pl_axes_of(rotation);
    return pl_vec_add(pl_to_world(&axes, pl_vec_of(place)), pl_vec_of(shift));
}

void known_move(solid_surface *s, const double rotation[4], const double shift[3])
{
    for (int i = 0; i < s->vertex_count; ++i) {
        pl_vec_store(move(rotation, shift, s->vertices[i]), s->vertices[i]);
    }
}

/* axes diag(values) axes^T */
static void compose(const pl_axes *axes, const double values[3], double tensor[3][3])
{
    double columns[3][3];
    for (int k = 0; k < 3; ++k) {
        pl_vec_store(axes->axis[k], columns[k]);
    }
    for (int i = 0; i < 9; ++i) {
        tensor[i / 3][i % 3] = 0;
        for (int k = 0; k < 3; ++k) {
            tensor[i / 3][i % 3] += columns[k][i / 3] * values[k] * columns[k][i % 3];
        }
    }
}

void known_check(const pl_polyhedron *actual, const solid_moments *expected,
                 const double rotation[4], const double shift[3], double relative)
{
    static const double none[3] = {0, 0, 0}, one[4] = {1, 0, 0, 0};
    double centre[3], turned[3][3], tensor[3][3];
    pl_vec_store(
        move(rotation != NULL ? rotation : one, shift != NULL ? shift : none, expected->mean),
        centre);
    const pl_axes axes = pl_axes_of(actual->axes);
    const pl_axes turn = pl_axes_of(rotation != NULL ? rotation : one);
    /* What turn^T of the actual tensor is, column by column. */
    compose(&axes, actual->inertia, tensor);
    for (int j = 0; j < 3; ++j) {
        const pl_vec unit = turn.axis[j];
        const double column[3] = {pl_vec_dot(pl_vec_of(tensor[0]), unit),
                                  pl_vec_dot(pl_vec_of(tensor[1]), unit),
                                  pl_vec_dot(pl_vec_of(tensor[2]), unit)};
        pl_vec_store(pl_to_local(&turn, pl_vec_of(column)), turned[j]);
    }
    const double trace = expected->square[0][0] + expected->square[1][1] + expected->square[2][2];
    assert_close(actual->volume, expected->volume, 0, relative);
    for (int i = 0; i < 3; ++i) {
        assert_close(actual->centre[i], centre[i], relative * sqrt(trace), 0);
        for (int j = 0; j < 3; ++j) {
            const double inertia = (i == j ? trace : 0) - expected->square[i][j];
            assert_close(turned[i][j], inertia, relative * trace, 0);
        }
    }
}
