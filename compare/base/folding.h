/* Text that fits the window of a terminal: long lines are broken at blanks, and nothing is cut off. */
#ifndef PLUMB_FOLDING_H
#define PLUMB_FOLDING_H

#include "base/text_buffer.h"

#include <stdio.h>

/* ---- The width of UTF-8 text on a terminal, in columns: a Chinese character has two, a combining accent none. Code
 * points that pl_text_add_plain replaces count as what it shows. ---- */

/* Bytes of the first character of `text` as a reader counts them, a grapheme cluster (Unicode
 * Standard Annex 29), which no line may break. *columns is its width. `text` is not empty. */
size_t pl_character_length(const char *text, int *columns);

/* The width of a text. */
int pl_text_width(const char *text);

/* Bytes of the longest start of `text`, in whole characters, that is at most `width` wide. */
size_t pl_text_fitting(const char *text, int width);

enum { PL_LEAST_WINDOW = 40, PL_PIPE_WIDTH = 120 };

/* The width that text for `out` may have: of the terminal's window, else of the environment
 * variable COLUMNS, else 80 on a terminal and PL_PIPE_WIDTH elsewhere. At least PL_LEAST_WINDOW. */
int pl_window_width(FILE *out);

/* Whether that width is known: `out` is a terminal, or COLUMNS is set. */
bool pl_window_is_known(FILE *out);

/* The bytes of the first line of `text` when it is broken into lines of at most `width` >= 1: at
 * the last blank that fits; in a longer word after its last sign such as '_', ':' or '/', or else
 * after the last character that fits, at least one. *next is where the next line starts, after the blanks between them. */
size_t pl_fold_line(const char *text, int width, size_t *next);

/* The width of the widest part of `text` between blanks. */
int pl_longest_word(const char *text);

/* Adds text in which each line that is wider than `width` is broken into several. Where two blanks
 * or more part a line into columns, its further lines stand below the last column that starts in
 * its first half; elsewhere they are indented by two blanks more than an indented line or an item
 * "- ". Control characters become '?'. */
void pl_text_add_folded(pl_text_buffer *out, const char *text, int width);

/* Writes a message of one line, formatted as printf does, plain as by pl_make_plain, and a newline. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_print_line(FILE *out, const char *format, ...);

/* Text on its way to a stream, which is folded to its window. */
typedef struct pl_folding {
    FILE *out, *in;
    char *text;
    size_t length;
} pl_folding;

/* Begins folding. Returns the stream to write to, which pl_folding_end closes. */
FILE *pl_folding_begin(pl_folding *folding, FILE *out);

/* Writes what was written, folded, to the stream that pl_folding_begin was given. */
void pl_folding_end(pl_folding *folding);

#endif
