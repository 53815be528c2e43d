#include "text_fault.h"

#include "check.h"

#include <stdlib.h>
#include <string.h>

char *text_with(const char *text, const char *from, const char *to)
{
    const char *place = strstr(text, from);
    if (place == NULL) {
        fail_msg("the sample has no %s", from);
    }
    size_t before = (size_t)(place - text);
    char *result = malloc(strlen(text) + strlen(to) + 1);
    assert_non_null(result);
    memcpy(result, text, before);
    strcpy(result + before, to);
    strcat(result, place + strlen(from));
    return result;
}

void take_mark(char *text, int *line, int *column)
{
    char *mark = strchr(text, '@');
    assert_non_null(mark);
    *line = 1;
    *column = 1;
    for (const char *c = text; c < mark; ++c) {
        if (*c == '\n') {
            *line += 1;
            *column = 1;
        } else {
            *column += ((unsigned char)*c & 0xC0u) == 0x80u ? 0 : 1;
        }
    }
    memmove(mark, mark + 1, strlen(mark));
}
