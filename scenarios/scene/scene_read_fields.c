#include "scene_read_fields.h"

#include "base/text_buffer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool pl_read_keys(const json_t *json, pl_object_kind kind, pl_diagnostic *diagnostic)
{
    enum { MOST_KEYS = 16 };
    const pl_object *object = &pl_objects[kind];
    const char *keys[MOST_KEYS];
    for (int i = 0; i < object->field_count; ++i) {
        keys[i] = object->fields[i].key;
    }
    const pl_key_set set = {.object = object->name, .keys = keys, .count = object->field_count};
    return pl_json_object(json, &set, diagnostic);
}

bool pl_read_word(const json_t *object, const char *key, pl_presence presence,
                  const char *const *words, int count, int *index, pl_diagnostic *diagnostic)
{
    char expected[160] = "";
    for (int i = 0; i < count; ++i) {
        const size_t used = strlen(expected);
        snprintf(expected + used, sizeof expected - used, "%s%s",
                 i == 0           ? ""
                 : i == count - 1 ? " or "
                                  : ", ",
                 words[i]);
    }
    const char *word = NULL;
    if (!pl_json_string(object, key, presence, expected, &word, diagnostic)) {
        return false;
    }
    for (int i = 0; i < count && word != NULL; ++i) {
        if (strcmp(word, words[i]) == 0) {
            *index = i;
            return true;
        }
    }
    char quoted[PL_QUOTED_SIZE];
    return word == NULL || pl_diagnose_field(diagnostic, key, "expected %s, found %s", expected,
                                             pl_quoted(word, quoted));
}

/* A line of text, which may be absent. */
static bool read_text(const json_t *object, const char *key, char text[PL_TEXT_SIZE],
                      pl_diagnostic *diagnostic)
{
    const char *read = NULL;
    if (!pl_json_string(object, key, PL_OPTIONAL, "a text", &read, diagnostic)) {
        return false;
    }
    if (read != NULL && strlen(read) >= PL_TEXT_SIZE) {
        return pl_diagnose_field(diagnostic, key, "expected a text of at most %d bytes, found %zu",
                                 PL_TEXT_SIZE - 1, strlen(read));
    }
    if (read != NULL) {
        memcpy(text, read, strlen(read) + 1);
        pl_make_plain(text);
    }
    return true;
}

bool pl_read_field(const json_t *object, const pl_field *field, void *item,
                   pl_diagnostic *diagnostic)
{
    const char *key = field->key;
    const pl_presence presence = field->need == PL_NEED_ALWAYS ? PL_REQUIRED : PL_OPTIONAL;
    void *value = (char *)item + field->offset;
    int index = 0;
    switch (field->type) {
    case PL_FIELD_NUMBER:
        if (field->nullable && json_is_null(json_object_get(object, key))) {
            *(double *)value = (double)INFINITY;
            return true;
        }
        return pl_json_number(object, key, presence, value, diagnostic);
    case PL_FIELD_VECTOR:
    case PL_FIELD_INERTIA:
        return pl_json_vector(object, key, presence, value, 3, diagnostic);
    case PL_FIELD_UNIT:
        return pl_json_unit(object, key, presence, value, 3, diagnostic);
    case PL_FIELD_QUATERNION:
        return pl_json_unit(object, key, presence, value, 4, diagnostic);
    case PL_FIELD_BOOL:
        return pl_json_bool(object, key, value, diagnostic);
    case PL_FIELD_NAME:
        return pl_json_name(object, key, presence, value, diagnostic);
    case PL_FIELD_TEXT:
        return read_text(object, key, value, diagnostic);
    case PL_FIELD_WORD:
        memcpy(&index, value, sizeof index); /* an enumeration has the size of an int */
        if (!pl_read_word(object, key, presence, field->words, field->word_count, &index,
                          diagnostic)) {
            return false;
        }
        memcpy(value, &index, sizeof index);
        return true;
    default:
        return true;
    }
}
