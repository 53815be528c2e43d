/* A run's result as JSON. */
#include "result.h"

#include "base/heap.h"
#include "base/parallel.h"
#include "base/program_name.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>

static const char *const outcome_names[PL_OUTCOME_COUNT] = {
    [PL_OUTCOME_OK] = "ok",
    [PL_OUTCOME_COLLAPSED] = "collapsed",
    [PL_OUTCOME_DIVERGED] = "diverged",
    [PL_OUTCOME_NONFINITE] = "nonfinite",
    [PL_OUTCOME_CRASHED] = "crashed",
    [PL_OUTCOME_TIMEOUT] = "timeout",
    [PL_OUTCOME_UNSUPPORTED] = "unsupported",
};

static const char *const read_back_names[PL_READ_BACK_COUNT] = {
    [PL_READ_BACK_STEP] = "dt",
    [PL_READ_BACK_GRAVITY] = "gravity",
    [PL_READ_BACK_MASS] = "mass",
    [PL_READ_BACK_INERTIA] = "inertia",
    [PL_READ_BACK_DAMPING] = "damping",
    [PL_READ_BACK_FRICTION] = "friction",
    [PL_READ_BACK_RESTITUTION] = "restitution"};

const char *pl_read_back_name(pl_read_back what)
{
    return read_back_names[what];
}

const char *pl_outcome_name(pl_outcome outcome)
{
    return outcome_names[outcome];
}

pl_outcome pl_outcome_named(const char *name)
{
    int outcome = 0;
    while (outcome < PL_OUTCOME_COUNT && strcmp(outcome_names[outcome], name) != 0) {
        ++outcome;
    }
    return (pl_outcome)outcome;
}

static json_t *text_or_null(const char *text)
{
    return text[0] == '\0' ? json_null() : pl_json_text(text);
}

const char *pl_result_runtime(const json_t *result)
{
    const char *runtime = pl_json_get_text(result, "engine_runtime");
    return runtime[0] == '\0' || strcmp(runtime, "native") == 0 ? NULL : runtime;
}

int pl_result_threads(const json_t *result)
{
    const json_int_t threads = json_integer_value(json_object_get(result, "threads"));
    return threads > 1 && threads < INT_MAX ? (int)threads : 1;
}

const char *pl_result_text(const json_t *result, const char *object, const char *key)
{
    return pl_json_get_text(json_object_get(result, object), key);
}

double pl_result_metric(const json_t *result, const char *name)
{
    const json_t *metric = json_object_get(json_object_get(result, "metrics"), name);
    const json_t *value = json_object_get(metric, "value");
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

json_t *pl_json_number_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

void pl_result_add_line(pl_text_buffer *text, const json_t *result)
{
    char *line = pl_result_to_line(result);
    pl_text_format(text, "%s\n", line);
    free(line);
}

char *pl_result_to_line(const json_t *result)
{
    return pl_heap_json(result, JSON_COMPACT);
}

void pl_timestamp(char text[32])
{
    struct timespec now;
    struct tm utc;
    char seconds[24];
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    strftime(seconds, sizeof seconds, "%Y-%m-%dT%H:%M:%S", &utc);
    int milliseconds = (int)(now.tv_nsec / 1000000) % 1000;
    snprintf(text, 32, "%s.%03dZ", seconds, milliseconds);
}

static json_t *metric_json(const pl_metric *metric, const pl_metric_info *info)
{
    static const char *const directions[] = {[PL_LOWER_IS_BETTER] = "lower",
                                             [PL_HIGHER_IS_BETTER] = "higher",
                                             [PL_NO_DIRECTION] = "none"};
    const char *unit = metric->unit != NULL ? metric->unit : info->unit;
    bool has_value = metric->state == PL_METRIC_VALUE && isfinite(metric->value);
    json_t *value = has_value                         ? json_real(metric->value)
                    : metric->state == PL_METRIC_TEXT ? pl_json_text(metric->text)
                                                      : json_null();
    json_t *object = json_pack("{s:o, s:s, s:s, s:b}", "value", value, "unit", unit, "direction",
                               directions[info->direction], "deterministic",
                               (info->traits & PL_TRAIT_MEASURED) == 0);
    if (!has_value && metric->state != PL_METRIC_TEXT) {
        const char *reason = metric->reason[0] != '\0' ? metric->reason : "the value is not finite";
        json_object_set_new(object, "reason", pl_json_text(reason));
    }
    if (has_value && metric->has_percentiles) {
        json_object_set_new(object, "p50", pl_json_number_or_null(metric->p50));
        json_object_set_new(object, "p95", pl_json_number_or_null(metric->p95));
        json_object_set_new(object, "p99", pl_json_number_or_null(metric->p99));
        json_object_set_new(object, "worst_step", json_integer(metric->worst_step));
    }
    if (has_value && metric->part != NULL) {
        json_object_set_new(object, "part", json_string(metric->part));
    }
    if (has_value && metric->answer > 0) {
        json_object_set_new(object, "answer", json_integer(metric->answer));
    }
    return object;
}

static json_t *metrics_json(const pl_metrics *metrics)
{
    json_t *object = json_object();
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        const pl_metric *metric = &metrics->item[id];
        const pl_metric_info *info = &pl_metric_table[id];
        if (metric->state != PL_METRIC_ABSENT) {
            json_object_set_new(object, info->name, metric_json(metric, info));
        }
    }
    return object;
}

static json_t *read_back_json(unsigned read_back)
{
    json_t *list = json_array();
    for (int i = 0; i < PL_READ_BACK_COUNT; ++i) {
        if ((read_back >> i & 1u) != 0) {
            json_array_append_new(list, json_string(read_back_names[i]));
        }
    }
    return list;
}

/* The deviations that are named, worst first. */
static json_t *off_json(const pl_deviations *deviations)
{
    json_t *list = json_array();
    for (int i = 0; i < deviations->off && i < PL_MOST_DEVIATIONS; ++i) {
        const char *text = deviations->text[i];
        json_array_append_new(list, json_pack("{s:o, s:o}", "what", pl_json_text(text), "ratio",
                                              pl_json_number_or_null(deviations->ratio[i])));
    }
    return list;
}

json_t *pl_run_result_to_json(const pl_run_result *result)
{
    return json_pack(
        "{s:s, s:o, s:o, s:{s:I, s:I}, s:o, s:o, s:i, s:o, s:o, s:o}", "outcome",
        pl_outcome_name(result->outcome), "reason", text_or_null(result->reason), "note",
        text_or_null(result->note.text), "steps", "asked", (json_int_t)result->steps_asked, "done",
        (json_int_t)result->steps_done, "substeps",
        result->substeps > 0 ? json_integer(result->substeps) : json_null(), "read_back",
        read_back_json(result->read_back), "off_count", result->metrics.deviations.off, "off",
        off_json(&result->metrics.deviations), "metrics", metrics_json(&result->metrics),
        "final_poses", result->bodies != NULL ? json_integer(result->body_count) : json_null());
}

json_t *pl_results_of_study(const json_t *results, const char *name)
{
    json_t *selected = json_array(), *result;
    size_t index;
    json_array_foreach((json_t *)results, index, result)
    {
        const json_t *study = json_object_get(result, "study");
        if (name == NULL ? study == NULL : strcmp(pl_json_get_text(study, "name"), name) == 0) {
            json_array_append(selected, result);
        }
    }
    return selected;
}

bool pl_results_all_unsupported(const json_t *results)
{
    size_t index;
    const json_t *result;
    json_array_foreach(results, index, result)
    {
        if (strcmp(pl_json_get_text(result, "outcome"), "unsupported") != 0) {
            return false;
        }
    }
    return json_array_size(results) > 0;
}

/* ---- Provenance ---- */

static json_t *host_json(void)
{
    char cpu[256];
    char os[256];
    char kernel_and_os[768];
    struct utsname kernel;
    if (uname(&kernel) != 0) {
        kernel = (struct utsname){.sysname = "unknown", .release = "", .machine = "unknown"};
    }
    pl_file_field("/proc/cpuinfo", "model name", cpu, sizeof cpu);
    pl_file_field("/etc/os-release", "PRETTY_NAME", os, sizeof os);
    snprintf(kernel_and_os, sizeof kernel_and_os, "%s%s%s %s", os, os[0] == '\0' ? "" : ", ",
             kernel.sysname, kernel.release);
    const char *processor = cpu[0] != '\0' ? cpu : kernel.machine;
    return json_pack("{s:o, s:i, s:o, s:s, s:s}", "cpu", pl_json_text(processor), "cpus",
                     pl_usable_cpus(), "os", pl_json_text(kernel_and_os), "compiler",
                     PLUMB_COMPILER, "flags", PLUMB_FLAGS);
}

json_t *pl_provenance(int argc, char *const *argv)
{
    json_t *command = json_array();
    for (int i = 0; i < argc; ++i) {
        json_array_append_new(command, pl_json_text(argv[i]));
    }
    return json_pack("{s:o, s:{s:s, s:s}, s:o}", "host", host_json(), PL_PROGRAM, "version",
                     PLUMB_VERSION, "git", PLUMB_GIT, "command", command);
}

bool pl_metric_is_deterministic(const json_t *metric, int id)
{
    const json_t *given = json_object_get(metric, "deterministic");
    return json_is_boolean(given) ? json_is_true(given) : !pl_metric_is(id, PL_TRAIT_MEASURED);
}

const char *pl_metric_table_unit(int id)
{
    const bool is_plain =
        id < 0 || pl_metric_is(id, PL_TRAIT_OWN_UNIT) || strcmp(pl_metric_table[id].unit, "1") == 0;
    return is_plain ? "" : pl_metric_table[id].unit;
}
