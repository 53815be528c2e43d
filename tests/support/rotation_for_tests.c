#include "rotation_for_tests.h"

#include <math.h>
#include <string.h>

void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* Rows of the rotation matrix, body to world. Shuster 1993, eq. 97. */
static void matrix_of(const double q[4], double m[3][3])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    double rows[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
    };
    memcpy(m, rows, sizeof rows);
}

void to_world(const double q[4], const double v[3], double out[3])
{
    double m[3][3];
    matrix_of(q, m);
    for (int i = 0; i < 3; ++i) {
        out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    }
}

void to_body(const double q[4], const double v[3], double out[3])
{
    double m[3][3];
    matrix_of(q, m);
    for (int i = 0; i < 3; ++i) {
        out[i] = m[0][i] * v[0] + m[1][i] * v[1] + m[2][i] * v[2];
    }
}

void quaternion_product(const double a[4], const double b[4], double out[4])
{
    out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

/* The angle of the rotation from one orientation to another, from the chord of the quaternions. */
double angle_between(const double a[4], const double b[4])
{
    double dot = 0, chord = 0;
    for (int i = 0; i < 4; ++i) {
        dot += a[i] * b[i];
    }
    for (int i = 0; i < 4; ++i) {
        double d = a[i] - (dot < 0 ? -b[i] : b[i]);
        chord += d * d;
    }
    return 4 * asin(fmin(1, sqrt(chord) / 2));
}
