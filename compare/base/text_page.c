#include "text_page.h"

#include "folding.h"

#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>

static void begin_part(pl_text_page *page, bool is_item)
{
    if (page->out->length > 0 && !(page->in_list && is_item)) {
        pl_text_add(page->out, "\n");
    }
    page->in_list = is_item;
}

/* Adds formatted text after `mark`, folded to `width`; 0: not folded. */
#if defined(__GNUC__)
__attribute__((format(printf, 4, 0)))
#endif
static void
add_folded(pl_text_page *page, const char *mark, int width, const char *format, va_list arguments)
{
    char *text = NULL;
    pl_text_buffer line = {0};
    if (vasprintf(&text, format, arguments) < 0) {
        page->out->failed = true;
        return;
    }
    pl_text_add(&line, mark);
    pl_text_add(&line, text);
    pl_text_add(&line, "\n");
    pl_text_add_folded(page->out, line.failed ? "" : line.data, width > 0 ? width : INT_MAX);
    page->out->failed |= line.failed;
    pl_text_free(&line);
    free(text);
}

static int text_width(const pl_text_page *page)
{
    return page->width > 0 ? page->width : PL_MARKDOWN_WIDTH;
}

void pl_text_page_heading(pl_text_page *page, int level, const char *format, ...)
{
    static const char *const marks[] = {"# ", "## ", "### ", "#### ", "##### ", "###### "};
    va_list arguments;
    va_start(arguments, format);
    begin_part(page, false);
    add_folded(page, page->width > 0 ? "" : marks[level - 1], page->width, format, arguments);
    va_end(arguments);
}

void pl_text_page_paragraph(pl_text_page *page, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    begin_part(page, false);
    add_folded(page, "", text_width(page), format, arguments);
    va_end(arguments);
}

void pl_text_page_item(pl_text_page *page, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    begin_part(page, true);
    add_folded(page, "- ", text_width(page), format, arguments);
    va_end(arguments);
}

void pl_text_page_table(pl_text_page *page, pl_table *table)
{
    if (pl_table_rows(table) > 0) {
        begin_part(page, false);
    }
    table->line_width = page->width;
    pl_table_write(table, page->width > 0 ? PL_TABLE_TEXT : PL_TABLE_MARKDOWN_PADDED, page->out);
    pl_table_free(table);
}
