/* What the words of a scene and of options mean in each engine, and what has no counterpart there
 * (engine_words.json, plumb.engine-words/1). */
#ifndef PLUMB_ENGINE_WORDS_H
#define PLUMB_ENGINE_WORDS_H

#include "page.h"
#include "result_matrix.h"

#include <jansson.h>

/* The file as a JSON object, which the caller releases:
 *
 *     {"schema": "plumb.engine-words/1", "engines": [ENGINE, ...],
 *      "words": [{"word": TEXT, "means": {ENGINE: TEXT, ...}}, ...]}
 *
 * NULL: out of memory. */
json_t *pl_engine_words(void);

/* Adds the table of all words for those engines of a report that the file knows; nothing where it
 * knows none. */
void pl_engine_words_add(const pl_result_matrix *matrix, const pl_page *page);

#endif
