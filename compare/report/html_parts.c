#include "report/html_parts.h"

#include <string.h>

void pl_html_open_cell(pl_sheet *sheet, const char *classes, const char *note)
{
    pl_sheet_format(sheet, "<td class=\"%s\"", classes);
    if (note[0] != '\0')
        pl_sheet_add_element(sheet, " title=\"", note, "\"");
    pl_sheet_add(sheet, ">");
}

const char *pl_html_class(const pl_cell *cell)
{
    if (cell->ok)
        return "n ok";
    return strcmp(cell->outcome, "unsupported") == 0 ? "n none" : "n bad";
}

void pl_html_badge(const pl_cell *cell, pl_sheet *sheet)
{
    pl_sheet_format(sheet, "<span class=\"badge %s\">", pl_html_class(cell) + strlen("n "));
    pl_sheet_add_html(sheet, cell->outcome);
    if (cell->outcomes_differ)
        pl_sheet_format(sheet, " in %d of %d", cell->repeats - cell->ok_repeats, cell->repeats);
    pl_sheet_add(sheet, "</span>");
}
