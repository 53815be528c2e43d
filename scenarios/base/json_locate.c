/* Grammar: RFC 8259. The scanner knows strings, brackets and everything else; the text is valid, so
 * no more is needed to find where values begin and end. */
#include "json_locate.h"

#include <jansson.h>
#include <string.h>

typedef struct scanner {
    const char *text;
    size_t at, length;
} scanner;

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static bool is_mark(char c)
{
    return memchr("{}[]:,", c, 6) != NULL;
}

static void skip_blanks(scanner *s)
{
    while (s->at < s->length && is_blank(s->text[s->at])) {
        s->at++;
    }
}

static char peek(scanner *s)
{
    skip_blanks(s);
    return s->at < s->length ? s->text[s->at] : '\0';
}

static void skip_string(scanner *s)
{
    s->at++;
    while (s->at < s->length && s->text[s->at] != '"') {
        s->at += s->text[s->at] == '\\' ? 2 : 1;
    }
    s->at++;
}

/* A string, a bracket, a comma, a colon, or a word such as a number. */
static void skip_token(scanner *s)
{
    char c = peek(s);
    if (c == '"') {
        skip_string(s);
    } else if (is_mark(c)) {
        s->at++;
    } else {
        while (s->at < s->length && !is_blank(s->text[s->at]) && !is_mark(s->text[s->at]) &&
               s->text[s->at] != '"') {
            s->at++;
        }
    }
    if (s->at > s->length) {
        s->at = s->length;
    }
}

static void skip_value(scanner *s)
{
    long depth = 0;
    do {
        char c = peek(s);
        depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
        skip_token(s);
    } while (depth > 0 && s->at < s->length);
}

/* Whether the string in quotes at text[begin .. end) means `key`. */
static bool key_equals(const char *text, size_t begin, size_t end, const char *key)
{
    const char *inside = text + begin + 1;
    size_t size = end - begin - 2;
    if (memchr(inside, '\\', size) == NULL) {
        return strlen(key) == size && memcmp(inside, key, size) == 0;
    }
    json_t *string = json_loadb(text + begin, end - begin, JSON_DECODE_ANY, NULL);
    bool equal = string != NULL && strcmp(json_string_value(string), key) == 0;
    json_decref(string);
    return equal;
}

/* From a '{' to the value of `key` in it; *key_at is then where the key is. */
static bool enter_key(scanner *s, const char *key, size_t *key_at)
{
    if (peek(s) != '{') {
        return false;
    }
    do {
        s->at++; /* the opening brace or a comma */
        if (peek(s) != '"') {
            return false;
        }
        *key_at = s->at;
        skip_string(s);
        bool found = key_equals(s->text, *key_at, s->at, key);
        skip_token(s); /* the colon */
        if (found) {
            skip_blanks(s);
            return true;
        }
        skip_value(s);
    } while (peek(s) == ',');
    return false;
}

/* From a '[' to item number `index` in it. */
static bool enter_index(scanner *s, int index)
{
    if (peek(s) != '[') {
        return false;
    }
    s->at++;
    for (int i = 0; i < index; i++) {
        if (peek(s) == ']') {
            return false;
        }
        skip_value(s);
        if (peek(s) != ',') {
            return false;
        }
        s->at++;
    }
    return peek(s) != ']';
}

size_t pl_locate_path(const char *text, size_t length, const pl_path *path, bool at_key)
{
    scanner s = {.text = text, .length = length};
    skip_blanks(&s);
    for (int i = 0; i < path->depth && i < PL_PATH_DEPTH; i++) {
        const pl_path_step *step = &path->steps[i];
        const size_t outer = s.at;
        size_t key_at = outer;
        bool found =
            step->key != NULL ? enter_key(&s, step->key, &key_at) : enter_index(&s, step->index);
        if (!found) {
            return outer;
        }
        if (at_key && i == path->depth - 1) {
            return key_at;
        }
    }
    return s.at;
}

size_t pl_locate_token(const char *text, size_t end)
{
    scanner s = {.text = text, .length = end};
    size_t begin = 0;
    for (skip_blanks(&s); s.at < end; skip_blanks(&s)) {
        begin = s.at;
        skip_token(&s);
    }
    return begin;
}

void pl_locate_offset(const char *text, size_t offset, int *line, int *column)
{
    *line = 1;
    *column = 1;
    for (size_t i = 0; i < offset; i++) {
        if (text[i] == '\n') {
            *line += 1;
            *column = 1;
        } else if (((unsigned char)text[i] & 0xC0u) != 0x80u) {
            *column += 1;
        }
    }
}
