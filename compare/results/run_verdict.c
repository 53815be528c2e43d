/* The verdict on a run, from the keys of its result. */
#include "run_verdict.h"

#include <math.h>
#include <stdio.h>
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

/* Of a run that ended ok, in a scene that states an acceptance. */
static pl_verdict judge_error(const json_t *result, double acceptance, char *reason, size_t size)
{
    const char *name = pl_json_get_text(result, "primary_error");
    const char *note = pl_json_get_text(result, "note");
    const double error = pl_result_metric(result, "reference_error");
    const json_t *metric = json_object_get(json_object_get(result, "metrics"), "reference_error");
    const char *unit = pl_json_get_text(metric, "unit"), *part = pl_json_get_text(metric, "part");
    if (isnan(error)) {
        snprintf(reason, size, "%s has no value: %s", name, why_absent(result, "reference_error"));
        return PL_VERDICT_UNJUDGED;
    }
    if (error <= acceptance) {
        return PL_VERDICT_ACCURATE;
    }
    unit = strcmp(unit, "1") == 0 ? "" : unit;
    part = part[0] != '\0' ? part : name;
    snprintf(reason, size, "%s%s%s %.3g%s%s, beyond %.3g%s%s", note, note[0] != '\0' ? "; " : "",
             part, error, unit[0] != '\0' ? " " : "", unit, acceptance, unit[0] != '\0' ? " " : "",
             unit);
    return PL_VERDICT_INACCURATE;
}

static pl_verdict judge(const json_t *result, char *reason, size_t size)
{
    const char *outcome = pl_json_get_text(result, "outcome");
    const json_t *acceptance = json_object_get(result, "acceptance");
    const double unexplained = pl_result_metric(result, "unexplained_motion");
    if (strcmp(outcome, pl_outcome_name(PL_OUTCOME_UNSUPPORTED)) == 0) {
        snprintf(reason, size, "unsupported");
        return PL_VERDICT_UNJUDGED;
    }
    if (strcmp(outcome, pl_outcome_name(PL_OUTCOME_OK)) != 0) {
        snprintf(reason, size, "%s: %s", outcome, pl_json_get_text(result, "reason"));
        return PL_VERDICT_FAILED;
    }
    if (unexplained > MOST_UNEXPLAINED) {
        snprintf(reason, size,
                 "a body moved in one step by %.3g of its radius more than its speed, gravity and "
                 "contacts explain",
                 unexplained);
        return PL_VERDICT_FAILED;
    }
    if (!json_is_number(acceptance)) {
        snprintf(reason, size, "the scene states no acceptance");
        return PL_VERDICT_UNJUDGED;
    }
    return judge_error(result, json_number_value(acceptance), reason, size);
}

/* Sets `verdict` and `verdict_reason`. */
static bool add_verdict(json_t *result)
{
    char reason[1024] = "";
    const pl_verdict verdict = judge(result, reason, sizeof reason);
    json_t *name = verdict == PL_VERDICT_UNJUDGED ? json_null() : json_string(names[verdict]);
    json_t *text = reason[0] == '\0' ? json_null() : pl_json_text(reason, strlen(reason));
    const int failed = json_object_set_new(result, "verdict", name) |
                       json_object_set_new(result, "verdict_reason", text);
    return failed == 0;
}

json_t *pl_result_compose(json_t *identity, json_t *outcome, json_t *provenance, const char *output,
                          size_t output_length, const char *started)
{
    json_t *result = json_pack(
        "{s:s, s:o, s:s}", "schema", "plumb.result/1", "output",
        output_length == 0 ? json_null() : pl_json_text(output, output_length), "started", started);
    if (result == NULL || json_object_update(result, identity) != 0 ||
        json_object_update(result, outcome) != 0 || json_object_update(result, provenance) != 0 ||
        !add_verdict(result)) {
        json_decref(result);
        return NULL;
    }
    return result;
}
