/* Numbers of JSON objects that were checked before, as pl_json_get_text has their texts. */
#ifndef PLUMB_JSON_GET_H
#define PLUMB_JSON_GET_H

#include <jansson.h>

/* The number of a key of an object; 0 where there is none or it is no number. */
static inline double pl_json_get_number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

#endif
