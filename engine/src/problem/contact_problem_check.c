/* The rules of contact problems given as data. */
#include "plumb/contact_problem.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* The rounding of frames that were written with all digits. */
static const double FRAME_TOLERANCE = 1e-9;

/* The smallest pivot of an inertia, as a part of its trace; the inverse of a smaller one would be
 * rounding. */
static const double PIVOT_TOLERANCE = 1e-12;

/* Where a check is made. */
typedef struct place {
    const char *list;
    int index;
    pe_problem_fault *fault; /* NULL: not wanted */
} place;

/* Sets the fault of a field, with a text as of printf, and returns false. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static bool
report_fault(const place *at, const char *field, const char *format, ...)
{
    if (at->fault != NULL) {
        *at->fault = (pe_problem_fault){.list = at->list, .index = at->index, .field = field};
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(at->fault->text, sizeof at->fault->text, format, arguments);
        va_end(arguments);
    }
    return false;
}

static bool are_finite(const place *at, const char *field, const double *values, int count)
{
    for (int k = 0; k < count; ++k) {
        if (!isfinite(values[k])) {
            return report_fault(at, field, "expected finite numbers, found %g", values[k]);
        }
    }
    return true;
}

/* Whether a symmetric matrix is positive definite, by the pivots of its factorisation. */
static bool is_positive_definite(const double m[6])
{
    double least = PIVOT_TOLERANCE * (m[0] + m[3] + m[5]);
    double first = m[0];
    if (!(least > 0) || !(first > least)) {
        return false;
    }
    double second = m[3] - m[1] * m[1] / first, coupling = m[4] - m[1] * m[2] / first;
    return second > least && m[5] - m[2] * m[2] / first - coupling * coupling / second > least;
}

static bool check_body(const pe_problem_body *body, const place *at)
{
    const double *m = body->inertia;
    if (!(body->mass > 0) || !isfinite(body->mass)) {
        return report_fault(at, "mass", "expected a finite number above 0, found %g", body->mass);
    }
    if (!are_finite(at, "inertia", m, 6)) {
        return false;
    }
    if (!is_positive_definite(m)) {
        return report_fault(
            at, "inertia",
            "expected xx xy xz yy yz zz of a positive definite matrix, found %g %g %g "
            "%g %g %g",
            m[0], m[1], m[2], m[3], m[4], m[5]);
    }
    return are_finite(at, "free_velocity", body->free_velocity, 6);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool check_frame(const double frame[3][3], const place *at)
{
    if (!are_finite(at, "frame", frame[0], 9)) {
        return false;
    }
    for (int k = 0; k < 3; ++k) {
        for (int l = k; l < 3; ++l) {
            double product = dot(frame[k], frame[l]);
            if (fabs(product - (k == l)) > FRAME_TOLERANCE) {
                return report_fault(
                    at, "frame",
                    "expected orthonormal rows n, t1, t2, found row %d . row %d = %.10g", k + 1,
                    l + 1, product);
            }
        }
    }
    const double *n = frame[0], *t = frame[1];
    double cross[3] = {n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2],
                       n[0] * t[1] - n[1] * t[0]};
    return dot(cross, frame[2]) > 0 ||
           report_fault(at, "frame", "expected a right-handed n, t1, t2, found a left-handed one");
}

static bool check_body_index(const pe_contact_problem *problem, int index, const char *field,
                             const place *at)
{
    return (index >= PE_STATIC && index < problem->body_count) ||
           report_fault(at, field,
                        "expected an index of the %d bodies, or -1 for a static body, found %d",
                        problem->body_count, index);
}

static bool check_manifold(const pe_contact_problem *problem, const pe_problem_manifold *m,
                           int first, const place *at)
{
    if (!check_body_index(problem, m->a, "a", at) || !check_body_index(problem, m->b, "b", at)) {
        return false;
    }
    if (m->a == m->b) {
        return report_fault(at, "b", "expected another body than a, found %d for both", m->b);
    }
    if (m->first != first) {
        return report_fault(at, "first",
                            "expected %d, where the points of the manifold before end, found %d",
                            first, m->first);
    }
    if (m->count < 1 || m->count > problem->point_count - first) {
        return report_fault(at, "count", "expected 1 to %d points, found %d",
                            problem->point_count - first, m->count);
    }
    if (!(m->friction >= 0) || !isfinite(m->friction)) {
        return report_fault(at, "friction", "expected a finite number of at least 0, found %g",
                            m->friction);
    }
    return check_frame(m->frame, at) &&
           (m->a == PE_STATIC || are_finite(at, "arm_a", m->arm_a, 3)) &&
           (m->b == PE_STATIC || are_finite(at, "arm_b", m->arm_b, 3));
}

static bool check_point(const pe_problem_manifold_point *point, const place *at)
{
    return are_finite(at, "offset", point->offset, 3) && are_finite(at, "bias", &point->bias, 1) &&
           are_finite(at, "slip", point->slip, 2) && are_finite(at, "impulse", point->impulse, 3);
}

bool pe_contact_problem_is_valid(const pe_contact_problem *problem, pe_problem_fault *fault)
{
    place at = {.list = "bodies", .fault = fault};
    for (at.index = 0; at.index < problem->body_count; ++at.index) {
        if (!check_body(&problem->bodies[at.index], &at)) {
            return false;
        }
    }
    int first = 0;
    at.list = "manifolds";
    for (at.index = 0; at.index < problem->manifold_count; ++at.index) {
        const pe_problem_manifold *m = &problem->manifolds[at.index];
        if (!check_manifold(problem, m, first, &at)) {
            return false;
        }
        first += m->count;
    }
    at.list = "points";
    for (at.index = 0; at.index < first; ++at.index) {
        if (!check_point(&problem->points[at.index], &at)) {
            return false;
        }
    }
    return first == problem->point_count ||
           report_fault(&at, "impulse", "expected a manifold that has this point, found none");
}
