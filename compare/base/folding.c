#include "folding.h"

#include "heap.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utf8proc.h>

/* ---- Width ---- */

/* Bytes of the code point at `c`. *columns is its width, and *point the number, that of a control
 * character for all that is not shown. */
static size_t code_point(const char *c, utf8proc_int32_t *point, int *columns)
{
    const size_t bytes = pl_code_point_length(c);
    const bool is_shown = pl_stand_in(c, bytes) == 0;
    *point = '\n';
    if (is_shown) {
        utf8proc_iterate((const utf8proc_uint8_t *)c, (utf8proc_ssize_t)bytes, point);
    }
    *columns = is_shown ? utf8proc_charwidth(*point) : 1;
    return bytes;
}

size_t pl_character_length(const char *text, int *columns)
{
    utf8proc_int32_t point, next, state = 0;
    int width;
    size_t length = code_point(text, &point, columns);
    while (text[length] != '\0') {
        const size_t bytes = code_point(text + length, &next, &width);
        if (utf8proc_grapheme_break_stateful(point, next, &state)) {
            break;
        }
        length += bytes;
        *columns += width;
        point = next;
    }
    return length;
}

size_t pl_text_fitting(const char *text, int width)
{
    size_t at = 0;
    for (int used = 0, columns = 0; text[at] != '\0'; used += columns) {
        const size_t bytes = pl_character_length(text + at, &columns);
        if (columns > width - used) {
            break;
        }
        at += bytes;
    }
    return at;
}

int pl_text_width(const char *text)
{
    int width = 0;
    for (int columns = 0; *text != '\0'; width += columns) {
        text += pl_character_length(text, &columns);
    }
    return width;
}

/* ---- Folding ---- */

int pl_window_width(FILE *out)
{
    struct winsize size = {0};
    const int file = fileno(out);
    const bool is_terminal = file >= 0 && isatty(file) == 1;
    const char *columns = getenv("COLUMNS");
    long width = is_terminal && ioctl(file, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
    if (width == 0 && columns != NULL) {
        width = strtol(columns, NULL, 10);
    }
    if (width <= 0 || width > 10000) {
        width = is_terminal ? 80 : PL_PIPE_WIDTH;
    }
    return width < PL_LEAST_WINDOW ? PL_LEAST_WINDOW : (int)width;
}

bool pl_window_is_known(FILE *out)
{
    const int file = fileno(out);
    return (file >= 0 && isatty(file) == 1) || getenv("COLUMNS") != NULL;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\n' || c == '\t';
}

size_t pl_fold_line(const char *text, int width, size_t *next)
{
    size_t at = 0, word = 0, part = 0; /* where the last word, and a part of a word, ended */
    for (int used = 0, columns = 0; text[at] != '\0'; used += columns) {
        const size_t bytes = pl_character_length(text + at, &columns);
        if (at > 0 && used + columns > width) {
            break;
        }
        if (is_blank(text[at]) && at > 0 && !is_blank(text[at - 1])) {
            word = at;
        } else if (strchr("_:/,;=@-", text[at]) != NULL) {
            part = at + bytes;
        }
        at += bytes;
    }
    size_t end = at;
    if (text[at] != '\0' && !is_blank(text[at])) {
        end = word > 0 ? word : part > 0 ? part : at;
    }
    for (*next = end; is_blank(text[*next]); ++*next) {}
    for (; end > 0 && is_blank(text[end - 1]); --end) {}
    return end;
}

int pl_longest_word(const char *text)
{
    int longest = 0, used = 0;
    for (size_t bytes = 0; *text != '\0'; text += bytes) {
        int columns;
        bytes = pl_character_length(text, &columns);
        used = is_blank(*text) ? 0 : used + columns;
        longest = used > longest ? used : longest;
    }
    return longest;
}

/* Where the further lines of a line start. */
static int hanging_indent(const char *line, int width)
{
    const int blanks = (int)strspn(line, " ");
    const bool is_item = strncmp(line + blanks, "- ", 2) == 0;
    int indent = blanks + (blanks > 0 || is_item ? 2 : 0), column = blanks;
    for (const char *c = line + blanks; *c != '\0' && column < width / 2;) {
        const int gap = (int)strspn(c, " ");
        int columns = gap;
        c += gap > 0 ? (size_t)gap : pl_character_length(c, &columns);
        column += columns;
        if (gap > 1 && column <= width / 2) {
            indent = column;
        }
    }
    return indent < width / 2 ? indent : width / 2;
}

static void add_folded_line(pl_text_buffer *out, const char *line, int width)
{
    const size_t blanks = strspn(line, " ");
    const int hang = hanging_indent(line, width);
    int indent = (int)blanks < width / 2 ? (int)blanks : width / 2;
    size_t next = 0;
    for (const char *rest = line + blanks; *rest != '\0'; rest += next) {
        const size_t length = pl_fold_line(rest, width - indent, &next);
        pl_text_add_spaces(out, indent);
        pl_text_add_plain(out, rest, length);
        pl_text_add(out, rest[next] == '\0' ? "" : "\n");
        indent = hang;
    }
}

void pl_text_add_folded(pl_text_buffer *out, const char *text, int width)
{
    for (const char *line = text; *line != '\0';) {
        const size_t length = strcspn(line, "\n");
        char *copy = pl_heap_format("%.*s", (int)length, line);
        if (pl_text_width(copy) > width) {
            add_folded_line(out, copy, width);
        } else {
            pl_text_add_plain(out, line, length);
        }
        free(copy);
        pl_text_add(out, line[length] == '\n' ? "\n" : "");
        line += length + (line[length] == '\n');
    }
}

void pl_print_line(FILE *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *line = pl_heap_format_list(format, arguments);
    va_end(arguments);
    fprintf(out, "%s\n", pl_make_plain(line));
    free(line);
}

FILE *pl_folding_begin(pl_folding *folding, FILE *out)
{
    *folding = (pl_folding){.out = out};
    folding->in = open_memstream(&folding->text, &folding->length);
    if (folding->in == NULL) {
        pl_out_of_memory();
    }
    return folding->in;
}

void pl_folding_end(pl_folding *folding)
{
    pl_text_buffer folded = {0};
    if (fclose(folding->in) != 0) {
        pl_out_of_memory();
    }
    pl_text_add_folded(&folded, folding->text, pl_window_width(folding->out));
    pl_text_print(&folded, folding->out);
    free(folding->text);
    *folding = (pl_folding){.out = NULL};
}
