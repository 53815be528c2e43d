/* Vectors and rotations written out once more, by other formulas than plumb/vec.h, so that the
 * tests of the adapters do not lean on what the adapters use. Quaternions are (w, x, y, z) and
 * unit. */
#ifndef PLUMB_TEST_ROTATION_H
#define PLUMB_TEST_ROTATION_H

void cross(const double a[3], const double b[3], double out[3]);
double distance(const double a[3], const double b[3]);
void to_world(const double q[4], const double v[3], double out[3]);
void to_body(const double q[4], const double v[3], double out[3]);

/* Hamilton's product: the rotation b, then a. `out` is neither. */
void quaternion_product(const double a[4], const double b[4], double out[4]);

/* The angle of the rotation from one orientation to another, from the chord of the quaternions. */
double angle_between(const double a[4], const double b[4]);

#endif
