#include "analysis_problem.h"

#include "results/result.h"

#include <stdio.h>
#include <string.h>

static void append(char *text, size_t size, const char *part)
{
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s", part);
}

static void name_problem(pl_sweep_problem *problem)
{
    char part[160];
    const json_t *params = json_object_get(problem->row, "params");
    snprintf(problem->name, sizeof problem->name, "%.120s", problem->scenario);
    for (int i = 0; problem->catalogue != NULL && i < problem->catalogue->param_count; ++i) {
        const pl_param *param = &problem->catalogue->params[i];
        const json_t *value = json_object_get(params, param->name);
        bool bare = strcmp(param->unit, "1") == 0 || param->unit[0] == '\0';
        if (strcmp(param->name, "dt") == 0 || !json_is_number(value) ||
            json_number_value(value) == param->value) {
            continue;
        }
        snprintf(part, sizeof part, " %s=%.6g%s%s", param->name, json_number_value(value),
                 bare ? "" : " ", bare ? "" : param->unit);
        append(problem->name, sizeof problem->name, part);
    }
    const json_t *seed = json_object_get(problem->row, "seed");
    const json_t *member = json_object_get(problem->row, "member");
    if (json_integer_value(seed) != 0) {
        snprintf(part, sizeof part, " seed=%" JSON_INTEGER_FORMAT, json_integer_value(seed));
        append(problem->name, sizeof problem->name, part);
    }
    if (json_is_integer(member)) {
        snprintf(part, sizeof part, " member=%" JSON_INTEGER_FORMAT, json_integer_value(member));
        append(problem->name, sizeof problem->name, part);
    }
}

pl_sweep_problem pl_sweep_problem_of(const json_t *row, int first)
{
    pl_sweep_problem problem = {.row = row,
                                .scenario = pl_json_get_text(row, "scenario"),
                                .primary_error = pl_json_get_text(row, "primary_error"),
                                .unit = "",
                                .first = first};
    problem.catalogue = pl_scenario_find(problem.scenario, NULL);
    name_problem(&problem);
    return problem;
}

void pl_sweep_take_unit(pl_sweep_problem *problem, const json_t *row)
{
    const json_t *metric = json_object_get(json_object_get(row, "metrics"), problem->primary_error);
    if (problem->unit[0] == '\0') {
        problem->unit = pl_json_get_text(metric, "unit");
    }
}
