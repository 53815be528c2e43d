/* Reads JSON text of the usual form without a tree: strings without escapes and beyond ASCII, numbers,
 * true and false. Each function skips blanks, then reads one thing. False when something else stands
 * there, which may be JSON of another form, and the scanner is then anywhere. */
#ifndef PLUMB_JSON_SCAN_H
#define PLUMB_JSON_SCAN_H

#include <stdbool.h>
#include <stddef.h>

/* A place in a text. */
typedef struct pl_json_scanner {
    const char *at, *end; /* the next byte; the one after the last. Borrowed */
} pl_json_scanner;

/* One of {}[]:, which stays unread when it is another. */
bool pl_json_scan_mark(pl_json_scanner *scanner, char mark);

/* A string of printable ASCII without escapes. *text borrows its *length bytes from the scanner's. */
bool pl_json_scan_string(pl_json_scanner *scanner, const char **text, size_t *length);

/* true or false. */
bool pl_json_scan_bool(pl_json_scanner *scanner, bool *value);

/* A number, to the nearest double. */
bool pl_json_scan_number(pl_json_scanner *scanner, double *value);

/* An array of exactly `count` numbers. */
bool pl_json_scan_numbers(pl_json_scanner *scanner, double *values, int count);

#endif
