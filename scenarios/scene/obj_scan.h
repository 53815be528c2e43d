/* Lines and words of an .obj file. */
#ifndef PLUMB_OBJ_SCAN_H
#define PLUMB_OBJ_SCAN_H

#include "plumb/base.h"

#include <stddef.h>

typedef struct pl_obj_scan {
    const char *at, *end;
    int line; /* from 1 */
    const char *label;
    pl_error *error;
} pl_obj_scan;

typedef struct pl_obj_word {
    const char *text; /* borrowed */
    size_t length;    /* 0: the line has ended */
} pl_obj_word;

/* The next word of the line; comments and joined lines are passed over. */
pl_obj_word pl_obj_next_word(pl_obj_scan *s);

/* To the line after the words; false at the end of the text. */
bool pl_obj_next_line(pl_obj_scan *s);

bool pl_obj_word_is(pl_obj_word word, const char *text);

/* PL_BAD_INPUT: LABEL:LINE: expected ..., found the word. */
pl_status pl_obj_fail(const pl_obj_scan *s, int line, const char *expected, pl_obj_word found);

#endif
