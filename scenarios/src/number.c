#include "number.h"

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
