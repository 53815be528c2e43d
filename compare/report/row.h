/* Texts of a row of results. */
#ifndef PLUMB_ROW_H
#define PLUMB_ROW_H

#include <jansson.h>

/* A text of a row, or of an object in it; "" when it is absent or no text. */
const char *pl_row_text(const json_t *row, const char *key);
const char *pl_row_text_in(const json_t *row, const char *object, const char *key);

#endif
