#include "result_tables.h"

#include "check.h"

#include <stdlib.h>
#include <string.h>

static pl_result_table *build(const pl_result_file *files, int count, const char *home)
{
    const pl_result_table_def def = {
        .files = files, .file_count = count, .has_changes = true, .home = home};
    pl_result_table *table = malloc(sizeof *table);
    pl_error error = {PL_OK, ""};
    assert_non_null(table);
    if (pl_result_table_build(&def, table, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return table;
}

pl_result_table *table_of(const json_t *results)
{
    const pl_result_file file = {.path = "made.jsonl", .results = results};
    const char *home = NULL;
    size_t index;
    json_t *row;
    json_array_foreach((json_t *)results, index, row)
    {
        const bool is_home = strcmp(pl_json_get_text(row, "engine"), "plumb") == 0;
        home = is_home ? "plumb" : home;
    }
    return build(&file, 1, home);
}

pl_result_table *table_of_two(const json_t *first, const json_t *second, bool is_one_snapshot,
                              const char *home)
{
    const pl_result_file files[] = {
        {.path = "first.jsonl", .results = first},
        {.path = "second.jsonl", .results = second, .snapshot = is_one_snapshot ? 0 : 1}};
    return build(files, 2, home);
}

void free_table(const pl_result_table *table)
{
    if (table != NULL) {
        pl_result_table_free((pl_result_table *)table);
        free((pl_result_table *)table);
    }
}
