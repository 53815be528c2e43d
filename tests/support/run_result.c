#include "run_result.h"

#include "check.h"
#include "plumb_process.h"

#include <math.h>
#include <string.h>

json_t *run_to_json(const char *const *arguments)
{
    char *directory = make_directory();
    plumb_output output = run_plumb(directory, arguments);
    if (output.code != 0 && output.code != 3) {
        fail_msg("exit code %d: %s", output.code, output.err);
    }
    json_error_t error;
    json_t *result = json_loads(output.out, 0, &error);
    if (result == NULL) {
        fail_msg("%s in: %s", error.text, output.out);
    }
    assert_int_equal(output.code == 0, strcmp(result_text(result, "outcome"), "ok") == 0);
    free_output(&output);
    remove_directory(directory);
    return result;
}

double metric_percentile(const json_t *result, const char *name, const char *percentile)
{
    const json_t *m = json_object_get(json_object_get(result, "metrics"), name);
    const json_t *value = json_object_get(m, percentile);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

double metric(const json_t *result, const char *name)
{
    return metric_percentile(result, name, "value");
}
