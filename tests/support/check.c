#include "check.h"

#include <math.h>
#include <string.h>

void check_close(double actual, double expected, double absolute, double relative, const char *what,
                 const char *file, int line)
{
    double tolerance = absolute + relative * fabs(expected);
    if (!(fabs(actual - expected) <= tolerance)) {
        print_error("%s: %.17g, expected %.17g, off by %.3g, tolerance %.3g\n", what, actual,
                    expected, actual - expected, tolerance);
        _fail(file, line);
    }
}

void check_at_most(double actual, double bound, const char *what, const char *file, int line)
{
    if (!(actual <= bound)) {
        print_error("%s: %.17g, expected at most %.17g\n", what, actual, bound);
        _fail(file, line);
    }
}

void check_contains(const char *text, const char *part, const char *file, int line)
{
    if (text == NULL || strstr(text, part) == NULL) {
        print_error("\"%s\"\n  does not contain \"%s\"\n", text == NULL ? "(null)" : text, part);
        _fail(file, line);
    }
}

void check_absent(const char *text, const char *part, const char *file, int line)
{
    if (strstr(text, part) == NULL)
        return;
    print_error("\"%s\" is in the text\n", part);
    _fail(file, line);
}

void check_before(const char *text, const char *first, const char *second, const char *file,
                  int line)
{
    check_contains(text, first, file, line);
    check_contains(text, second, file, line);
    if (strstr(text, first) <= strstr(text, second))
        return;
    print_error("\"%s\" stands after \"%s\"\n", first, second);
    _fail(file, line);
}

int count_of(const char *text, const char *part)
{
    int count = 0;
    for (const char *at = strstr(text, part); at != NULL; at = strstr(at + 1, part))
        ++count;
    return count;
}

double check_uniform(check_random *random, double low, double high)
{
    uint64_t x = random->state;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    random->state = x;
    double unit = (double)((x * UINT64_C(2685821657736338717)) >> 11) * 0x1p-53;
    return low + (high - low) * unit;
}

void check_quaternion(check_random *random, double quaternion[4])
{
    const double two_pi = 6.283185307179586;
    double u = check_uniform(random, 0, 1);
    double a = check_uniform(random, 0, two_pi);
    double b = check_uniform(random, 0, two_pi);
    quaternion[0] = sqrt(u) * cos(b);
    quaternion[1] = sqrt(1 - u) * sin(a);
    quaternion[2] = sqrt(1 - u) * cos(a);
    quaternion[3] = sqrt(u) * sin(b);
}

void check_spiral_direction(int i, int count, double unit[3])
{
    const double golden = 2.399963229728653;
    double z = 1 - (2 * i + 1.0) / count, r = sqrt(1 - z * z);
    unit[0] = r * cos(golden * i);
    unit[1] = r * sin(golden * i);
    unit[2] = z;
}
