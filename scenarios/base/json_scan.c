#include "json_scan.h"

#include "number.h"

#include <stdint.h>
#include <string.h>

/* The next byte after blanks; a zero at the end of the text. */
static char peek(pl_json_scanner *s)
{
    while (s->at < s->end &&
           (*s->at == ' ' || *s->at == '\n' || *s->at == '\t' || *s->at == '\r')) {
        ++s->at;
    }
    return s->at < s->end ? *s->at : '\0';
}

bool pl_json_scan_mark(pl_json_scanner *s, char mark)
{
    const bool found = peek(s) == mark;
    s->at += found;
    return found;
}

bool pl_json_scan_string(pl_json_scanner *s, const char **text, size_t *length)
{
    if (peek(s) != '"') {
        return false;
    }
    const char *c = *text = s->at + 1;
    while (c < s->end && *c >= ' ' && *c <= '~' && *c != '"' && *c != '\\') {
        ++c;
    }
    *length = (size_t)(c - *text);
    s->at = c + 1;
    return c < s->end && *c == '"';
}

bool pl_json_scan_bool(pl_json_scanner *s, bool *value)
{
    const char *word = peek(s) == 't' ? "true" : "false";
    const size_t length = strlen(word);
    if ((size_t)(s->end - s->at) < length || memcmp(s->at, word, length) != 0) {
        return false;
    }
    *value = word[0] == 't';
    s->at += length;
    return true;
}

/* Digits, of which there is at least one, behind those of *number. */
static bool scan_digits(pl_json_scanner *s, uint64_t *number)
{
    const char *begin = s->at;
    for (; s->at < s->end && *s->at >= '0' && *s->at <= '9'; ++s->at) {
        *number = 10 * *number + (uint64_t)(*s->at - '0');
    }
    return s->at > begin;
}

/* Skips `c` where it is the next byte. */
static bool skip(pl_json_scanner *s, char c)
{
    const bool found = s->at < s->end && *s->at == c;
    s->at += found;
    return found;
}

bool pl_json_scan_number(pl_json_scanner *s, double *value)
{
    enum { MOST_DIGITS = 19 }; /* below 2^64 */
    uint64_t digits = 0, power = 0;
    peek(s);
    const char *begin = s->at;
    const bool is_negative = skip(s, '-');
    const char *first = s->at;
    if (!scan_digits(s, &digits) || (*first == '0' && s->at > first + 1)) {
        return false;
    }
    int places = 0, count = (int)(s->at - first);
    if (skip(s, '.')) {
        const char *point = s->at;
        if (!scan_digits(s, &digits)) {
            return false;
        }
        places = (int)(s->at - point);
        count += places;
    }
    const bool has_exponent = skip(s, 'e') || skip(s, 'E');
    if (has_exponent) {
        (void)(skip(s, '-') || skip(s, '+'));
        if (!scan_digits(s, &power)) {
            return false;
        }
    }
    if (has_exponent || count > MOST_DIGITS || !pl_scale_decimal(digits, places, value)) {
        return pl_decimal(begin, (size_t)(s->at - begin), value);
    }
    *value = is_negative ? -*value : *value;
    return true;
}

bool pl_json_scan_numbers(pl_json_scanner *s, double *values, int count)
{
    bool right = pl_json_scan_mark(s, '[');
    for (int i = 0; i < count && right; ++i) {
        right = (i == 0 || pl_json_scan_mark(s, ',')) && pl_json_scan_number(s, &values[i]);
    }
    return right && pl_json_scan_mark(s, ']');
}
