/* The report as CSV, read back. */
#include "report/report.h"

#include "check.h"
#include "report_rows.h"

#include <stdlib.h>
#include <string.h>

/* Reads one field of RFC 4180 at *at into `field`; returns the delimiter and moves behind it. */
static char read_field(const char **at, char *field, size_t size)
{
    size_t length = 0;
    const char *c = *at;
    bool quoted = *c == '"';
    for (c += quoted; *c != '\0'; ++c) {
        if (quoted && *c == '"') {
            if (c[1] != '"') {
                ++c;
                break;
            }
            ++c;
        } else if (!quoted && (*c == ',' || *c == '\r')) {
            break;
        }
        assert_true(length + 1 < size);
        field[length++] = *c;
    }
    field[length] = '\0';
    char delimiter = *c;
    assert_true(delimiter == ',' || (delimiter == '\r' && c[1] == '\n'));
    *at = c + (delimiter == ',' ? 1 : 2);
    return delimiter;
}

enum { CSV_COLUMNS = 37, CSV_FIELD = 512 };

/* Parses a line; returns how many fields it has. */
static int read_line(const char **at, char fields[CSV_COLUMNS][CSV_FIELD])
{
    int count = 0;
    char delimiter = ',';
    while (delimiter == ',') {
        assert_true(count < CSV_COLUMNS);
        delimiter = read_field(at, fields[count++], CSV_FIELD);
    }
    return count;
}

static const char *field_of(char head[CSV_COLUMNS][CSV_FIELD], char line[CSV_COLUMNS][CSV_FIELD],
                            const char *name)
{
    for (int i = 0; i < CSV_COLUMNS; ++i) {
        if (strcmp(head[i], name) == 0) {
            return line[i];
        }
    }
    fail_msg("no column %s", name);
    return NULL;
}

static void test_csv_parses_back_field_for_field(void **state)
{
    (void)state;
    static char head[CSV_COLUMNS][CSV_FIELD], line[CSV_COLUMNS][CSV_FIELD];
    json_t *results = json_array();
    json_t *row = add_run(results, hostile_text, "plumb:fast", "crashed");
    json_object_set_new(row, "reason", json_string(hostile_text));
    json_object_set_new(row, "acceptance", json_real(0.1));
    set_verdict(row, "failed", hostile_text);
    json_object_set_new(json_object_get(row, "params"), "n", json_integer(25));
    set_metric(row, "drift",
               json_pack("{s:f, s:s, s:s, s:b, s:f, s:i}", "value", 0.1, "unit", "m", "direction",
                         "lower", "deterministic", 1, "p95", 1.0 / 3, "worst_step", 7));
    set_metric(row, "settle_time", json_pack("{s:n, s:s}", "value", "reason", hostile_text));
    pl_text_buffer out = {0};
    pl_result_table *table = table_of(results);
    pl_report_csv(table, &out);
    const char *at = out.data;
    int columns = read_line(&at, head);
    assert_int_equal(read_line(&at, line), columns);
    assert_string_equal(field_of(head, line, "scenario"), hostile_text);
    assert_string_equal(field_of(head, line, "reason"), hostile_text);
    assert_string_equal(field_of(head, line, "params"), "{\"n\":25}");
    assert_string_equal(field_of(head, line, "label"), "plumb:fast");
    assert_string_equal(field_of(head, line, "host_cpu"), "one");
    assert_string_equal(field_of(head, line, "steps_asked"), "10");
    assert_string_equal(field_of(head, line, "metric"), "drift");
    assert_true(strtod(field_of(head, line, "value"), NULL) == 0.1);
    assert_true(strtod(field_of(head, line, "p95"), NULL) == 1.0 / 3);
    assert_string_equal(field_of(head, line, "p50"), "");
    assert_string_equal(field_of(head, line, "worst_step"), "7");
    assert_string_equal(field_of(head, line, "deterministic"), "true");
    assert_string_equal(field_of(head, line, "verdict"), "failed");
    assert_string_equal(field_of(head, line, "verdict_reason"), hostile_text);
    assert_true(strtod(field_of(head, line, "acceptance"), NULL) == 0.1);
    assert_int_equal(read_line(&at, line), columns);
    assert_string_equal(field_of(head, line, "metric"), "settle_time");
    assert_string_equal(field_of(head, line, "value"), "");
    assert_string_equal(field_of(head, line, "metric_reason"), hostile_text);
    assert_string_equal(at, "");
    pl_text_free(&out);
    free_table(table);
    json_decref(results);
}

static void test_columns_of_numbers_have_no_text(void **state)
{
    (void)state;
    static char head[CSV_COLUMNS][CSV_FIELD], line[CSV_COLUMNS][CSV_FIELD];
    json_t *results = json_array();
    json_t *row = add_run(results, "tower", "plumb:fast", "ok");
    set_metric(row, "drift", json_pack("{s:f}", "value", 0.0));
    set_metric(row, "integrator", json_pack("{s:s}", "value", "mixed"));
    pl_text_buffer out = {0};
    pl_result_table *table = table_of(results);
    pl_report_csv(table, &out);
    const char *at = out.data;
    int columns = read_line(&at, head);
    assert_int_equal(read_line(&at, line), columns);
    assert_string_equal(field_of(head, line, "metric"), "drift");
    assert_string_equal(field_of(head, line, "value"), "0.0");
    assert_string_equal(field_of(head, line, "value_text"), "");
    assert_int_equal(read_line(&at, line), columns);
    assert_string_equal(field_of(head, line, "metric"), "integrator");
    assert_string_equal(field_of(head, line, "value"), "");
    assert_string_equal(field_of(head, line, "value_text"), "mixed");
    pl_text_free(&out);
    free_table(table);
    json_decref(results);
}

static void test_csv_has_rows_for_metrics_and_empty_runs(void **state)
{
    (void)state;
    static char head[CSV_COLUMNS][CSV_FIELD], line[CSV_COLUMNS][CSV_FIELD];
    json_t *results = runs_of_every_kind();
    pl_text_buffer out = {0};
    pl_result_table *table = table_of(results);
    pl_report_csv(table, &out);
    size_t expected = 0;
    json_t *row;
    size_t index;
    json_array_foreach(results, index, row)
    {
        size_t metrics = json_object_size(json_object_get(row, "metrics"));
        expected += metrics > 0 ? metrics : 1;
    }
    const char *at = out.data;
    int columns = read_line(&at, head);
    size_t lines = 0;
    for (; *at != '\0'; ++lines) {
        assert_int_equal(read_line(&at, line), columns);
    }
    assert_int_equal(lines, expected);
    pl_text_free(&out);
    free_table(table);
    json_decref(results);
}

static void test_runs_table_has_a_row_for_each_run(void **state)
{
    (void)state;
    json_t *results = two_runs("creep", 2e-3, 0.1);
    pl_text_buffer out = {0};
    json_object_set_new(json_array_get(results, 1), "reason", json_string("a \"b\", c"));
    pl_result_table *table = table_of(results);
    pl_report_runs_csv(table, &out);
    assert_int_equal(count_of(out.data, "\r\n"), 3);
    assert_before(out.data, "run,scenario,params", ",verdict,verdict_reason,acceptance,");
    assert_contains(out.data, ",creep (m/s),");
    assert_contains(out.data, ",0.002");
    assert_contains(out.data, ",0.1");
    assert_contains(out.data, "\"a \"\"b\"\", c\"");
    pl_text_free(&out);
    free_table(table);
    json_decref(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_csv_parses_back_field_for_field),
        cmocka_unit_test(test_columns_of_numbers_have_no_text),
        cmocka_unit_test(test_csv_has_rows_for_metrics_and_empty_runs),
        cmocka_unit_test(test_runs_table_has_a_row_for_each_run),
    };
    return cmocka_run_group_tests_name("report_csv", tests, NULL, NULL);
}
