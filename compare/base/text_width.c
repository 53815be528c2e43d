#include "text_width.h"

#include "base/text_buffer.h"

#include <utf8proc.h>

/* Bytes of the code point at `c`. *columns is its width, and *point the number, that of a control
 * character for all that is not shown. */
static size_t code_point(const char *c, utf8proc_int32_t *point, int *columns)
{
    const size_t bytes = pl_code_point_length(c);
    const bool is_shown = pl_stand_in(c, bytes) == 0;
    *point = '\n';
    if (is_shown) {
        utf8proc_iterate((const utf8proc_uint8_t *)c, (utf8proc_ssize_t)bytes, point);
    }
    *columns = is_shown ? utf8proc_charwidth(*point) : 1;
    return bytes;
}

size_t pl_character_length(const char *text, int *columns)
{
    utf8proc_int32_t point, next, state = 0;
    int width;
    size_t length = code_point(text, &point, columns);
    while (text[length] != '\0') {
        const size_t bytes = code_point(text + length, &next, &width);
        if (utf8proc_grapheme_break_stateful(point, next, &state)) {
            break;
        }
        length += bytes;
        *columns += width;
        point = next;
    }
    return length;
}

size_t pl_text_fitting(const char *text, int width)
{
    size_t at = 0;
    for (int used = 0, columns = 0; text[at] != '\0'; used += columns) {
        const size_t bytes = pl_character_length(text + at, &columns);
        if (columns > width - used) {
            break;
        }
        at += bytes;
    }
    return at;
}

int pl_text_width(const char *text)
{
    int width = 0;
    for (int columns = 0; *text != '\0'; width += columns) {
        text += pl_character_length(text, &columns);
    }
    return width;
}
