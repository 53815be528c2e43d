/* The page of a sweep, its tables on a terminal, and the files that hold both. */
#include "sweep_report.h"

#include "base/folding.h"
#include "base/heap.h"
#include "base/json_field.h"
#include "results/store.h"
#include "study_page.h"
#include "sweep_tables.h"

#include <stdlib.h>

enum { PRINTED_ROWS = 20 };

/* ---- Files ---- */

/* Sets what one of the functions of sweep_tables.h says. */
static void set_said(json_t *json, const char *key, const pl_sweep_analysis *analysis,
                     void (*say)(const pl_sweep_analysis *, pl_text_buffer *))
{
    pl_text_buffer said = {0};
    say(analysis, &said);
    if (said.length > 0) {
        json_object_set_new(json, key, pl_json_bytes(said.data, said.length));
    }
    pl_text_free(&said);
}

json_t *pl_sweep_report_json(const pl_sweep_analysis *analysis)
{
    json_t *json = pl_sweep_to_json(analysis);
    set_said(json, "statement", analysis, pl_sweep_statement);
    if (analysis->results->home != NULL) {
        json_object_set_new(json, "home", json_string(analysis->results->home));
    }
    set_said(json, "warning", analysis, pl_sweep_warning);
    set_said(json, "unverified", analysis, pl_sweep_unverified);
    return json;
}

pl_status pl_sweep_report_write(const char *directory, const pl_sweep_analysis *analysis,
                                pl_error *error)
{
    char *path = pl_heap_format("%s/sweep.json", directory);
    json_t *json = pl_sweep_report_json(analysis);
    pl_status status = pl_results_write_json(path, json, error);
    if (status == PL_OK) {
        status = pl_study_page_write(directory, "sweep", "sweep", json, error);
    }
    json_decref(json);
    free(path);
    return status;
}

/* ---- Terminal ---- */

/* Prints the first `most` rows of a table (0: all) under a heading, and frees the table. */
static void print_table(const char *heading, pl_table table, int most, int width,
                        pl_text_buffer *out)
{
    const int rows = pl_table_rows(&table);
    table.last = most == 0 || rows < most ? rows : most;
    table.line_width = width;
    if (rows > 0) {
        pl_text_add(out, "\n");
        pl_text_add_folded(out, heading, width);
        pl_text_add(out, "\n\n");
    }
    pl_table_write(&table, PL_TABLE_TEXT, out);
    if (rows > table.last) {
        pl_text_format(out, "and %d more\n", rows - table.last);
    }
    pl_table_free(&table);
}

static void print_scene(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, int width,
                        pl_text_buffer *out)
{
    char *heading =
        pl_heap_format("%s: least CPU time for a simulated second, by %s%s%s", scene->name,
                       scene->primary_error, scene->unit[0] == '\0' ? "" : ", ", scene->unit);
    if (scene->primary_error[0] != '\0') {
        print_table(heading, pl_sweep_costs_table(analysis, scene, PL_SWEEP_WHOLE), 0, width, out);
    }
    free(heading);
}

void pl_sweep_report_print(FILE *stream, const pl_sweep_analysis *analysis)
{
    pl_text_buffer said = {0}, out = {0};
    const int width = pl_window_width(stream);
    pl_sweep_statement(analysis, &said);
    pl_text_add(&said, "\n");
    pl_sweep_unverified(analysis, &said);
    pl_text_add(&said, "\n");
    pl_sweep_warning(analysis, &said);
    char *words = pl_text_take(&said);
    pl_text_add_folded(&out, words, width);
    free(words);
    if (analysis->results->home != NULL) {
        char *heading = pl_heap_format("Where %s loses", analysis->results->home);
        print_table(heading, pl_sweep_losses_table(analysis), PRINTED_ROWS, width, &out);
        free(heading);
    }
    print_table("Speed of the first over the second at errors of at most 1e-3, over all scenes",
                pl_sweep_means_table(analysis, analysis->shown, PL_SWEEP_MATCHED_LEVEL), 0, width,
                &out);
    print_table("Speed of the first over the second at errors of at most 1e-3, scene by scene",
                pl_sweep_factors_table(analysis, -1, PL_SWEEP_MATCHED_LEVEL), 0, width, &out);
    for (int i = 0; i < analysis->scene_count; ++i) {
        print_scene(analysis, &analysis->scenes[i], width, &out);
    }
    if (analysis->profile_count > PL_SWEEP_MATCHED_LEVEL) {
        print_table("Scenes solved to 1e-3, within a factor of the fastest",
                    pl_sweep_shares_table(analysis, &analysis->profiles[PL_SWEEP_MATCHED_LEVEL]), 0,
                    width, &out);
    }
    print_table("Order of convergence", pl_sweep_orders_table(analysis, -1), 0, width, &out);
    print_table("Points without numbers", pl_sweep_failed_table(analysis, -1), PRINTED_ROWS, width,
                &out);
    pl_text_print(&out, stream);
}
