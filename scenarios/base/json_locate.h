/* Where something stands in JSON text. jansson gives a place for syntax errors alone; this walks
 * text that it has already read without error to the value at a path. */
#ifndef PLUMB_SCENE_LOCATE_H
#define PLUMB_SCENE_LOCATE_H

#include "diagnostic.h"

/* Offset of the value at `path`, or with `at_key` of the last step's key. Where the path goes on
 * beyond what is there, that of the innermost object or array that is: so a missing key is at its
 * object. `text` must be valid JSON, no key twice in an object. O(length). */
size_t pl_locate_path(const char *text, size_t length, const pl_path *path, bool at_key);

/* Offset of the first byte of the token whose last byte is just before `end`, `text` being JSON up
 * to there: where a fault begins that jansson saw at its end. */
size_t pl_locate_token(const char *text, size_t end);

/* Line and column of an offset, from 1. Columns count characters (Unicode code points), not bytes.
 */
void pl_locate_offset(const char *text, size_t offset, int *line, int *column);

#endif
