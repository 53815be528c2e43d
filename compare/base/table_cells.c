/* Reading a table. */
#include "table.h"

int pl_table_rows(const pl_table *table)
{
    return table->column_count == 0 ? 0 : table->cell_count / table->column_count;
}

const char *pl_table_text(const pl_table *table, int row, int column)
{
    if (row < 0) {
        return table->texts.data + table->headings[column].text;
    }
    const pl_table_cell *cells = &table->cells[row * table->column_count];
    for (int k = 0; k < column; ++k) {
        if (cells[k].is_span) {
            return NULL;
        }
    }
    return table->texts.data + cells[column].text;
}
