#include "json_writer.h"

#include "number.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put_bytes(pl_json_writer *w, const char *bytes, size_t length)
{
    if (w->length + length + 1 > w->capacity && !w->out_of_memory) {
        size_t capacity = 2 * (w->length + length + 1);
        char *grown = realloc(w->text, capacity);
        if (grown == NULL) {
            w->out_of_memory = true;
        } else {
            w->text = grown;
            w->capacity = capacity;
        }
    }
    if (w->out_of_memory) {
        return;
    }
    memcpy(w->text + w->length, bytes, length);
    w->length += length;
    w->text[w->length] = '\0';
}

void pl_put(pl_json_writer *w, const char *text)
{
    put_bytes(w, text, strlen(text));
}

void pl_put_string(pl_json_writer *w, const char *string)
{
    pl_put(w, "\"");
    for (const char *c = string; *c != '\0'; c++) {
        char escaped[8];
        if ((unsigned char)*c < 0x20) {
            snprintf(escaped, sizeof escaped, "\\u%04x", (unsigned)*c);
            pl_put(w, escaped);
        } else {
            pl_put(w, *c == '"' || *c == '\\' ? "\\" : "");
            put_bytes(w, c, 1);
        }
    }
    pl_put(w, "\"");
}

void pl_put_number(pl_json_writer *w, double value)
{
    char text[PL_NUMBER_SIZE];
    pl_put(w, isfinite(value) ? pl_number_text(value, text) : "null");
}

void pl_put_vector(pl_json_writer *w, const double *values, int count)
{
    pl_put(w, "[");
    for (int i = 0; i < count; i++) {
        pl_put(w, i == 0 ? "" : ", ");
        pl_put_number(w, values[i]);
    }
    pl_put(w, "]");
}

void pl_put_key(pl_json_writer *w, const char *before, const char *key)
{
    pl_put(w, before);
    pl_put_string(w, key);
    pl_put(w, ": ");
}

void pl_put_string_member(pl_json_writer *w, const char *before, const char *key, const char *value)
{
    pl_put_key(w, before, key);
    pl_put_string(w, value);
}

void pl_put_number_member(pl_json_writer *w, const char *before, const char *key, double value)
{
    pl_put_key(w, before, key);
    pl_put_number(w, value);
}

void pl_put_vector_member(pl_json_writer *w, const char *before, const char *key,
                          const double *values, int count)
{
    pl_put_key(w, before, key);
    pl_put_vector(w, values, count);
}
