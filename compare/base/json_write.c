#include "json_write.h"

#include "base/number.h"
#include "heap.h"

#include <stdlib.h>
#include <string.h>

/* A text to write to, and its layout. */
typedef struct writer {
    pl_text_buffer *out;
    pl_json_layout layout;
} writer;

static void write_value(const writer *w, const json_t *json, int depth);

/* Bytes that stand for themselves, in one go; the others as escapes. */
static void write_string(const writer *w, const char *text, size_t length)
{
    static const char named[] = "\"\"\\\\\bb\ff\nn\rr\tt"; /* a byte, and its letter */
    pl_text_add_bytes(w->out, "\"", 1);
    for (size_t at = 0, plain = 0; at <= length; ++at) {
        const unsigned char byte = at < length ? (unsigned char)text[at] : '"';
        if (byte >= 0x20 && byte != '"' && byte != '\\') {
            continue;
        }
        pl_text_add_bytes(w->out, text + plain, at - plain);
        plain = at + 1;
        if (at < length) {
            const char *name = named;
            while (*name != '\0' && (unsigned char)*name != byte) {
                name += 2;
            }
            pl_text_format(w->out, *name == '\0' ? "\\u%04X" : "\\%c",
                           *name == '\0' ? byte : (unsigned char)name[1]);
        }
    }
    pl_text_add_bytes(w->out, "\"", 1);
}

/* A real number has a point or an exponent, and the exponent neither a plus nor leading zeros. */
static void write_real(const writer *w, double value)
{
    char text[PL_NUMBER_SIZE];
    const char *exponent = strchr(pl_number_digits(value, text), 'e');
    if (exponent == NULL) {
        pl_text_add(w->out, text);
        pl_text_add(w->out, strchr(text, '.') == NULL ? ".0" : "");
        return;
    }
    pl_text_add_bytes(w->out, text, (size_t)(exponent + 1 - text));
    pl_text_add(w->out, exponent[1] == '-' ? "-" : "");
    pl_text_add(w->out, exponent + 1 + strspn(exponent + 1, "+-0"));
}

/* What stands before an item: a comma unless it is the first, and its line. */
static void write_line(const writer *w, bool is_first, int depth)
{
    pl_text_add_bytes(w->out, ",", is_first ? 0 : 1);
    if (w->layout == PL_JSON_INDENTED) {
        pl_text_add_bytes(w->out, "\n", 1);
        pl_text_add_spaces(w->out, depth);
    }
}

static void write_array(const writer *w, const json_t *json, int depth)
{
    const size_t count = json_array_size(json);
    pl_text_add_bytes(w->out, "[", 1);
    for (size_t i = 0; i < count; ++i) {
        write_line(w, i == 0, depth + 1);
        write_value(w, json_array_get(json, i), depth + 1);
    }
    if (count > 0) {
        write_line(w, true, depth);
    }
    pl_text_add_bytes(w->out, "]", 1);
}

static int compare_keys(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static void write_object(const writer *w, const json_t *json, int depth)
{
    const size_t count = json_object_size(json);
    const char **keys = pl_heap_new(count, sizeof *keys);
    const char *key;
    json_t *value;
    size_t i = 0;
    json_object_foreach((json_t *)json, key, value)
    {
        keys[i++] = key;
    }
    qsort(keys, count, sizeof *keys, compare_keys);
    pl_text_add_bytes(w->out, "{", 1);
    for (i = 0; i < count; ++i) {
        write_line(w, i == 0, depth + 1);
        write_string(w, keys[i], strlen(keys[i]));
        pl_text_add(w->out, w->layout == PL_JSON_INDENTED ? ": " : ":");
        write_value(w, json_object_get(json, keys[i]), depth + 1);
    }
    if (count > 0) {
        write_line(w, true, depth);
    }
    pl_text_add_bytes(w->out, "}", 1);
    free(keys);
}

static void write_value(const writer *w, const json_t *json, int depth)
{
    if (json == NULL) {
        w->out->failed = true;
        return;
    }
    switch (json_typeof(json)) {
    case JSON_OBJECT:
        write_object(w, json, depth);
        return;
    case JSON_ARRAY:
        write_array(w, json, depth);
        return;
    case JSON_STRING:
        write_string(w, json_string_value(json), json_string_length(json));
        return;
    case JSON_INTEGER:
        pl_text_format(w->out, "%" JSON_INTEGER_FORMAT, json_integer_value(json));
        return;
    case JSON_REAL:
        write_real(w, json_real_value(json));
        return;
    case JSON_TRUE:
        pl_text_add(w->out, "true");
        return;
    case JSON_FALSE:
        pl_text_add(w->out, "false");
        return;
    case JSON_NULL:
        pl_text_add(w->out, "null");
        return;
    }
}

void pl_text_add_json_tree(pl_text_buffer *out, const json_t *json, pl_json_layout layout)
{
    const writer w = {out, layout};
    write_value(&w, json, 0);
}
