/* Assertions that print what they compared. cmocka's own assert_float_equal casts to float. */
#ifndef PLUMB_TEST_CHECK_H
#define PLUMB_TEST_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* |actual - expected| <= absolute + relative |expected|; a NaN fails. */
#define assert_close(actual, expected, absolute, relative)                                         \
    check_close((actual), (expected), (absolute), (relative), #actual, __FILE__, __LINE__)

void check_close(double actual, double expected, double absolute, double relative, const char *what,
                 const char *file, int line);

/* actual <= bound; a NaN fails. */
#define assert_at_most(actual, bound) check_at_most((actual), (bound), #actual, __FILE__, __LINE__)

void check_at_most(double actual, double bound, const char *what, const char *file, int line);

/* Fails, printing both, unless `text` contains `part`. */
#define assert_contains(text, part) check_contains((text), (part), __FILE__, __LINE__)

void check_contains(const char *text, const char *part, const char *file, int line);

/* Fails when `text` contains `part`. */
#define assert_absent(text, part) check_absent((text), (part), __FILE__, __LINE__)

void check_absent(const char *text, const char *part, const char *file, int line);

/* Fails unless `text` contains both, the first before the second. */
#define assert_before(text, first, second)                                                         \
    check_before((text), (first), (second), __FILE__, __LINE__)

void check_before(const char *text, const char *first, const char *second, const char *file,
                  int line);

/* How often `text` contains `part`. */
int count_of(const char *text, const char *part);

/* Seeded numbers for random poses: uniform in [low, high). xorshift64*, Vigna 2016. */
typedef struct check_random {
    uint64_t state; /* any value but 0 */
} check_random;

double check_uniform(check_random *random, double low, double high);

/* A uniformly distributed unit quaternion (w, x, y, z). Shoemake 1992. */
void check_quaternion(check_random *random, double quaternion[4]);

/* Direction number `i` of `count` nearly evenly distributed ones: a Fibonacci spiral. */
void check_spiral_direction(int i, int count, double unit[3]);

#endif
