#include "html_parts.h"

#include <string.h>

void pl_html_open_cell(pl_text_buffer *out, const char *classes, const char *note)
{
    pl_text_format(out, "<td class=\"%s\"", classes);
    if (note[0] != '\0')
        pl_text_add_element(out, " title=\"", note, "\"");
    pl_text_add(out, ">");
}

const char *pl_html_class(const pl_cell *cell)
{
    if (cell->ok)
        return "n ok";
    return strcmp(cell->outcome, "unsupported") == 0 ? "n none" : "n bad";
}

void pl_html_badge(const pl_cell *cell, pl_text_buffer *out)
{
    pl_text_format(out, "<span class=\"badge %s\">", pl_html_class(cell) + strlen("n "));
    pl_text_add_html(out, cell->outcome);
    if (cell->outcomes_differ)
        pl_text_format(out, " in %d of %d", cell->repeats - cell->ok_repeats, cell->repeats);
    pl_text_add(out, "</span>");
}
