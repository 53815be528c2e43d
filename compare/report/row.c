/* Texts of a row of results. */
#include "report/row.h"

const char *pl_row_text(const json_t *row, const char *key)
{
    const char *text = json_string_value(json_object_get(row, key));
    return text == NULL ? "" : text;
}

const char *pl_row_text_in(const json_t *row, const char *object, const char *key)
{
    return pl_row_text(json_object_get(row, object), key);
}
