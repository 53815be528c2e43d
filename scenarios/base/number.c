#include "number.h"

#include "plumb/base.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *pl_number_text(double value, char text[PL_NUMBER_SIZE])
{
    if (!isfinite(value)) {
        const char *word = isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
        snprintf(text, PL_NUMBER_SIZE, "%s", word);
        return text;
    }
    /* 15 digits survive text to double to text, 17 survive double to text to double: IEEE
     * 754, 5.12.2. */
    int digits = 15;
    do {
        snprintf(text, PL_NUMBER_SIZE, "%.*g", digits, value);
    } while (strtod(text, NULL) != value && ++digits <= 17);
    char *not_a_digit = text + strspn(text, "0123456789-+e");
    if (*not_a_digit != '\0') {
        *not_a_digit = '.'; /* the decimal comma of some locales */
    }
    return text;
}

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
