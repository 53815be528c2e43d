#include "sweep_report.h"

#include "results/store.h"
#include "studies/sweep/analysis.h"
#include "sweep_html.h"
#include "sweep_tables.h"

#include <stdlib.h>

enum { SHOWN_LOSSES = 20, SHOWN_FAILED = 20 };

static pl_status write_in(const char *directory, const char *name, const char *text, size_t length,
                          pl_error *error)
{
    pl_text_buffer path = {0};
    pl_text_format(&path, "%s/%s", directory, name);
    pl_status status = path.failed ? pl_fail(error, PL_NO_MEMORY, "out of memory to write %s", name)
                                   : pl_write_text(path.data, text, length, error);
    pl_text_free(&path);
    return status;
}

pl_status pl_sweep_report_write(const char *directory, const pl_sweep_analysis *analysis,
                                pl_error *error)
{
    pl_text_buffer page = {0}, lines = {0};
    json_t *json = pl_sweep_to_json(analysis);
    char *text = json == NULL
                     ? NULL
                     : json_dumps(json, JSON_SORT_KEYS | JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    pl_sweep_page(analysis, &page);
    if (text != NULL)
        pl_text_format(&lines, "%s\n", text);
    pl_status status = PL_OK;
    if (text == NULL || page.failed || lines.failed)
        status = pl_fail(error, PL_NO_MEMORY, "out of memory to report %d points",
                         analysis->point_count);
    if (status == PL_OK)
        status = write_in(directory, "sweep.json", lines.data, lines.length, error);
    if (status == PL_OK)
        status = write_in(directory, "sweep.html", page.data, page.length, error);
    free(text);
    json_decref(json);
    pl_text_free(&lines);
    pl_text_free(&page);
    return status;
}

/* Writes the first `most` rows under a heading, frees the table, and says how many are left out. */
static void print_table(const char *heading, pl_sweep_table *table, int most,
                        pl_text_buffer *buffer)
{
    int rows = pl_sweep_table_rows(table), shown = rows < most ? rows : most;
    buffer->failed |= table->texts.failed;
    if (rows > 0) {
        pl_text_add(buffer, "\n");
        pl_text_add_plain(buffer, heading, 200);
        pl_text_add(buffer, "\n\n");
    }
    pl_sweep_table_text(table, 0, shown, buffer);
    if (rows > shown)
        pl_text_format(buffer, "and %d more\n", rows - shown);
    pl_sweep_table_free(table);
}

static void print_problem(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                          pl_text_buffer *buffer)
{
    pl_sweep_table table;
    pl_text_buffer heading = {0};
    pl_text_format(&heading, "%s: least CPU time for a simulated second, by %s%s%s", scene->name,
                   scene->primary_error, scene->unit[0] == '\0' ? "" : ", ", scene->unit);
    pl_sweep_costs_table(analysis, scene, true, &table);
    buffer->failed |= heading.failed;
    if (scene->primary_error[0] != '\0' && !heading.failed)
        print_table(heading.data, &table, table.cells, buffer);
    else
        pl_sweep_table_free(&table);
    pl_text_free(&heading);
}

void pl_sweep_report_print(FILE *out, const pl_sweep_analysis *analysis)
{
    pl_text_buffer buffer = {0};
    pl_sweep_table table;
    pl_sweep_statement(analysis, &buffer);
    pl_text_add(&buffer, "\n");
    pl_sweep_warning(analysis, &buffer);
    pl_sweep_losses_table(analysis, &table);
    print_table("Where plumb loses", &table, SHOWN_LOSSES, &buffer);
    pl_sweep_means_table(analysis, true, PL_SWEEP_MATCHED_LEVEL, &table);
    print_table("Speed of plumb at errors of at most 1e-3, over all problems", &table, table.cells,
                &buffer);
    for (int i = 0; i < analysis->scene_count; i++)
        print_problem(analysis, &analysis->scenes[i], &buffer);
    if (analysis->profile_count > PL_SWEEP_MATCHED_LEVEL) {
        pl_sweep_shares_table(analysis, &analysis->profiles[PL_SWEEP_MATCHED_LEVEL], &table);
        print_table("Problems solved to 1e-3, within a factor of the fastest", &table, table.cells,
                    &buffer);
    }
    pl_sweep_orders_table(analysis, -1, &table);
    print_table("Order of convergence", &table, table.cells, &buffer);
    pl_sweep_failed_table(analysis, -1, &table);
    print_table("Points without numbers", &table, SHOWN_FAILED, &buffer);
    fputs(buffer.failed ? "out of memory to print the sweep\n" : buffer.data, out);
    pl_text_free(&buffer);
}
