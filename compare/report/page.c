#include "page.h"

void pl_page_open(pl_text_buffer *out, const char *title, const char *style)
{
    pl_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                     "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n");
    pl_text_add_element(out, "<title>", title, "</title>\n<style>\n");
    pl_text_add(out, pl_page_css);
    pl_text_add(out, style == NULL ? "" : style);
    pl_text_add(out, "</style>\n</head>\n<body>\n<main>\n");
}

void pl_page_close(pl_text_buffer *out)
{
    pl_text_add(out, "</main>\n</body>\n</html>\n");
}

void pl_page_text(const pl_page *page, const char *text)
{
    if (page->html) {
        pl_text_add_html(page->out, text);
    } else {
        pl_text_add_markdown(page->out, text);
    }
}

void pl_page_heading(const pl_page *page, const char *id, const char *text)
{
    if (page->html) {
        pl_text_add_element(page->out, "<h2 id=\"", id, "\">");
    } else {
        pl_text_add(page->out, "## ");
    }
    pl_page_text(page, text);
    pl_text_add(page->out, page->html ? "</h2>\n" : "\n\n");
}

void pl_page_paragraph(const pl_page *page, const char *style, const char *text)
{
    const bool small = !page->html && style[0] == 'n';
    if (page->html) {
        pl_text_format(page->out, style[0] == '\0' ? "<p>" : "<p class=\"%s\">", style);
    }
    pl_text_add(page->out, small ? "<sub>" : "");
    pl_page_text(page, text);
    pl_text_add(page->out, page->html ? "</p>\n" : small ? "</sub>\n\n" : "\n\n");
}

void pl_page_details(const pl_page *page, const char *summary)
{
    pl_text_add_element(page->out, "<details><summary>", summary, "</summary>\n");
}

void pl_page_table(const pl_page *page, pl_table table, int most)
{
    const pl_table_format format = page->html ? PL_TABLE_HTML : PL_TABLE_MARKDOWN;
    const char *blank = page->html ? "" : "\n"; /* Markdown wants one before and after a table */
    const int rows = pl_table_rows(&table);
    table.last = most == 0 || rows < most ? rows : most;
    if (rows > 0) {
        pl_table_write(&table, format, page->out);
        pl_text_add(page->out, blank);
    }
    if (rows > table.last) {
        table.first = table.last;
        table.last = rows;
        pl_text_format(page->out, "<details><summary>%d more</summary>\n%s", rows - table.first,
                       blank);
        pl_table_write(&table, format, page->out);
        pl_text_format(page->out, "%s</details>\n%s", blank, blank);
    }
    page->out->failed |= table.texts.failed;
    pl_table_free(&table);
}

void pl_page_add_markup(pl_table *table, pl_text_buffer *markup)
{
    table->texts.failed |= markup->failed;
    pl_table_add_markup(table, markup->data == NULL ? "" : markup->data);
    pl_text_free(markup);
}
