#include "trial_report.h"

#include <math.h>
#include <string.h>

static bool has_numbers(const pl_check_result *result)
{
    return result->end != PL_GRADE_FAILED && result->end != PL_GRADE_INAPPLICABLE;
}

static void print_difference(FILE *out, const pl_difference *d, pl_grade grade)
{
    fprintf(out, "  %8.1e  %8.1e  %-8s", d->position, d->rotation, pl_grade_name(grade));
}

static void print_result(FILE *out, const pl_check_result *result)
{
    fprintf(out, "  %-14s", result->check->name);
    if (!has_numbers(result)) {
        fprintf(out, "  %s: %s\n", pl_grade_name(result->end), result->reason);
        return;
    }
    print_difference(out, &result->agreement.early, result->early);
    print_difference(out, &result->agreement.end, result->end);
    if (isnan(result->agreement.passes_at)) {
        fprintf(out, "  %9s\n", "never");
    } else {
        fprintf(out, "  %7.3g s\n", result->agreement.passes_at);
    }
}

void pl_checks_print(FILE *out, const pl_checks_of_run *trial)
{
    const pl_scene *scene = &trial->run.test_case->scene;
    fprintf(out, "%s on %s: %d bodies, size %.4g m, %ld steps\n", trial->run.test_case->name,
            trial->run.configuration->label, scene->body_count, trial->size, pl_scene_steps(scene));
    fprintf(out, "  %-14s  %-28s  %-28s  %9s\n", "", "at a tenth of the run", "at its end",
            "1e-6 size");
    fprintf(out, "  %-14s  %8s  %8s  %-8s  %8s  %8s  %-8s  %9s\n", "check", "m/size", "rad",
            "verdict", "m/size", "rad", "verdict", "passed at");
    for (int i = 0; i < trial->result_count; ++i) {
        print_result(out, &trial->results[i]);
    }
    fputc('\n', out);
}

static json_t *difference_to_json(const pl_difference *d, pl_grade grade, bool has)
{
    return json_pack("{s:o, s:o, s:s}", "position",
                     pl_json_number_or_null(has ? d->position : (double)NAN), "rotation",
                     pl_json_number_or_null(has ? d->rotation : (double)NAN), "verdict",
                     pl_grade_name(grade));
}

static json_t *result_to_json(const pl_check_result *result)
{
    const pl_agreement *a = &result->agreement;
    bool has = has_numbers(result);
    return json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "check", result->check->name, "verdict",
                     pl_grade_name(result->end), "reason",
                     result->reason[0] == '\0'
                         ? json_null()
                         : pl_json_text(result->reason, strlen(result->reason)),
                     "passes_at", pl_json_number_or_null(has ? a->passes_at : (double)NAN), "early",
                     difference_to_json(&a->early, result->early, has), "end",
                     difference_to_json(&a->end, result->end, has));
}

json_t *pl_checks_to_json(const pl_checks_of_run *trial)
{
    json_t *object = pl_planned_run_identity(trial->plan, &trial->run);
    json_t *checks = json_array();
    int failed = object == NULL || checks == NULL;
    for (int i = 0; i < trial->result_count && !failed; ++i) {
        failed |= json_array_append_new(checks, result_to_json(&trial->results[i])) != 0;
    }
    failed = failed || json_object_set_new(object, "schema", json_string("plumb.metamorphic/1"));
    failed = failed || json_object_set_new(object, "outcome", json_string(trial->outcome));
    failed = failed || json_object_set_new(object, "size", json_real(trial->size));
    failed = failed || json_object_set(object, "checks", checks);
    json_decref(checks);
    if (failed) {
        json_decref(object);
        return NULL;
    }
    return object;
}
