#include "obj_scan.h"

#include "base/diagnostic.h"

#include <string.h>

static char peek(const pl_obj_scan *s, size_t ahead)
{
    return (size_t)(s->end - s->at) > ahead ? s->at[ahead] : '\n';
}

/* Bytes of a line break here: LF, CR LF or CR; 0 where none is. */
static size_t break_size(const pl_obj_scan *s, size_t ahead)
{
    if (peek(s, ahead) == '\r') {
        return (size_t)(s->end - s->at) > ahead + 1 && s->at[ahead + 1] == '\n' ? 2 : 1;
    }
    return peek(s, ahead) == '\n' ? 1 : 0;
}

static bool is_joined(const pl_obj_scan *s)
{
    return s->at < s->end && *s->at == '\\' && break_size(s, 1) > 0;
}

static void skip(pl_obj_scan *s, size_t count)
{
    const size_t left = (size_t)(s->end - s->at);
    s->at += count < left ? count : left;
}

pl_obj_word pl_obj_next_word(pl_obj_scan *s)
{
    while (peek(s, 0) == ' ' || peek(s, 0) == '\t' || is_joined(s)) {
        if (is_joined(s)) {
            skip(s, 1 + break_size(s, 1));
            s->line++;
        } else {
            s->at++;
        }
    }
    if (peek(s, 0) == '#') {
        while (break_size(s, 0) == 0) {
            s->at++;
        }
    }
    const char *begin = s->at;
    while (peek(s, 0) != ' ' && peek(s, 0) != '\t' && break_size(s, 0) == 0 && !is_joined(s)) {
        s->at++;
    }
    return (pl_obj_word){begin, (size_t)(s->at - begin)};
}

bool pl_obj_next_line(pl_obj_scan *s)
{
    while (pl_obj_next_word(s).length > 0) {}
    if (s->at == s->end) {
        return false;
    }
    skip(s, break_size(s, 0));
    s->line++;
    return true;
}

bool pl_obj_word_is(pl_obj_word word, const char *text)
{
    return word.length == strlen(text) && memcmp(word.text, text, word.length) == 0;
}

pl_status pl_obj_fail(const pl_obj_scan *s, int line, const char *expected, pl_obj_word found)
{
    char copy[PL_QUOTED_SIZE], quoted[PL_QUOTED_SIZE];
    const size_t kept = found.length < sizeof copy - 1 ? found.length : sizeof copy - 1;
    memcpy(copy, found.text, kept);
    copy[kept] = '\0';
    for (size_t i = 0; i < kept; i++) {
        copy[i] = (char)((unsigned char)copy[i] < 0x80 && copy[i] != '\0' ? copy[i] : '?');
    }
    return pl_fail(s->error, PL_BAD_INPUT, "%s:%d: expected %s, found %s", s->label, line, expected,
                   found.length == 0 ? "the end of the line" : pl_quoted(copy, quoted));
}
