/* The width of UTF-8 text on a terminal, in columns: a Chinese character has two, a combining
 * accent none. Code points that pl_text_add_plain replaces count as what it shows. */
#ifndef PLUMB_TEXT_WIDTH_H
#define PLUMB_TEXT_WIDTH_H

#include <stddef.h>

/* Bytes of the first character of `text` as a reader counts them, a grapheme cluster (Unicode
 * Standard Annex 29), which no line may break. *columns is its width. `text` is not empty. */
size_t pl_character_length(const char *text, int *columns);

/* The width of a text. */
int pl_text_width(const char *text);

/* Bytes of the longest start of `text`, in whole characters, that is at most `width` wide. */
size_t pl_text_fitting(const char *text, int width);

#endif
