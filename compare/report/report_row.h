/* Texts of an object in a row of results. */
#ifndef PLUMB_ROW_H
#define PLUMB_ROW_H

#include <jansson.h>

/* A text of an object in a row; "" when it is absent or no text. */
const char *pl_row_text_in(const json_t *row, const char *object, const char *key);

#endif
