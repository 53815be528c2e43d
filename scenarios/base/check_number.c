#include "check_number.h"

#include "number.h"

#include <math.h>

double pl_norm(const double *vector, int n)
{
    double sum = 0;
    for (int k = 0; k < n; k++) {
        sum += vector[k] * vector[k];
    }
    return sqrt(sum);
}

bool pl_check_number(pl_diagnostic *diagnostic, const char *key, double value, bool right,
                     const char *expected)
{
    if (right) {
        return true;
    }
    char found[PL_NUMBER_SIZE];
    if (key != NULL) {
        pl_path_push_key(&diagnostic->path, key);
    }
    return pl_complain(diagnostic, "expected %s, found %s", expected, pl_number_text(value, found));
}

bool pl_check_is_finite(pl_diagnostic *diagnostic, const char *key, double value)
{
    return pl_check_number(diagnostic, key, value, isfinite(value), "a finite number");
}

bool pl_check_positive(pl_diagnostic *diagnostic, const char *key, double value)
{
    return pl_check_number(diagnostic, key, value, isfinite(value) && value > 0,
                           "a finite number above 0");
}

bool pl_check_vector(pl_diagnostic *diagnostic, const char *key, const double vector[3])
{
    pl_path_push_key(&diagnostic->path, key);
    for (int k = 0; k < 3; k++) {
        if (!isfinite(vector[k])) {
            pl_path_push_index(&diagnostic->path, k);
            return pl_check_is_finite(diagnostic, NULL, vector[k]);
        }
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

bool pl_check_unit(pl_diagnostic *diagnostic, const char *key, const double *vector, int n,
                   const char *expected)
{
    char found[PL_NUMBER_SIZE];
    double norm = pl_norm(vector, n);
    if (fabs(norm - 1) <= PL_UNIT_TOLERANCE) {
        return true;
    }
    return pl_complain_of(diagnostic, key, "expected %s, found one of norm %s", expected,
                          pl_number_text(norm, found));
}

bool pl_check_name(const char *name, size_t length, pl_diagnostic *diagnostic)
{
    if (length == 0 || length >= PL_NAME_SIZE) {
        return pl_complain(diagnostic, "expected a name of 1 to %d bytes, found %zu bytes",
                           PL_NAME_SIZE - 1, length);
    }
    for (size_t i = 0; i < length; i++) {
        if ((unsigned char)name[i] < 0x20 || name[i] == 0x7F) {
            return pl_complain(diagnostic,
                               "expected a name without control characters, found byte 0x%02X",
                               (unsigned)(unsigned char)name[i]);
        }
    }
    return true;
}
