/* Errors, suggestions of names, and numbers given as text. */
#include "number.h"
#include "plumb/base.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

pl_status pl_fail(pl_error *error, pl_status status, const char *format, ...)
{
    if (error == NULL) {
        return status;
    }
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    if (length < 0) {
        error->message[0] = '\0';
    } else if ((size_t)length >= sizeof error->message) {
        /* A cut must not leave half a UTF-8 character: drop its continuation bytes, then its head.
         */
        size_t end = sizeof error->message - 1;
        while (end > 0 && ((unsigned char)error->message[end - 1] & 0xC0u) == 0x80u) {
            end--;
        }
        if (end > 0 && (unsigned char)error->message[end - 1] >= 0xC0u) {
            end--;
        }
        error->message[end] = '\0';
    }
    return status;
}

enum { LONGEST_WORD = 255 };

/* Levenshtein's distance by Wagner and Fischer 1974, one row at a time; both words at most
 * LONGEST_WORD. */
static size_t edit_distance(const char *a, size_t a_length, const char *b, size_t b_length)
{
    size_t row[LONGEST_WORD + 1];
    for (size_t j = 0; j <= b_length; j++) {
        row[j] = j;
    }
    for (size_t i = 1; i <= a_length; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            size_t inserted = (row[j - 1] < row[j] ? row[j - 1] : row[j]) + 1;
            diagonal = row[j];
            row[j] = replaced < inserted ? replaced : inserted;
        }
    }
    return row[b_length];
}

const char *pl_nearest_name(const char *word, const char *const *candidates, int count)
{
    size_t length = strlen(word);
    if (length > LONGEST_WORD) {
        return NULL;
    }
    size_t limit = 1 + length / 3;
    const char *nearest = NULL;
    for (int i = 0; i < count; i++) {
        size_t other = strlen(candidates[i]);
        size_t at_least = other > length ? other - length : length - other;
        if (other > LONGEST_WORD || at_least > limit) {
            continue;
        }
        size_t distance = edit_distance(word, length, candidates[i], other);
        if (distance <= limit && (nearest == NULL || distance < limit)) {
            nearest = candidates[i];
            if (distance == 0) {
                break;
            }
            limit = distance;
        }
    }
    return nearest;
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
