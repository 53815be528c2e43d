/* Texts of an object in a row of results. */
#include "report_row.h"

#include "results/result.h"

const char *pl_row_text_in(const json_t *row, const char *object, const char *key)
{
    return pl_json_get_text(json_object_get(row, object), key);
}
