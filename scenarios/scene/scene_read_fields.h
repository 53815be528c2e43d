/* Reading the fields of JSON objects by the table of the scene format. */
#ifndef PLUMB_SCENE_READ_FIELDS_H
#define PLUMB_SCENE_READ_FIELDS_H

#include "base/json_field.h"
#include "scene_fields.h"

/* Checks that `json`, at the path as it stands, is an object that has only keys of this kind. */
bool pl_read_keys(const json_t *json, pl_object_kind kind, pl_diagnostic *diagnostic);

/* Reads a field whose value needs nothing but its own text (numbers, vectors, names, words) into
 * `item`, the object's struct. Does nothing for the other types. False after a diagnostic. */
bool pl_read_field(const json_t *object, const pl_field *field, void *item,
                   pl_diagnostic *diagnostic);

/* Reads the member `key`, one of `count` words, as its index. */
bool pl_read_word(const json_t *object, const char *key, pl_presence presence,
                  const char *const *words, int count, int *index, pl_diagnostic *diagnostic);

#endif
