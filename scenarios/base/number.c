#include "number.h"

#include "plumb/base.h"

#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Numbers to text ---- */

/* Integers that hold 17 digits times a power of two. */
__extension__ typedef unsigned __int128 wide;

enum { POWERS = 20 };

static const uint64_t powers[POWERS] = {1,
                                        10,
                                        100,
                                        1000,
                                        10000,
                                        100000,
                                        1000000,
                                        10000000,
                                        100000000,
                                        1000000000,
                                        10000000000,
                                        100000000000,
                                        1000000000000,
                                        10000000000000,
                                        100000000000000,
                                        1000000000000000,
                                        10000000000000000,
                                        100000000000000000,
                                        1000000000000000000,
                                        10000000000000000000U};

/* 10^k for k from 0 to 38. */
static wide power_of_ten(int k)
{
    return k < POWERS ? powers[k] : (wide)powers[POWERS - 1] * powers[k - POWERS + 1];
}

/* Writes digits * 10^-places, the way of %g: without zeros at the end. */
static void write_decimal(uint64_t digits, int places, bool negative, char *text)
{
    char decimal[PL_NUMBER_SIZE];
    int first = PL_NUMBER_SIZE;
    for (; places > 0 && digits % 10 == 0; --places) {
        digits /= 10;
    }
    for (; digits > 0; digits /= 100) { /* two at a time, which do not wait for each other */
        const int last = (int)(digits % 100);
        decimal[--first] = (char)('0' + last % 10);
        decimal[--first] = (char)('0' + last / 10);
    }
    first += decimal[first] == '0'; /* of an odd number of digits */
    while (PL_NUMBER_SIZE - first <= places) {
        decimal[--first] = '0';
    }
    const int whole = PL_NUMBER_SIZE - places - first; /* digits before the point */
    *text = '-';
    text += negative;
    memcpy(text, decimal + first, (size_t)whole);
    text[whole] = '.';
    memcpy(text + whole + 1, decimal + first + whole, (size_t)places);
    text[places > 0 ? whole + 1 + places : whole] = '\0';
}

/* Whether a decimal reads back that is `error` away from m 2^-s, both times the same factor, in which
 * the distance to the next double is `ulp`. That to the one before is half as much below a power of
 * two. At the middle between two doubles the even one is read. */
static bool reads_back(wide error, bool is_below, wide ulp, uint64_t m)
{
    const bool is_power = m == UINT64_C(1) << 52;
    const wide reach = is_power && is_below ? 4 * error : 2 * error;
    return reach < ulp || (reach == ulp && m % 2 == 0);
}

/* Whether decimal_text has the text of a number. */
static bool is_plain(double value)
{
    return fabs(value) >= 1e-4 && fabs(value) < 1e15;
}

/* The text with `digits` significant digits, or with more, up to 17, until it reads back. By exact
 * arithmetic of integers: the value is m / 2^s with 2^52 <= m < 2^53 and 2 < s < 67, so that m 10^k,
 * with 17 digits before the point, and 2^s times those digits stay below 2^124. */
static const char *decimal_text(double value, int digits, char *text)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint64_t m = (bits & ((UINT64_C(1) << 52) - 1)) | UINT64_C(1) << 52;
    const int s = 1075 - (int)(bits >> 52 & 0x7ff);
    int places = digits; /* after the point */
    for (double bound = 1; fabs(value) >= bound; bound *= 10) {
        --places;
    }
    for (double bound = 0.1; fabs(value) < bound; bound /= 10) {
        ++places;
    }
    const wide unit = (wide)1 << s, half = unit / 2;
    for (wide power = power_of_ten(places);; ++digits, ++places, power *= 10) {
        const wide scaled = m * power, rest = scaled & (unit - 1);
        const uint64_t cut = (uint64_t)(scaled >> s);
        const bool is_up = rest > half || (rest == half && cut % 2 == 1);
        if (digits == 17 || reads_back(is_up ? unit - rest : rest, !is_up, power, m)) {
            write_decimal(cut + is_up, places, value < 0, text);
            return text;
        }
    }
}

/* The decimal comma of some locales becomes a point. */
static const char *with_point(char *text)
{
    char *not_a_digit = text + strspn(text, "0123456789-+e");
    if (*not_a_digit != '\0') {
        *not_a_digit = '.';
    }
    return text;
}

const char *pl_number_text(double value, char text[PL_NUMBER_SIZE])
{
    if (!isfinite(value)) {
        const char *word = isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
        snprintf(text, PL_NUMBER_SIZE, "%s", word);
        return text;
    }
    if (value == 0) {
        return memcpy(text, signbit(value) ? "-0" : "0", signbit(value) ? 3 : 2);
    }
    if (is_plain(value)) {
        return decimal_text(value, 15, text);
    }
    /* 15 digits survive text to double to text, 17 survive double to text to double: IEEE
     * 754, 5.12.2. */
    int digits = 15;
    do {
        snprintf(text, PL_NUMBER_SIZE, "%.*g", digits, value);
    } while (strtod(text, NULL) != value && ++digits <= 17);
    return with_point(text);
}

/* ---- Text to numbers ---- */

bool pl_decimal(const char *text, size_t length, double *value)
{
    /* 1075 digits are the most that matter: of the smallest double's half. */
    enum { LONGEST = 1200, POINT_SIZE = 8 };
    char copy[LONGEST + POINT_SIZE];
    if (length == 0 || length > LONGEST) {
        return false;
    }
    memcpy(copy, text, length);
    copy[length] = '\0';
    /* strtod would also take blanks, hexadecimals, "inf" and "nan". */
    if (strspn(copy, "+-.0123456789eE") < length) {
        return false;
    }
    const char *local_point = localeconv()->decimal_point;
    const size_t size = strlen(local_point);
    char *point = strchr(copy, '.');
    if (point != NULL && size <= POINT_SIZE) {
        memmove(point + size, point + 1, strlen(point));
        memcpy(point, local_point, size);
    }
    char *stop = NULL;
    *value = strtod(copy, &stop);
    return *stop == '\0' && isfinite(*value);
}

/* A quotient of integers, which has 54 bits or more, and whether there is a rest, decide how to
 * round. */
bool pl_scale_decimal(uint64_t digits, int places, double *value)
{
    if (places >= POWERS) {
        return false;
    }
    const uint64_t power = powers[places];
    if (digits <= UINT64_C(1) << 53) {
        *value = (double)digits / (double)power; /* both exact, and one rounding: Clinger 1990 */
        return true;
    }
    const wide scaled = (wide)digits << 64;
    wide quotient = scaled / power;
    bool has_rest = quotient * power != scaled;
    int shift = 64;
    for (; quotient >> 62 != 0; quotient >>= 1, --shift) {
        has_rest = has_rest || quotient % 2 == 1;
    }
    /* The rest is one bit more, which is at least the 55th: it decides where the others are at the
     * middle between two doubles. */
    *value = ldexp((double)(int64_t)(2 * (uint64_t)quotient + has_rest), -shift - 1);
    return true;
}

bool pl_parse_number(const char *text, double *value)
{
    const char *slash = strchr(text, '/');
    if (slash == NULL) {
        return pl_decimal(text, strlen(text), value);
    }
    double numerator, denominator;
    if (!pl_decimal(text, (size_t)(slash - text), &numerator) ||
        !pl_decimal(slash + 1, strlen(slash + 1), &denominator)) {
        return false;
    }
    *value = numerator / denominator;
    return isfinite(*value);
}
