#include "grid.h"
#include "results/store.h"

#include <stdlib.h>
#include <string.h>

static pl_status write_line(const pl_plan *plan, long index, FILE *stream, pl_error *error)
{
    const pl_planned_run run = pl_plan_run(plan, index);
    json_t *identity = pl_planned_run_identity(plan, &run);
    int failed = json_object_set_new(identity, "schema", json_string("plumb.plan/1"));
    failed |= json_object_set_new(identity, "index", json_integer(index));
    char *line = failed != 0 ? NULL : pl_result_to_line(identity);
    json_decref(identity);
    if (line == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the plan");
    }
    fprintf(stream, "%s\n", line);
    free(line);
    return PL_OK;
}

pl_status pl_grid_list(const pl_plan *plan, const char *path, pl_error *error)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    if (stream == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the plan");
    }
    pl_status status = PL_OK;
    for (long i = 0; i < pl_plan_size(plan) && status == PL_OK; ++i) {
        status = write_line(plan, i, stream, error);
    }
    if (fclose(stream) != 0 && status == PL_OK) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for the plan");
    }
    if (status == PL_OK) {
        status = pl_write_text(path, text, length, error);
    }
    free(text);
    return status;
}
