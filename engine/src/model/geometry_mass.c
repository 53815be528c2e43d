/* Mass properties of a polyhedron, and principal axes.
 *
 * Every triangle spans a tetrahedron with a point near the solid. The integrals of 1, x and x x^T
 * over a tetrahedron (0, a, b, c) of volume V, with s = a + b + c, are
 *
 *     V,    V s / 4,    V / 20 (s s^T + a a^T + b b^T + c c^T).
 *
 * Signed, they add up to those of the solid (Tonon 2004 gives the same integrals). The inertia
 * tensor is turned to principal axes by cyclic Jacobi rotations (Golub and Van Loan 2013, 8.5). */
#include "geometry_build.h"

/* Products of inertia below this part of the trace are rounding. */
static const double ROUNDING = 1e-12;

/* The relative error of a coordinate, and of a product of three coordinates. */
static const double UNCERTAIN = 1e-15;

/* The integrals over the solid. */
typedef struct moments {
    double volume;
    pe_vec3 first;
    double second[6]; /* xx, yy, zz, yz, zx, xy */
} moments;

static void add_square(double to[6], double w, pe_vec3 v)
{
    to[0] += w * v.x * v.x;
    to[1] += w * v.y * v.y;
    to[2] += w * v.z * v.z;
    to[3] += w * v.y * v.z;
    to[4] += w * v.z * v.x;
    to[5] += w * v.x * v.y;
}

/* The integrals about `origin`. */
static moments integrate(const pe_geometry_def *def, pe_vec3 origin)
{
    moments m = {0};
    for (int i = 0; i < def->triangle_count; ++i) {
        const uint32_t *t = def->triangles[i];
        pe_vec3 a = pe_sub(def->vertices[t[0]], origin), b = pe_sub(def->vertices[t[1]], origin),
                c = pe_sub(def->vertices[t[2]], origin);
        double volume = pe_dot(a, pe_cross(b, c)) / 6;
        pe_vec3 s = pe_add(a, pe_add(b, c));
        m.volume += volume;
        m.first = pe_madd(m.first, volume / 4, s);
        double w = volume / 20;
        add_square(m.second, w, s);
        add_square(m.second, w, a);
        add_square(m.second, w, b);
        add_square(m.second, w, c);
    }
    return m;
}

/* By how much the volume may be wrong, m^3: the coordinates of the surface are rounded, and so are the
 * products that `integrate` adds up, which are far larger than the volume where triangles are thin. */
static double uncertain_volume(const pe_geometry_def *def, pe_vec3 origin)
{
    double area = 0, farthest = 0, products = 0;
    for (int i = 0; i < def->triangle_count; ++i) {
        const pe_vec3 a = def->vertices[def->triangles[i][0]],
                      b = def->vertices[def->triangles[i][1]],
                      c = def->vertices[def->triangles[i][2]];
        area += 0.5 * pe_length(pe_cross(pe_sub(b, a), pe_sub(c, a)));
        farthest = pe_max(farthest, pe_length(a));
        products += pe_length(pe_sub(a, origin)) * pe_length(pe_sub(b, origin)) *
                    pe_length(pe_sub(c, origin));
    }
    return UNCERTAIN * (farthest * area + products);
}

static pe_vec3 centre_of_bounds(const pe_geometry_def *def)
{
    pe_vec3 low = def->vertices[0], high = low;
    for (int i = 1; i < def->vertex_count; ++i) {
        pe_vec3 v = def->vertices[i];
        low = pe_v3(pe_min(low.x, v.x), pe_min(low.y, v.y), pe_min(low.z, v.z));
        high = pe_v3(pe_max(high.x, v.x), pe_max(high.y, v.y), pe_max(high.z, v.z));
    }
    return pe_madd(low, 0.5, pe_sub(high, low));
}

/* Turns the axes p and q so that a[p][q] vanishes. The axes are the columns of `axes`. */
static void rotate(double a[3][3], double axes[3][3], int p, int q)
{
    double tau = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    double t = (tau < 0 ? -1 : 1) / (fabs(tau) + sqrt(1 + tau * tau));
    double c = 1 / sqrt(1 + t * t), s = t * c;
    for (int k = 0; k < 3; ++k) {
        double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for (int k = 0; k < 3; ++k) {
        double pk = a[p][k], qk = a[q][k];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
    }
    for (int k = 0; k < 3; ++k) {
        double kp = axes[k][p], kq = axes[k][q];
        axes[k][p] = c * kp - s * kq;
        axes[k][q] = s * kp + c * kq;
    }
}

/* The quaternion of a rotation matrix, by Shepperd 1978. */
static pe_quat quaternion_of(double r[3][3])
{
    double trace = r[0][0] + r[1][1] + r[2][2];
    double part[4] = {trace, r[0][0], r[1][1], r[2][2]};
    int largest = 0;
    for (int k = 1; k < 4; ++k) {
        largest = part[k] > part[largest] ? k : largest;
    }
    double q[4], f = sqrt(1 + 2 * part[largest] - trace);
    if (largest == 0) {
        q[0] = f;
        q[1] = (r[2][1] - r[1][2]) / f;
        q[2] = (r[0][2] - r[2][0]) / f;
        q[3] = (r[1][0] - r[0][1]) / f;
    } else {
        int i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
        q[0] = (r[k][j] - r[j][k]) / f;
        q[1 + i] = f;
        q[1 + j] = (r[i][j] + r[j][i]) / f;
        q[1 + k] = (r[i][k] + r[k][i]) / f;
    }
    return pe_quat_unit((pe_quat){q[0], q[1], q[2], q[3]});
}

void pe_principal_axes(double a[3][3], double axes[3][3])
{
    enum { SWEEPS = 16 }; /* convergence is quadratic: five are enough */
    for (int k = 0; k < 9; ++k) {
        axes[k / 3][k % 3] = k % 4 == 0;
    }
    double least = ROUNDING * (a[0][0] + a[1][1] + a[2][2]);
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        for (int p = 0; p < 2; ++p) {
            for (int q = p + 1; q < 3; ++q) {
                /* Later sweeps remove what the first ones have disturbed, to the last digit. */
                if (fabs(a[p][q]) > (sweep == 0 ? least : 1e-6 * least)) {
                    rotate(a, axes, p, q);
                }
            }
        }
        bool aligned = fabs(a[0][1]) <= least && fabs(a[0][2]) <= least && fabs(a[1][2]) <= least;
        if (aligned && sweep == 0 && axes[0][0] == 1 && axes[1][1] == 1) {
            break;
        }
    }
}

pe_geometry_frame pe_geometry_mass(const pe_geometry_def *def)
{
    pe_vec3 origin = centre_of_bounds(def);
    moments m = integrate(def, origin);
    pe_geometry_frame frame = {.volume = m.volume, .orientation = {.w = 1}};
    if (!(m.volume > uncertain_volume(def, origin))) {
        frame.volume = pe_min(m.volume, 0);
        return frame;
    }
    /* Again about the centre itself, so that nothing cancels. */
    pe_vec3 centre = pe_madd(origin, 1 / m.volume, m.first);
    m = integrate(def, centre);
    frame.volume = m.volume;
    frame.centre = pe_madd(centre, 1 / m.volume, m.first);
    double f = 1 / m.volume;
    const double *s = m.second;
    double a[3][3] = {
        {f * (s[1] + s[2]), -f * s[5], -f * s[4]},
        {-f * s[5], f * (s[2] + s[0]), -f * s[3]},
        {-f * s[4], -f * s[3], f * (s[0] + s[1])},
    };
    double axes[3][3];
    pe_principal_axes(a, axes);
    frame.inertia = pe_v3(a[0][0], a[1][1], a[2][2]);
    frame.orientation = quaternion_of(axes);
    return frame;
}
