/* The verdict on a run, from the keys of its result. */
#include "result.h"

#include "base/heap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The largest unexplained motion of a run that has not failed, as a part of the body's radius. What
 * explains a motion is bounded from above, so there is no rounding to allow for; a part that would
 * not be seen is no failure. */
static const double MOST_UNEXPLAINED = 0.1;

static const char *const names[PL_VERDICT_COUNT] = {"accurate", "inaccurate", "failed",
                                                    "not judged"};

const char *pl_verdict_name(pl_verdict verdict)
{
    return names[verdict];
}

pl_verdict pl_verdict_of(const json_t *result)
{
    const char *text = pl_json_get_text(result, "verdict");
    const char *outcome = pl_json_get_text(result, "outcome");
    const bool is_made_without = json_object_get(result, "verdict") == NULL;
    int verdict = 0;
    if (is_made_without && outcome[0] != '\0' &&
        strcmp(outcome, pl_outcome_name(PL_OUTCOME_OK)) != 0 &&
        strcmp(outcome, pl_outcome_name(PL_OUTCOME_UNSUPPORTED)) != 0) {
        return PL_VERDICT_FAILED;
    }
    while (verdict < PL_VERDICT_UNJUDGED && strcmp(text, names[verdict]) != 0) {
        ++verdict;
    }
    return (pl_verdict)verdict;
}

/* The reason of a metric without a value; "" where it has one. */
static const char *why_absent(const json_t *result, const char *name)
{
    const json_t *metric = json_object_get(json_object_get(result, "metrics"), name);
    return metric == NULL ? "it does not apply" : pl_json_get_text(metric, "reason");
}

/* Whether the metric copies an error against what the scene expects. Such an error is judged expectation
 * by expectation, each by its own tolerance. */
static bool is_of_expectations(const char *metric)
{
    static const char *const errors[] = {"rest_position_error", "rest_rotation_error",
                                         "travel_error", "value_error", "statistics_error"};
    bool found = false;
    for (size_t i = 0; i < sizeof errors / sizeof *errors; ++i) {
        found = found || strcmp(metric, errors[i]) == 0;
    }
    return found;
}

static const char *separator(const pl_text_buffer *reason)
{
    return reason->length == 0 ? "" : "; ";
}

/* Names the expectations that the run is off, worst first, up to `most`. False: there are none. */
static bool name_deviations(const json_t *result, size_t most, pl_text_buffer *reason)
{
    const json_t *list = json_object_get(result, "off");
    const json_int_t count = json_integer_value(json_object_get(result, "off_count"));
    const size_t length = json_array_size(list);
    const json_int_t named = (json_int_t)(length < most ? length : most);
    for (size_t i = 0; i < (size_t)named; ++i) {
        pl_text_format(reason, "%s%s", separator(reason),
                       pl_json_get_text(json_array_get(list, i), "what"));
    }
    if (count > named) {
        pl_text_format(reason, "; and %lld more", (long long)(count - named));
    }
    return count > 0;
}

/* Writes the two numbers with as many digits, three or more, as they need to differ. */
static void add_bound(const char *what, double error, double bound, const char *unit,
                      pl_text_buffer *reason)
{
    char found[32], least[32];
    int digits = 3;
    do {
        snprintf(found, sizeof found, "%.*g", digits, error);
        snprintf(least, sizeof least, "%.*g", digits, bound);
    } while (strcmp(found, least) == 0 && digits++ < 17);
    unit = strcmp(unit, "1") == 0 ? "" : unit;
    const char *space = unit[0] != '\0' ? " " : "";
    pl_text_format(reason, "%s%s %s%s%s, beyond %s%s%s", separator(reason), what, found, space,
                   unit, least, space, unit);
}

/* Judges the primary error by the scene's acceptance. */
static pl_verdict judge_primary(const json_t *result, pl_text_buffer *reason)
{
    const json_t *acceptance = json_object_get(result, "acceptance");
    const char *name = pl_json_get_text(result, "primary_error");
    const double error = pl_result_metric(result, "reference_error");
    const json_t *metric = json_object_get(json_object_get(result, "metrics"), "reference_error");
    const char *part = pl_json_get_text(metric, "part");
    if (!json_is_number(acceptance)) {
        pl_text_format(reason, "the scene states no acceptance");
        return PL_VERDICT_UNJUDGED;
    }
    if (name[0] == '\0') {
        pl_text_format(reason, "the scene expects nothing");
        return PL_VERDICT_UNJUDGED;
    }
    if (isnan(error)) {
        pl_text_format(reason, "%s has no value: %s", name, why_absent(result, "reference_error"));
        return PL_VERDICT_UNJUDGED;
    }
    if (error <= json_number_value(acceptance)) {
        return PL_VERDICT_ACCURATE;
    }
    add_bound(part[0] != '\0' ? part : name, error, json_number_value(acceptance),
              pl_json_get_text(metric, "unit"), reason);
    return PL_VERDICT_INACCURATE;
}

/* Judges everything that the scene states, of a run that ended ok. */
static pl_verdict judge_errors(const json_t *result, pl_text_buffer *reason)
{
    const bool has_expectations = !isnan(pl_result_metric(result, "expectation_error"));
    const bool is_bounded = json_is_number(json_object_get(result, "acceptance"));
    pl_text_buffer of_primary = {0}, of_expectations = {0};
    pl_verdict verdict = judge_primary(result, &of_primary);
    if (has_expectations &&
        (!is_bounded || (verdict == PL_VERDICT_INACCURATE &&
                         is_of_expectations(pl_json_get_text(result, "primary_error"))))) {
        verdict = PL_VERDICT_ACCURATE; /* unless an expectation is off */
        pl_text_free(&of_primary);
    }
    /* A note describes how the worst of many bodies has moved. */
    const char *note = pl_json_get_text(result, "note");
    const size_t most = note[0] != '\0' ? 1 : PL_MOST_DEVIATIONS;
    if (name_deviations(result, most, &of_expectations)) {
        verdict = PL_VERDICT_INACCURATE;
    }
    char *parts[] = {pl_heap_copy(verdict == PL_VERDICT_INACCURATE ? note : ""),
                     pl_text_take(&of_expectations), pl_text_take(&of_primary)};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i) {
        pl_text_format(reason, "%s%s", parts[i][0] != '\0' ? separator(reason) : "", parts[i]);
        free(parts[i]);
    }
    return verdict;
}

static pl_verdict judge(const json_t *result, pl_text_buffer *reason)
{
    const char *outcome = pl_json_get_text(result, "outcome");
    const double unexplained = pl_result_metric(result, "unexplained_motion");
    if (strcmp(outcome, pl_outcome_name(PL_OUTCOME_UNSUPPORTED)) == 0) {
        pl_text_format(reason, "unsupported");
        return PL_VERDICT_UNJUDGED;
    }
    if (strcmp(outcome, pl_outcome_name(PL_OUTCOME_OK)) != 0) {
        pl_text_format(reason, "%s: %s", outcome, pl_json_get_text(result, "reason"));
        return PL_VERDICT_FAILED;
    }
    if (unexplained > MOST_UNEXPLAINED) {
        pl_text_format(
            reason,
            "a body moved in one step by %.3g of its radius more than its speed, gravity and "
            "contacts explain",
            unexplained);
        return PL_VERDICT_FAILED;
    }
    return judge_errors(result, reason);
}

/* Sets `verdict` and `verdict_reason`. */
static void add_verdict(json_t *result)
{
    pl_text_buffer reason = {0};
    const pl_verdict verdict = judge(result, &reason);
    json_t *name = verdict == PL_VERDICT_UNJUDGED ? json_null() : json_string(names[verdict]);
    char *text = pl_text_take(&reason);
    json_object_set_new(result, "verdict", name);
    json_object_set_new(result, "verdict_reason",
                        text[0] == '\0' ? json_null() : pl_json_text(text));
    free(text);
}

json_t *pl_result_compose(json_t *identity, json_t *outcome, json_t *provenance, const char *output,
                          size_t output_length, const char *started)
{
    json_t *result =
        json_pack("{s:s, s:o, s:s}", "schema", "plumb.result/1", "output",
                  output_length == 0 ? json_null() : pl_json_bytes(output, output_length),
                  "started", started);
    json_object_update(result, identity);
    json_object_update(result, outcome);
    json_object_update(result, provenance);
    add_verdict(result);
    return result;
}

json_t *pl_result_unmade(json_t *identity, pl_outcome outcome, long steps_asked, const char *reason,
                         json_t *provenance)
{
    char now[32];
    pl_run_result unmade = {.outcome = outcome, .steps_asked = steps_asked};
    snprintf(unmade.reason, sizeof unmade.reason, "%s", reason);
    pl_timestamp(now);
    json_t *object = pl_run_result_to_json(&unmade);
    json_t *result = pl_result_compose(identity, object, provenance, "", 0, now);
    json_decref(object);
    return result;
}
