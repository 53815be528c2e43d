#include "json_text.h"

#include "file_text.h"
#include "json_field.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Whole numbers as reals: then 1e3, 1000 and -0 all are what they say, and none is too big. */
enum { PARSING = JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL };

/* ---- Places in valid JSON text ---- */

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
    return c == '{' || c == '}' || c == '[' || c == ']' || c == ':' || c == ',';
}

static void skip_blanks(scanner *s)
{
    while (s->at < s->length && is_blank(s->text[s->at])) {
        ++s->at;
    }
}

static char peek(scanner *s)
{
    skip_blanks(s);
    return s->at < s->length ? s->text[s->at] : '\0';
}

/* False when the string has no end. */
static bool skip_string(scanner *s)
{
    ++s->at;
    while (s->at < s->length && s->text[s->at] != '"') {
        s->at += s->text[s->at] == '\\' ? 2 : 1;
    }
    const bool ends = s->at < s->length;
    s->at = ends ? s->at + 1 : s->length;
    return ends;
}

/* A string, a bracket, a comma, a colon, or a word such as a number. */
static void skip_token(scanner *s)
{
    char c = peek(s);
    if (c == '"') {
        skip_string(s);
    } else if (is_mark(c)) {
        ++s->at;
    } else {
        while (s->at < s->length && !is_blank(s->text[s->at]) && !is_mark(s->text[s->at]) &&
               s->text[s->at] != '"') {
            ++s->at;
        }
    }
}

/* By how much a byte outside of strings changes the depth of nesting. */
static const int deeper[256] = {['{'] = 1, ['['] = 1, ['}'] = -1, [']'] = -1};

static void skip_value(scanner *s)
{
    const char first = peek(s);
    long depth = deeper[(unsigned char)first];
    skip_token(s);
    while (depth > 0 && s->at < s->length) {
        const unsigned char c = (unsigned char)s->text[s->at];
        if (c == '"') {
            skip_string(s);
        } else {
            depth += deeper[c];
            ++s->at;
        }
    }
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
        ++s->at; /* the opening brace or a comma */
        if (peek(s) != '"') {
            return false;
        }
        *key_at = s->at;
        if (!skip_string(s)) {
            return false;
        }
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
    ++s->at;
    for (int i = 0; i < index; ++i) {
        if (peek(s) == ']') {
            return false;
        }
        skip_value(s);
        if (peek(s) != ',') {
            return false;
        }
        ++s->at;
    }
    return peek(s) != ']';
}

/* Offset of the value at `path`, or with `at_key` of the last step's key. If the path leads to a
 * missing value, the place is that of the innermost object or array that exists. So a missing key
 * is reported at its object. `text` must be valid JSON, no key twice in an object. O(length). */
static size_t locate_path(const char *text, size_t length, const pl_path *path, bool at_key)
{
    scanner s = {.text = text, .length = length};
    skip_blanks(&s);
    for (int i = 0; i < path->depth && i < PL_PATH_DEPTH; ++i) {
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

/* Offset of the first byte of the token whose last byte is just before `end`, `text` being JSON up
 * to there: where a fault begins that jansson saw at its end. */
static size_t locate_token(const char *text, size_t end)
{
    scanner s = {.text = text, .length = end};
    size_t begin = 0;
    for (skip_blanks(&s); s.at < end; skip_blanks(&s)) {
        begin = s.at;
        skip_token(&s);
    }
    return begin;
}

/* Line and column of an offset, from 1. Columns count characters (code points), not bytes. */
static void locate_offset(const char *text, size_t offset, int *line, int *column)
{
    *line = 1;
    *column = 1;
    for (size_t i = 0; i < offset; ++i) {
        if (text[i] == '\n') {
            *line += 1;
            *column = 1;
        } else if (((unsigned char)text[i] & 0xC0u) != 0x80u) {
            *column += 1;
        }
    }
}

/* ---- Reading ---- */

static pl_status fail_at_offset(const char *text, size_t offset, const char *label,
                                const char *where, const char *what, pl_error *error)
{
    int line, column;
    locate_offset(text, offset, &line, &column);
    return pl_fail(error, PL_BAD_INPUT, "%s:%d:%d: %s: %s", label, line, column, where, what);
}

static pl_status fail_by_syntax(const char *text, size_t length, const char *label,
                                json_error_t *syntax, pl_error *error)
{
    enum json_error_code code = json_error_code(syntax);
    if (pl_json_lacked_memory(syntax)) {
        return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", label);
    }
    size_t end = syntax->position < 0 ? 0 : (size_t)syntax->position;
    end = end < length ? end : length;
    /* jansson stops before a byte that it cannot decode, at the end of the text when it is cut
     * short, and otherwise behind the token that it cannot use. */
    bool at_end = code == json_error_invalid_utf8 || code == json_error_premature_end_of_input;
    size_t offset = at_end ? end : locate_token(text, end);
    char what[JSON_ERROR_TEXT_LENGTH + 48];
    snprintf(what, sizeof what, "expected valid JSON, found: %s", syntax->text);
    for (char *c = what; *c != '\0'; ++c) {
        *c = (char)((unsigned char)*c < 0x20 || *c == 0x7F ? '?' : *c);
    }
    return fail_at_offset(text, offset, label, "JSON syntax", what, error);
}

static pl_status fail_by_diagnostic(const pl_json_kind *kind, const char *text, size_t length,
                                    const char *label, const pl_diagnostic *diagnostic,
                                    pl_error *error)
{
    if (diagnostic->status != PL_BAD_INPUT) {
        return pl_fail(error, diagnostic->status, "%s: %s", label, diagnostic->text);
    }
    char path[256];
    pl_path_text(&diagnostic->path, kind->noun, path, sizeof path);
    size_t offset = locate_path(text, length, &diagnostic->path, diagnostic->at_key);
    return fail_at_offset(text, offset, label, path, diagnostic->text, error);
}

static bool is_all_blank(const char *text, size_t length)
{
    size_t i = 0;
    while (i < length && is_blank(text[i])) {
        ++i;
    }
    return i == length;
}

pl_status pl_json_read_text(const pl_json_kind *kind, const char *text, size_t length,
                            const char *label, void *user, pl_error *error)
{
    if (length > kind->most_bytes) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected at most %zu bytes, found %zu", label,
                       kind->most_bytes, length);
    }
    const size_t mark = pl_byte_order_mark(text, length);
    text += mark;
    length -= mark;
    if (is_all_blank(text, length)) {
        return fail_at_offset(text, 0, label, kind->noun,
                              "expected a JSON object, found an empty file", error);
    }
    json_error_t syntax;
    json_t *json = json_loadb(text, length, PARSING, &syntax);
    if (json == NULL) {
        return fail_by_syntax(text, length, label, &syntax, error);
    }
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_status status = PL_OK;
    if (!kind->read(json, user, &diagnostic)) {
        status = fail_by_diagnostic(kind, text, length, label, &diagnostic, error);
    }
    json_decref(json);
    return status;
}

pl_status pl_json_read_file(const pl_json_kind *kind, const char *path, void *user, pl_error *error)
{
    const pl_file_kind file_kind = {.noun = kind->noun, .most_bytes = kind->most_bytes};
    char *text = NULL;
    size_t length = 0;
    pl_status status = pl_file_read(&file_kind, path, &text, &length, error);
    if (status == PL_OK) {
        status = pl_json_read_text(kind, text, length, pl_file_label(path), user, error);
        free(text);
    }
    return status;
}

/* ---- A long array, item by item ---- */

char *pl_json_take_out(const char *text, size_t length, const char *key, pl_json_items *items,
                       size_t *rest_length)
{
    scanner s = {.text = text, .length = length};
    size_t key_at;
    skip_blanks(&s);
    if (!enter_key(&s, key, &key_at) || peek(&s) != '[') {
        return NULL;
    }
    const size_t begin = s.at;
    skip_value(&s);
    char *rest = text[s.at - 1] == ']' ? malloc(length) : NULL;
    if (rest == NULL) {
        return NULL;
    }
    /* The brackets stay. */
    *items = (pl_json_items){.text = text, .at = begin + 1, .end = s.at - 1, .is_first = true};
    memcpy(rest, text, items->at);
    memcpy(rest + items->at, text + items->end, length - items->end);
    *rest_length = length - (items->end - items->at);
    return rest;
}

bool pl_json_next_item(pl_json_items *items)
{
    scanner s = {.text = items->text, .at = items->at, .length = items->end};
    skip_blanks(&s);
    if (s.at == items->end || items->failed) {
        return false;
    }
    items->failed = !items->is_first && s.text[s.at] != ',';
    items->at = items->is_first ? s.at : s.at + 1;
    items->is_first = false;
    return !items->failed;
}

json_t *pl_json_parse_item(pl_json_items *items)
{
    json_error_t place;
    json_t *item = json_loadb(items->text + items->at, items->end - items->at,
                              PARSING | JSON_DISABLE_EOF_CHECK, &place);
    items->failed = item == NULL;
    items->at = item == NULL ? items->end : items->at + (size_t)place.position;
    return item;
}

json_t *pl_json_parse(const char *text, size_t length)
{
    return json_loadb(text, length, PARSING, NULL);
}
