#include "check_record.h"

#include "results/result.h"

#include <math.h>
#include <string.h>

/* The numbers of a record: of the early difference, of that at the end, and passes_at. */
enum { NUMBERS = 5 };

json_t *pl_check_record_make(const pl_check_result *result)
{
    const pl_agreement *a = &result->agreement;
    const double numbers[NUMBERS] = {a->early.position, a->early.rotation, a->end.position,
                                     a->end.rotation, a->passes_at};
    json_t *list = json_array();
    for (int i = 0; i < NUMBERS; ++i) {
        json_array_append_new(list, pl_json_number_or_null(numbers[i]));
    }
    return json_pack("{s:i, s:i, s:b, s:b, s:o, s:o}", "early", (int)result->early, "end",
                     (int)result->end, "early_same", (int)a->early.same, "end_same",
                     (int)a->end.same, "reason",
                     pl_json_text(result->reason, strlen(result->reason)), "numbers", list);
}

static bool read_grade(const json_t *record, const char *key, pl_grade *grade)
{
    const json_t *value = json_object_get(record, key);
    const json_int_t number = json_integer_value(value);
    *grade = (pl_grade)number;
    return json_is_integer(value) && number >= PL_GRADE_BITWISE && number <= PL_GRADE_INAPPLICABLE;
}

bool pl_check_record_read(const json_t *record, pl_check_result *result)
{
    pl_check_result read = {.check = result->check};
    pl_agreement *a = &read.agreement;
    double *const numbers[NUMBERS] = {&a->early.position, &a->early.rotation, &a->end.position,
                                      &a->end.rotation, &a->passes_at};
    const json_t *list = json_object_get(record, "numbers");
    if (!read_grade(record, "early", &read.early) || !read_grade(record, "end", &read.end) ||
        json_array_size(list) != NUMBERS) {
        return false;
    }
    for (size_t i = 0; i < NUMBERS; ++i) {
        const json_t *value = json_array_get(list, i);
        *numbers[i] = json_is_number(value) ? json_number_value(value) : (double)NAN;
    }
    a->early.same = json_is_true(json_object_get(record, "early_same"));
    a->end.same = json_is_true(json_object_get(record, "end_same"));
    snprintf(read.reason, sizeof read.reason, "%s", pl_json_get_text(record, "reason"));
    *result = read;
    return true;
}
