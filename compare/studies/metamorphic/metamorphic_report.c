/* What the results of metamorphic checks say: plumb.metamorphic/1, and the document. */
#include "base/heap.h"
#include "metamorphic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Concluding ---- */

/* A difference as the result has it, or one without numbers. */
static json_t *difference_of(const json_t *agreement, const char *key, const char *verdict)
{
    json_t *found = json_object_get(agreement, key);
    return found != NULL ? json_incref(found)
                         : json_pack("{s:n, s:n, s:s}", "position", "rotation", "verdict", verdict);
}

/* A check of a plain run, by its result. */
static json_t *conclude_check(const char *check, const json_t *result)
{
    const json_t *agreement = json_object_get(result, "agreement");
    const char *at_end = pl_study_text(agreement, "end.verdict");
    const bool is_inapplicable = strcmp(pl_json_get_text(result, "outcome"), "unsupported") == 0;
    const char *verdict = at_end[0] != '\0' ? at_end : is_inapplicable ? "inapplicable" : "failed";
    char *reason = NULL;
    if (is_inapplicable) {
        reason = pl_heap_copy(pl_json_get_text(result, "reason"));
    } else if (!pl_study_ended(result)) {
        reason = pl_heap_format("transformed run %s: %s", pl_json_get_text(result, "outcome"),
                                pl_json_get_text(result, "reason"));
    } else if (at_end[0] == '\0') {
        reason = pl_heap_format("too few frames: %s", pl_json_get_text(agreement, "reason"));
    }
    json_t *passes_at = json_object_get(agreement, "passes_at");
    json_t *found = json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "check", check, "verdict", verdict,
                              "reason", reason == NULL ? json_null() : pl_json_text(reason),
                              "passes_at", passes_at == NULL ? json_null() : json_incref(passes_at),
                              "early", difference_of(agreement, "early", verdict), "end",
                              difference_of(agreement, "end", verdict));
    free(reason);
    return found;
}

/* plumb.metamorphic/1 of a plain run; `results` has those of its checks by their names. */
static json_t *conclude_run(const json_t *plain, const json_t *results)
{
    static const char *const more[] = {"scene_hash", "run", "outcome", "reason", NULL};
    json_t *found = json_array();
    json_t *row = pl_study_row(plain, more);
    json_object_set_new(row, "schema", json_string("plumb.metamorphic/1"));
    json_object_set(row, "size", pl_study_get(plain, "agreement.size"));
    json_object_set_new(row, "checks", found);
    for (int i = 0; i < PL_CHECK_COUNT; ++i) {
        const json_t *result = json_object_get(results, pl_checks[i].name);
        if (result != NULL) {
            json_array_append_new(found, conclude_check(pl_checks[i].name, result));
        }
    }
    return row;
}

static void add_check(json_t *checks, const char *plain, const char *check, json_t *result)
{
    json_t *own = json_object_get(checks, plain);
    if (own == NULL) {
        own = json_object();
        json_object_set_new(checks, plain, own);
    }
    json_object_set(own, check, result);
}

static pl_status conclude(const json_t *results, const char *folder, json_t **conclusion,
                          pl_error *error)
{
    static const char *const same[] = {"scenario", "params", "engine", "engine_binary",
                                       "profile",  "label",  "seed",   NULL};
    (void)folder;
    json_t *plains = json_array(), *checks = json_object(), *result;
    pl_status status = PL_OK;
    size_t index;
    const char *key;
    json_array_foreach((json_t *)results, index, result)
    {
        const char *plain = pl_study_text(result, "study.plain");
        if (plain[0] != '\0') {
            add_check(checks, plain, pl_study_text(result, "study.check"), result);
        } else if (json_is_number(pl_study_get(result, "agreement.size"))) {
            json_array_append(plains, result);
        } else {
            status = pl_fail(error, PL_BAD_INPUT,
                             "results[%zu]: expected a metamorphic check, with study.plain or "
                             "agreement.size",
                             index);
            break;
        }
    }
    if (status == PL_OK) {
        json_t *groups = pl_study_groups(plains, same), *group;
        *conclusion = json_array();
        json_object_foreach(groups, key, group)
        {
            /* The last one counts: the others are of an older edition of the scene. */
            result = json_array_get(group, json_array_size(group) - 1);
            json_array_append_new(
                *conclusion,
                conclude_run(result, json_object_get(checks, pl_json_get_text(result, "run"))));
        }
        json_decref(groups);
    }
    json_decref(plains);
    json_decref(checks);
    return status;
}

/* ---- The document ---- */

static const json_t *check_of(const json_t *row, const char *name)
{
    size_t index;
    const json_t *check;
    json_array_foreach(json_object_get(row, "checks"), index, check)
    {
        if (strcmp(pl_json_get_text(check, "check"), name) == 0) {
            return check;
        }
    }
    return NULL;
}

static void add_verdict(pl_table *table, const char *verdict)
{
    static const char *const styles[][2] = {{"bitwise", "ok"},
                                            {"exact", "ok"},
                                            {"differs", "poor"},
                                            {"failed", "bad"},
                                            {"inapplicable", "none"}};
    pl_table_add(table, verdict);
    for (size_t i = 0; i < sizeof styles / sizeof styles[0]; ++i) {
        if (strcmp(verdict, styles[i][0]) == 0) {
            pl_table_style(table, styles[i][1]);
        }
    }
}

/* The verdict of each check on each engine. An engine whose plain run failed has failed them all. */
static void add_verdicts(pl_document *document, const json_t *rows)
{
    size_t index;
    const json_t *row;
    pl_table table = {0};
    pl_table_column(&table, PL_LEFT, "check");
    json_array_foreach((json_t *)rows, index, row)
    {
        pl_table_column(&table, PL_LEFT, "%s", pl_json_get_text(row, "label"));
    }
    for (int i = 0; i < PL_CHECK_COUNT; ++i) {
        bool is_made = false;
        json_array_foreach((json_t *)rows, index, row)
        {
            is_made = is_made || check_of(row, pl_checks[i].name) != NULL;
        }
        if (!is_made) {
            continue;
        }
        pl_table_add(&table, pl_checks[i].name);
        json_array_foreach((json_t *)rows, index, row)
        {
            const json_t *check = check_of(row, pl_checks[i].name);
            const bool has_failed =
                check == NULL && json_array_size(json_object_get(row, "checks")) == 0;
            add_verdict(&table, check != NULL ? pl_json_get_text(check, "verdict")
                                : has_failed  ? "failed"
                                              : "-");
        }
    }
    pl_document_table(document, "Verdicts at the end of the run", &table);
}

static void add_difference(pl_table *table, const json_t *difference)
{
    static const char *const keys[] = {"position", "rotation"};
    for (int i = 0; i < 2; ++i) {
        const double off = pl_study_number(difference, keys[i]);
        pl_table_format_cell(table, "%.1e", isnan(off) ? HUGE_VAL : off);
    }
    add_verdict(table, pl_json_get_text(difference, "verdict"));
}

static void add_check_row(pl_table *table, const char *label, const json_t *check)
{
    const char *reason = pl_json_get_text(check, "reason");
    const double passes_at = pl_study_number(check, "passes_at");
    pl_table_add(table, label);
    pl_table_add(table, pl_json_get_text(check, "check"));
    if (reason[0] != '\0') {
        pl_table_add_span(table, "%s: %s", pl_json_get_text(check, "verdict"), reason);
        return;
    }
    add_difference(table, json_object_get(check, "early"));
    add_difference(table, json_object_get(check, "end"));
    if (isnan(passes_at)) {
        pl_table_add(table, "never");
    } else {
        pl_table_format_cell(table, "%.3g s", passes_at);
    }
}

static void add_differences(pl_document *document, const json_t *rows)
{
    size_t index, k;
    const json_t *row, *check;
    pl_table table = {.keys = 2};
    pl_table_columns(&table,
                     "engine|check|>m/size, at a tenth|>rad, at a tenth|verdict, at a tenth|"
                     ">m/size, at end|>rad, at end|verdict, at end|>passed at");
    json_array_foreach((json_t *)rows, index, row)
    {
        const char *label = pl_json_get_text(row, "label");
        const char *outcome = pl_json_get_text(row, "outcome");
        json_array_foreach(json_object_get(row, "checks"), k, check)
        {
            add_check_row(&table, label, check);
        }
        if (k == 0 && strcmp(outcome, "ok") != 0) {
            pl_table_add(&table, label);
            pl_table_add(&table, "all");
            pl_table_add_span(&table, "failed: plain run %s: %s", outcome,
                              pl_json_get_text(row, "reason"));
        }
    }
    pl_document_table(document,
                      "Differences at a tenth of the run and at its end, and when 1e-6 of the "
                      "size was passed",
                      &table);
}

/* The rows of one scene. */
static void add_scene(pl_document *document, const json_t *rows)
{
    const json_t *first = json_array_get(rows, 0);
    char *params = pl_study_params(json_object_get(first, "params"));
    pl_document_heading(document, "%s", pl_json_get_text(first, "scenario"));
    pl_document_paragraph(document, "%s%sSize %.4g m, time step %.4g s, duration %.4g s.", params,
                          params[0] == '\0' ? "" : ". ", pl_study_number(first, "size"),
                          pl_study_number(first, "settings.dt"),
                          pl_study_number(first, "settings.duration"));
    if (json_array_size(rows) > 1) {
        add_verdicts(document, rows);
    }
    add_differences(document, rows);
    free(params);
}

static void fill_document(const json_t *conclusion, pl_document *document)
{
    static const char *const same[] = {"scenario", "params", "seed", NULL};
    document->title = "Metamorphic checks: scenes that must move in the same way";
    pl_study_add_groups(document, conclusion, same, add_scene);
}

const pl_study pl_metamorphic_study = {
    .name = "metamorphic", .kind = "metamorphic", .conclude = conclude, .document = fill_document};
