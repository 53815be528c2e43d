/* Makes the plain and the transformed runs and grades their agreement; text and JSON output. */
#include "metamorphic.h"

#include "base/folding.h"
#include "base/table.h"
#include "check_record.h"
#include "divide.h"
#include "late_start.h"
#include "runner/execute.h"
#include "runner/progress.h"
#include "transform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct study {
    const pl_metamorphic_def *def;
    pl_progress progress;
    int signal; /* that ended a run; 0: none */
} study;

enum { CHECK_KEY_SIZE = 128 };

/* A run of another scene in place of the planned run's. */
typedef struct run {
    const pl_planned_run *planned;
    const pl_scene *scene;
    const char *check; /* "plain" or a check's name */
    char *path;        /* of the frames, which the journal needs; NULL: none */
    pl_trajectory trajectory;
    json_t *result; /* NULL: interrupted */
} run;

static pl_status make_run(study *t, run *r, pl_error *error)
{
    pl_case test_case = *r->planned->test_case;
    const double started = pl_monotonic_seconds();
    test_case.scene = *r->scene;
    pl_status status = pl_scene_hash(r->scene, test_case.scene_hash, error);
    if (status == PL_OK) {
        status = pl_trajectory_open(&r->trajectory, r->path, error);
    }
    if (status != PL_OK) {
        return status;
    }
    const pl_execution_def execution = {.plan = t->def->plan,
                                        .limits = t->def->limits,
                                        .trajectory = r->trajectory.file,
                                        .provenance = t->def->provenance};
    if (t->def->progress != NULL) {
        pl_progress_draw(&t->progress, r->check, 0, started);
    }
    status = pl_execute_one(&execution, &test_case, r->planned->configuration, &r->result,
                            &t->signal, error);
    if (status == PL_OK && (fflush(r->trajectory.file) != 0 || ferror(r->trajectory.file) != 0)) {
        return pl_fail(error, PL_IO, "the frames of %s, %s, cannot be written",
                       r->planned->test_case->name, r->check);
    }
    if (status == PL_OK && t->signal == 0 && t->def->progress != NULL) {
        char title[256];
        snprintf(title, sizeof title, "%s, %s", r->planned->test_case->name, r->check);
        pl_progress_run_ended(&t->progress, title, r->result, pl_monotonic_seconds() - started);
    }
    return status;
}

/* The plain run that the journal has, with its frames where they are needed; else a new one. */
static pl_status make_plain(study *t, run *plain, bool needs_frames, pl_error *error)
{
    char key[17];
    pl_status status = pl_planned_run_hash(t->def->plan, plain->planned, key, error);
    if (status != PL_OK || t->def->journal == NULL) {
        return status == PL_OK ? make_run(t, plain, error) : status;
    }
    if (asprintf(&plain->path, "%s-%s.frames", pl_journal_path(t->def->journal), key) < 0) {
        plain->path = NULL;
        return pl_fail(error, PL_NO_MEMORY, "out of memory for a run");
    }
    plain->result = pl_journal_take(t->def->journal, key);
    if (plain->result != NULL && needs_frames) {
        plain->trajectory.file = fopen(plain->path, "re");
    }
    if (plain->result != NULL && (plain->trajectory.file != NULL || !needs_frames)) {
        return PL_OK;
    }
    json_decref(plain->result);
    plain->result = NULL;
    status = make_run(t, plain, error);
    if (status == PL_OK && t->signal == 0) {
        status = pl_journal_add(t->def->journal, key, plain->result, error);
    }
    return status;
}

static void free_run(run *r)
{
    free(r->path);
    pl_trajectory_close(&r->trajectory);
    json_decref(r->result);
}

/* Whether the run finished, as expected or collapsed. */
static bool finished(const run *r)
{
    const char *outcome = pl_json_get_text(r->result, "outcome");
    return strcmp(outcome, "ok") == 0 || strcmp(outcome, "collapsed") == 0;
}

static void set_grade(pl_check_result *result, pl_grade grade, const char *what, const char *reason)
{
    result->early = grade;
    result->end = grade;
    snprintf(result->reason, sizeof result->reason, "%s%s", what, reason);
}

static void set_failed(pl_check_result *result, const char *which, const run *r)
{
    char what[96];
    snprintf(what, sizeof what, "%s run %s: ", which, pl_json_get_text(r->result, "outcome"));
    set_grade(result, PL_GRADE_FAILED, what, pl_json_get_text(r->result, "reason"));
}

/* Makes the check's scene, which begins at the plain run's frame `first`. */
static pl_status make_scene(const pl_check *check, const pl_transform *transform, run *plain,
                            long first, pl_scene *scene, pl_error *error)
{
    switch (check->kind) {
    case PL_CHECK_RESTART:
        break;
    case PL_CHECK_SPLIT:
        return pl_split_boxes(plain->scene, check->axis, scene, error);
    case PL_CHECK_TESSELLATE:
        return pl_tessellate_boxes(plain->scene, (int)check->amount, scene, error);
    case PL_CHECK_LATE:
        return pl_late_start_scene(plain->scene, check->amount, scene, error);
    default:
        return pl_transform_scene(transform, plain->scene, scene, error);
    }
    pl_status status = pl_trajectory_rewind(&plain->trajectory, plain->scene->body_count, error);
    if (status != PL_OK) {
        return status;
    }
    for (long i = 0; i <= first; ++i) {
        if (!pl_trajectory_next(&plain->trajectory)) {
            return pl_fail(error, PL_IO, "the plain run's frames could not be read back");
        }
    }
    return pl_restart_scene(plain->scene, plain->trajectory.frame.bodies, first, scene, error);
}

static pl_status compare(const pl_transform *transform, run *plain, run *other, long first,
                         pl_check_result *result, pl_error *error)
{
    pl_error fault = {.message = ""};
    const pl_trajectory_pair comparison = {
        .scene = plain->scene,
        .transform = transform,
        .size = pl_scene_size(plain->scene),
        .plain = &plain->trajectory,
        .other = &other->trajectory,
        .other_body_count = other->scene->body_count,
        .first = first,
        .later = result->check->kind == PL_CHECK_LATE ? result->check->amount : 0};
    pl_status status = pl_compare_trajectories(&comparison, &result->agreement, &fault);
    if (status == PL_FAILED) {
        set_grade(result, PL_GRADE_FAILED, "too few frames: ", fault.message);
        return PL_OK;
    }
    result->early = pl_difference_grade(&result->agreement.early);
    result->end = pl_difference_grade(&result->agreement.end);
    return status == PL_OK ? PL_OK : pl_fail(error, status, "%s", fault.message);
}

static pl_status make_check(study *t, run *plain, pl_check_result *result, pl_error *error)
{
    const pl_check *check = result->check;
    pl_transform transform;
    pl_scene scene = pl_scene_default();
    const char *reason = NULL;
    const bool restart = check->kind == PL_CHECK_RESTART;
    const long first = restart ? pl_scene_steps(plain->scene) / 2 : 0;
    run other = {.planned = plain->planned, .scene = &scene, .check = check->name};
    if (!pl_check_transform(check, plain->scene, &transform, &reason)) {
        set_grade(result, PL_GRADE_INAPPLICABLE, "", reason);
        return PL_OK;
    }
    if (!finished(plain)) {
        set_failed(result, "plain", plain);
        return PL_OK;
    }
    pl_status status = make_scene(check, &transform, plain, first, &scene, error);
    if (status == PL_OK) {
        status = make_run(t, &other, error);
    }
    if (status == PL_OK && t->signal == 0) {
        if (finished(&other)) {
            status = compare(&transform, plain, &other, first, result, error);
        } else if (strcmp(pl_json_get_text(other.result, "outcome"), "unsupported") == 0) {
            set_grade(result, PL_GRADE_INAPPLICABLE,
                      "unsupported: ", pl_json_get_text(other.result, "reason"));
        } else {
            set_failed(result, "transformed", &other);
        }
    }
    free_run(&other);
    pl_scene_free(&scene);
    return status;
}

/* The journal's key of a check: that of the plain run, and its name. */
static pl_status check_key(const study *t, const pl_planned_run *planned, const pl_check *check,
                           char key[CHECK_KEY_SIZE], pl_error *error)
{
    char run_key[17];
    pl_status status = pl_planned_run_hash(t->def->plan, planned, run_key, error);
    snprintf(key, CHECK_KEY_SIZE, "%s %.80s", run_key, check->name);
    return status;
}

/* Takes the results of the chosen checks from the journal, as far as it has them; of the others only
 * the check is set, and *missing counts them. */
static pl_status recall_checks(const study *t, const pl_planned_run *planned,
                               pl_check_result *results, bool *known, int *missing, pl_error *error)
{
    int check_count, count = 0;
    const pl_check *checks = pl_checks(&check_count);
    pl_status status = PL_OK;
    *missing = 0;
    for (int i = 0; i < check_count && status == PL_OK; ++i) {
        char key[CHECK_KEY_SIZE];
        if (!t->def->chosen[i]) {
            continue;
        }
        results[count] = (pl_check_result){.check = &checks[i]};
        status = check_key(t, planned, &checks[i], key, error);
        json_t *record = status == PL_OK ? pl_journal_take(t->def->journal, key) : NULL;
        known[count] = record != NULL && pl_check_record_read(record, &results[count]);
        *missing += !known[count];
        json_decref(record);
        ++count;
    }
    return status;
}

/* Makes a check and adds it to the journal. */
static pl_status make_and_keep(study *t, run *plain, pl_check_result *result, pl_error *error)
{
    char key[CHECK_KEY_SIZE];
    pl_status status = make_check(t, plain, result, error);
    if (status != PL_OK || t->signal != 0) {
        return status;
    }
    status = check_key(t, plain->planned, result->check, key, error);
    json_t *record = pl_check_record_make(result);
    if (status == PL_OK) {
        status = record == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory for a check")
                                : pl_journal_add(t->def->journal, key, record, error);
    }
    json_decref(record);
    return status;
}

/* Runs all chosen checks of one scene on one engine. */
static pl_status check_run(study *t, const pl_planned_run *planned, pl_check_result *results,
                           bool *known, int count, pl_error *error)
{
    int missing = 0;
    run plain = {.planned = planned, .scene = &planned->test_case->scene, .check = "plain"};
    pl_status status = recall_checks(t, planned, results, known, &missing, error);
    if (status == PL_OK) {
        status = make_plain(t, &plain, missing > 0, error);
    }
    for (int i = 0; i < count && status == PL_OK && t->signal == 0; ++i) {
        if (!known[i]) {
            status = make_and_keep(t, &plain, &results[i], error);
        }
    }
    if (status == PL_OK && t->signal == 0) {
        const pl_checks_of_run checks_of_run = {.plan = t->def->plan,
                                                .run = *planned,
                                                .outcome =
                                                    pl_json_get_text(plain.result, "outcome"),
                                                .size = pl_scene_size(plain.scene),
                                                .results = results,
                                                .result_count = count};
        status = t->def->keep(t->def->user, &checks_of_run, error);
        if (plain.path != NULL) {
            unlink(plain.path);
        }
    }
    free_run(&plain);
    return status;
}

pl_status pl_run_checks(const pl_metamorphic_def *def, int *signal_number, pl_error *error)
{
    study t = {.def = def};
    pl_status status = PL_OK;
    int check_count, chosen = 0;
    (void)pl_checks(&check_count);
    for (int i = 0; i < check_count; ++i) {
        chosen += def->chosen[i];
    }
    pl_check_result *results = calloc((size_t)check_count, sizeof *results);
    bool *known = calloc((size_t)check_count, sizeof *known);
    if (results == NULL || known == NULL) {
        free(results);
        free(known);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the checks");
    }
    if (def->progress != NULL) {
        t.progress = pl_progress_begin(def->progress, (1 + chosen) * pl_plan_size(def->plan),
                                       pl_monotonic_seconds());
    }
    for (long i = 0; i < pl_plan_size(def->plan) && status == PL_OK && t.signal == 0; ++i) {
        const pl_planned_run planned = pl_plan_run(def->plan, i);
        status = check_run(&t, &planned, results, known, chosen, error);
    }
    if (def->progress != NULL) {
        pl_progress_end(&t.progress);
    }
    free(results);
    free(known);
    *signal_number = t.signal;
    return status;
}

static bool has_numbers(const pl_check_result *result)
{
    return result->end != PL_GRADE_FAILED && result->end != PL_GRADE_INAPPLICABLE;
}

static void add_difference(pl_table *table, const pl_difference *d, pl_grade grade)
{
    pl_table_format_cell(table, "%.1e", d->position);
    pl_table_format_cell(table, "%.1e", d->rotation);
    pl_table_add(table, pl_grade_name(grade));
}

static void add_result(pl_table *table, const pl_check_result *result)
{
    pl_table_add(table, result->check->name);
    if (!has_numbers(result)) {
        pl_text_buffer text = {0};
        pl_text_format(&text, "%s: %s", pl_grade_name(result->end), result->reason);
        pl_table_add_span(table, text.failed ? "" : text.data);
        table->texts.failed |= text.failed;
        pl_text_free(&text);
        return;
    }
    add_difference(table, &result->agreement.early, result->early);
    add_difference(table, &result->agreement.end, result->end);
    if (isnan(result->agreement.passes_at)) {
        pl_table_add(table, "never");
    } else {
        pl_table_format_cell(table, "%.3g s", result->agreement.passes_at);
    }
}

void pl_checks_print(FILE *out, const pl_checks_of_run *checks)
{
    const pl_scene *scene = &checks->run.test_case->scene;
    pl_folding folding;
    FILE *folded = pl_folding_begin(&folding, out);
    fprintf(folded, "%s on %s: %d bodies, size %.4g m, %ld steps\n", checks->run.test_case->name,
            checks->run.configuration->label, scene->body_count, checks->size,
            pl_scene_steps(scene));
    fprintf(folded, "Differences at a tenth of the run and at its end, and when 1e-6 of the size "
                    "was passed:\n");
    pl_folding_end(&folding);
    pl_table table = {.indent = 2};
    pl_table_columns(&table, "check|>m/size, at a tenth|>rad, at a tenth|verdict, at a tenth|"
                             ">m/size, at end|>rad, at end|verdict, at end|>passed at");
    for (int i = 0; i < checks->result_count; ++i) {
        add_result(&table, &checks->results[i]);
    }
    pl_table_print(&table, out);
    pl_table_free(&table);
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

json_t *pl_checks_to_json(const pl_checks_of_run *checks)
{
    json_t *object = pl_planned_run_identity(checks->plan, &checks->run);
    json_t *list = json_array();
    int failed = object == NULL || list == NULL;
    for (int i = 0; i < checks->result_count && !failed; ++i) {
        failed |= json_array_append_new(list, result_to_json(&checks->results[i])) != 0;
    }
    failed = failed || json_object_set_new(object, "schema", json_string("plumb.metamorphic/1"));
    failed = failed || json_object_set_new(object, "outcome", json_string(checks->outcome));
    failed = failed || json_object_set_new(object, "size", json_real(checks->size));
    failed = failed || json_object_set(object, "checks", list);
    json_decref(list);
    if (failed) {
        json_decref(object);
        return NULL;
    }
    return object;
}
