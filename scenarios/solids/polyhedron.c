/* Volume, centre of mass and principal inertia of the solid within a closed surface.
 *
 * A triangle (a, b, c), with a point p, spans a tetrahedron of signed volume
 * V = (a - p) . (b - p) x (c - p) / 6; over all triangles they add up to the solid. With p as
 * origin, the integral of x over one is V/4 (a + b + c), and that of x_i x_j is
 * V/20 (a_i a_j + b_i b_j + c_i c_j + s_i s_j), s = a + b + c: exact, by the barycentric formula of
 * Eisenberg and Malvern 1973. p is first the middle of the bounding box, then the centre of mass,
 * so that neither a solid far from the origin nor the parallel axis theorem costs digits.
 *
 * The matrix of <x_i x_j> is made diagonal by cyclic Jacobi rotations (Golub and Van Loan, Matrix
 * Computations, 8.5), each inertia being the sum of two of its values: on a positive matrix they
 * keep the digits of the small ones (Demmel and Veselic 1992), so that a rod has a right inertia
 * about its length. An element below 1e-12 of its row's and column's diagonal (their geometric
 * mean) is rounding and counts as zero, and nothing is sorted: a solid that lies along its axes
 * keeps them, to the bit. So does one that is symmetric about the middle of its box keep that as
 * its centre. */
#include "polyhedron.h"

#include "base/number.h"
#include "mesh_triangle.h"
#include "plumb/vec.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

pl_polyhedron *pl_polyhedron_create(int vertex_count, int triangle_count)
{
    pl_polyhedron *made = calloc(1, sizeof *made);
    if (made == NULL) {
        return NULL;
    }
    made->vertices = malloc((size_t)vertex_count * sizeof *made->vertices);
    made->triangles = malloc((size_t)triangle_count * sizeof *made->triangles);
    if (made->vertices == NULL || made->triangles == NULL) {
        pl_polyhedron_free(made);
        return NULL;
    }
    made->vertex_count = vertex_count;
    made->triangle_count = triangle_count;
    return made;
}

void pl_polyhedron_free(pl_polyhedron *polyhedron)
{
    if (polyhedron != NULL) {
        free(polyhedron->vertices);
        free(polyhedron->triangles);
        free(polyhedron);
    }
}

bool pl_polyhedron_check_points(const char *key, const double (*points)[3], int count,
                                pl_diagnostic *diagnostic)
{
    for (int i = 0; i < 3 * count; ++i) {
        const double x = points[i / 3][i % 3];
        if (!(fabs(x) <= PL_MAX_COORDINATE)) {
            char found[PL_NUMBER_SIZE];
            pl_path_push_key(&diagnostic->path, key);
            pl_path_push_index(&diagnostic->path, i / 3);
            pl_path_push_index(&diagnostic->path, i % 3);
            return pl_diagnose(diagnostic, "expected a finite number of at most %g, found %s",
                               PL_MAX_COORDINATE, pl_number_text(x, found));
        }
    }
    return true;
}

double pl_largest_coordinate(const double (*points)[3], int count)
{
    double largest = 0;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            largest = fmax(largest, fabs(points[i][k]));
        }
    }
    return largest;
}

/* Width over length, below which the mean squares of the width are rounding. */
#define THINNEST 1e-6

/* The largest relative error of a volume summed in the order of the triangles. */
#define PLAIN_ROUNDING 1e-9

typedef struct moments {
    double volume;
    double first[3];     /* of the coordinates from the reference point */
    double second[3][3]; /* of their products */
} moments;

static void add_tetrahedron(moments *sum, pl_vec a, pl_vec b, pl_vec c)
{
    double p[3][3], s[3];
    pl_vec_store(a, p[0]);
    pl_vec_store(b, p[1]);
    pl_vec_store(c, p[2]);
    pl_vec_store(pl_vec_add(pl_vec_add(a, b), c), s);
    const double volume = pl_vec_dot(a, pl_vec_cross(b, c)) / 6;
    sum->volume += volume;
    for (int i = 0; i < 3; ++i) {
        sum->first[i] += volume / 4 * s[i];
        for (int j = 0; j <= i; ++j) {
            sum->second[i][j] +=
                volume / 20 *
                (p[0][i] * p[0][j] + p[1][i] * p[1][j] + p[2][i] * p[2][j] + s[i] * s[j]);
        }
    }
}

static moments integrate(const pl_polyhedron *p, const double from[3])
{
    moments sum = {.volume = 0};
    const pl_vec origin = pl_vec_of(from);
    for (int t = 0; t < p->triangle_count; ++t) {
        const int *corner = p->triangles[t];
        add_tetrahedron(&sum, pl_vec_sub(pl_vec_of(p->vertices[corner[0]]), origin),
                        pl_vec_sub(pl_vec_of(p->vertices[corner[1]]), origin),
                        pl_vec_sub(pl_vec_of(p->vertices[corner[2]]), origin));
    }
    return sum;
}

/* The same, but for rounding, with bits that do not depend on the order of vertices and triangles. */
static moments integrate_in_any_order(const pl_polyhedron *p, const double from[3])
{
    pl_exact_sum sums[sizeof(moments) / sizeof(double)] = {{{0}, {0}}};
    const pl_vec origin = pl_vec_of(from);
    for (int t = 0; t < p->triangle_count; ++t) {
        const pl_mesh_triangle shape =
            pl_mesh_triangle_of((const double(*)[3])p->vertices, p->triangles[t]);
        moments one = {.volume = 0};
        double terms[sizeof one / sizeof(double)];
        add_tetrahedron(&one, pl_vec_sub(pl_vec_of(shape.corner[0]), origin),
                        pl_vec_sub(pl_vec_of(shape.corner[1]), origin),
                        pl_vec_sub(pl_vec_of(shape.corner[2]), origin));
        memcpy(terms, &one, sizeof terms);
        for (size_t i = 0; i < sizeof terms / sizeof terms[0]; ++i) {
            pl_exact_add(&sums[i], terms[i], shape.facing, 1);
        }
    }
    moments sum;
    double values[sizeof sum / sizeof(double)];
    for (size_t i = 0; i < sizeof values / sizeof values[0]; ++i) {
        values[i] = pl_exact_value(&sums[i]);
    }
    memcpy(&sum, values, sizeof sum);
    return sum;
}

/* The middle of the bounding box; returns its longest side. */
static double middle_of_box(const pl_polyhedron *p, double middle[3])
{
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
        double low = p->vertices[0][k], high = low;
        for (int i = 1; i < p->vertex_count; ++i) {
            low = fmin(low, p->vertices[i][k]);
            high = fmax(high, p->vertices[i][k]);
        }
        middle[k] = low + (high - low) / 2;
        longest = fmax(longest, high - low);
    }
    return longest;
}

/* Turns the symmetric matrix m by the rotation in the plane of axes p and q that makes m[p][q]
 * zero, and multiplies it onto `axes`. Its angle is at most 45 degrees. */
static void rotate(double m[3][3], double axes[3][3], int p, int q)
{
    const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + hypot(theta, 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; ++k) { /* columns */
        const double left = m[k][p], right = m[k][q];
        m[k][p] = c * left - s * right;
        m[k][q] = s * left + c * right;
    }
    for (int k = 0; k < 3; ++k) { /* rows */
        const double left = m[p][k], right = m[q][k];
        m[p][k] = c * left - s * right;
        m[q][k] = s * left + c * right;
    }
    for (int k = 0; k < 3; ++k) {
        const double left = axes[k][p], right = axes[k][q];
        axes[k][p] = c * left - s * right;
        axes[k][q] = s * left + c * right;
    }
}

static bool is_below(double m[3][3], int p, int q, double share)
{
    return fabs(m[p][q]) <= share * sqrt(fabs(m[p][p] * m[q][q]));
}

/* The columns of `axes` become the principal axes, right-handed; m, positive, becomes diagonal. */
static void diagonalize(double m[3][3], double axes[3][3])
{
    static const double one[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    enum { SWEEPS = 50 }; /* it converges quadratically: 4 or 5 do */
    memcpy(axes, one, sizeof one);
    for (int i = 0; i < 3 * SWEEPS; ++i) {
        const int p = pairs[i % 3][0], q = pairs[i % 3][1];
        if (i >= 3 && !is_below(m, p, q, DBL_EPSILON)) {
            rotate(m, axes, p, q);
        }
        if (is_below(m, p, q, i < 3 ? 1e-12 : DBL_EPSILON)) {
            m[p][q] = m[q][p] = 0;
        }
    }
}

/* The quaternion of a rotation matrix: the largest of its four components comes from the diagonal,
 * the others from it by division (Shepperd 1978). The first that is not zero is made positive. */
static void to_quaternion(double m[3][3], double q[4])
{
    const double trace = m[0][0] + m[1][1] + m[2][2];
    int i = 0;
    for (int k = 1; k < 3; ++k) {
        i = m[k][k] > m[i][i] ? k : i;
    }
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    if (trace >= m[i][i]) {
        q[0] = 1 + trace;
        q[1] = m[2][1] - m[1][2];
        q[2] = m[0][2] - m[2][0];
        q[3] = m[1][0] - m[0][1];
    } else {
        q[0] = m[k][j] - m[j][k];
        q[1 + i] = 1 + m[i][i] - m[j][j] - m[k][k];
        q[1 + j] = m[j][i] + m[i][j];
        q[1 + k] = m[k][i] + m[i][k];
    }
    int first = 0;
    while (first < 3 && q[first] == 0) {
        ++first;
    }
    const double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int n = 0; n < 4; ++n) {
        q[n] = q[n] == 0 ? 0 : q[n] / (q[first] < 0 ? -norm : norm);
    }
}

void pl_surface_add(pl_surface_sums *sums, const double (*vertices)[3], const int corner[3])
{
    const pl_mesh_triangle t = pl_mesh_triangle_of(vertices, corner);
    pl_exact_add_determinant(&sums->six_volumes, t.facing, t.corner[0], t.corner[1], t.corner[2]);
    pl_exact_add(&sums->two_areas, pl_vec_length(pl_mesh_normal(&t)), 1, 1);
    for (int k = 0; k < 9; ++k) {
        sums->largest = fmax(sums->largest, fabs(t.corner[k / 3][k % 3]));
    }
}

bool pl_surface_is_thick(const pl_surface_sums *sums)
{
    const double volume = fabs(pl_exact_value(&sums->six_volumes)) / 3;
    const double thickness = volume / pl_exact_value(&sums->two_areas);
    return thickness > PL_MIN_THICKNESS && thickness > 16 * DBL_EPSILON * sums->largest;
}

static bool encloses_volume(const pl_polyhedron *p)
{
    pl_surface_sums sums = {.largest = 0};
    for (int t = 0; t < p->triangle_count; ++t) {
        pl_surface_add(&sums, (const double(*)[3])p->vertices, p->triangles[t]);
    }
    return pl_exact_sign(&sums.six_volumes) > 0 && pl_surface_is_thick(&sums);
}

/* Computes volume, centre and the means of products of coordinates from there. */
static void measure(const pl_polyhedron *p,
                    moments (*integral)(const pl_polyhedron *p, const double from[3]),
                    double *volume, double centre[3], double mean[3][3])
{
    double middle[3];
    const double rounding = 16 * DBL_EPSILON * middle_of_box(p, middle);
    moments m = integral(p, middle);
    for (int k = 0; k < 3; ++k) {
        const double shift = m.first[k] / m.volume;
        centre[k] = middle[k] + (fabs(shift) > rounding ? shift : 0);
    }
    m = integral(p, centre);
    *volume = m.volume;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j <= i; ++j) {
            mean[i][j] = mean[j][i] = m.second[i][j] / m.volume;
        }
    }
}

/* Fills the mass properties. False unless they are those of a solid that is at most a million times
 * as long as wide. */
static bool fill(pl_polyhedron *p,
                 moments (*integral)(const pl_polyhedron *p, const double from[3]))
{
    double mean[3][3], axes[3][3];
    measure(p, integral, &p->volume, p->centre, mean);
    diagonalize(mean, axes);
    to_quaternion(axes, p->axes);
    for (int k = 0; k < 3; ++k) {
        p->inertia[k] = mean[(k + 1) % 3][(k + 1) % 3] + mean[(k + 2) % 3][(k + 2) % 3];
    }
    p->radius = 0;
    for (int i = 0; i < p->vertex_count; ++i) {
        const pl_vec arm = pl_vec_sub(pl_vec_of(p->vertices[i]), pl_vec_of(p->centre));
        p->radius = fmax(p->radius, pl_vec_length(arm));
    }
    const double least = fmin(mean[0][0], fmin(mean[1][1], mean[2][2]));
    const double most = fmax(mean[0][0], fmax(mean[1][1], mean[2][2]));
    return p->volume > 0 && least > THINNEST * THINNEST * most;
}

bool pl_polyhedron_measure(pl_polyhedron *p)
{
    pl_polyhedron in_order = *p;
    if (!encloses_volume(p) || !fill(p, integrate_in_any_order)) {
        return false;
    }
    /* Results were measured with sums in the order of the triangles, so these are kept where they are
     * accurate. Elsewhere the order would change the mass. */
    if (fill(&in_order, integrate) &&
        fabs(in_order.volume - p->volume) <= PLAIN_ROUNDING * p->volume) {
        *p = in_order;
    }
    return true;
}
