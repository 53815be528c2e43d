/* The gate: results against a baseline (plumb.baseline/1, SCHEMA.md) and against rules.
 *
 *     results ──▶ table ──▶ rows ──┐
 *     baseline file ──────▶ rows ──┴──▶ judge ──▶ verdict ──▶ text, JUnit, GitHub, JSON
 *
 * A row is the repeats of one run summarised together, as a baseline keeps them. */
#ifndef PLUMB_GATE_H
#define PLUMB_GATE_H

#include "base/text_buffer.h"
#include "results/result_table.h"

/* ---- Rows ---- */

/* A cell of a table, or a row of a baseline. */
typedef struct pl_gate_row {
    json_t *json; /* owned; its object in a baseline file, which holds the texts and metrics */
    char *key;    /* owned; pl_case_key, then the engine */
    char name[PL_CASE_NAME_SIZE]; /* pl_case_name */
    bool is_shared;               /* another run of the engine has that name */
    const char *scenario, *label, *outcome;
    pl_verdict verdict;
    const json_t *metrics; /* name -> number, text, or null where it applies and has no value */
    const pl_result_cell *cell; /* NULL: of a baseline */
    const char *reason;         /* why the outcome is not ok; "" when it is, and of a baseline */
    const char
        *verdict_reason; /* why the verdict is not accurate; "" when it is, and of a baseline */
} pl_gate_row;

/* A list of rows. */
typedef struct pl_gate_rows {
    pl_gate_row *items; /* sorted by key */
    int count;
    const pl_result_table *results; /* whose cells they are; NULL: of a baseline */
} pl_gate_rows;

/* Adds dt and duration to names that several rows share. Both lists are looked at, so that a row has the same name
 * in both. */
void pl_gate_rows_disambiguate(pl_gate_rows *rows, pl_gate_rows *other);

/* Returns the row of that key; NULL when there is none. */
const pl_gate_row *pl_gate_rows_find(const pl_gate_rows *rows, const char *key);

/* Whether the outcome of all repeats is ok. */
bool pl_gate_row_is_ok(const pl_gate_row *row);

/* Summarises a metric over the repeats of a cell. It has no value as soon as one repeat has none. */
pl_metric_summary pl_gate_cell_metric(const pl_result_cell *cell, const char *metric);

/* Frees all rows. */
void pl_gate_rows_free(pl_gate_rows *rows);

/* ---- Ratios ---- */

/* The fewest repeats from which noise can be known. */
enum { PL_GATE_FEWEST_REPEATS = 5 };

/* The cost of a run over that of the reference engine on the same case, over the repeats. It depends less on the
 * machine than a time does. */
typedef struct pl_gate_ratio {
    int repeats;      /* 0: there is no ratio */
    double value;     /* the median over repeats */
    double low, high; /* bounds of the median */
} pl_gate_ratio;

/* Returns the pl_metric_id of the cost whose metric or ratio has that name; -1: none. */
int pl_gate_cost_of(const char *name);

/* Returns the cell of the reference engine on the case of `row`, a row of results: of the engine `label`, or where
 * that is NULL, of the first of bullet:si and ode:quick that was run. NULL: none, or that of `row` itself. */
const pl_result_cell *pl_gate_reference_of(const pl_gate_rows *rows, const pl_gate_row *row,
                                           const char *label);

/* The label of a cell's engine. */
const char *pl_gate_label_of(const pl_gate_rows *rows, const pl_result_cell *cell);

/* The ratio of a metric of two cells of one case: each repeat of `cell` over the same repeat of `reference` in the
 * same file. No `reference` (NULL): no ratio. */
pl_gate_ratio pl_gate_ratio_measure(const pl_result_cell *cell, const pl_result_cell *reference,
                                    const char *metric);

/* Adds the ratios of all rows to their objects, as a baseline keeps them. */
void pl_gate_ratios_add(pl_gate_rows *rows, const char *label);

/* Reads such an object, {reference, value, low, high, repeats}; 0 repeats if it is none. */
pl_gate_ratio pl_gate_ratio_of_json(const json_t *json);

/* How a ratio differs from that of the baseline. */
typedef enum pl_gate_trend {
    PL_GATE_STEADY,
    PL_GATE_SLOWER, /* by more than the limit and the noise together */
    PL_GATE_FASTER,
    PL_GATE_FEW,  /* too few repeats to know the noise */
    PL_GATE_NOISY /* noise hides a change of the size of the limit */
} pl_gate_trend;

/* Compares two ratios. *growth: now / before - 1. *noise: half the width of its bounds. */
pl_gate_trend pl_gate_ratio_trend(const pl_gate_ratio *before, const pl_gate_ratio *now,
                                  double limit, double *growth, double *noise);

/* ---- Tolerances and rules ---- */

/* How far a metric may be from its baseline: the larger of `absolute` (in the metric's unit) and
 * `relative` times the baseline's value. */
typedef struct pl_gate_tolerance {
    bool given; /* by the caller */
    bool off;   /* the metric is not compared */
    double relative, absolute;
} pl_gate_tolerance;

/* The tolerances of all metrics. */
typedef struct pl_gate_tolerances {
    pl_gate_tolerance of[PL_METRIC_COUNT];
    double time, instructions; /* growth of a ratio to the reference engine: 0.1 is 10 % */
} pl_gate_tolerances;

/* The tolerances where the caller gives none. */
pl_gate_tolerances pl_gate_tolerances_default(void);

/* Reads "METRIC=RELATIVE[,ABSOLUTE]" or "METRIC=off". PL_BAD_INPUT names the metric (with the
 * nearest one) or the number that is wrong. */
pl_status pl_gate_tolerances_parse(const char *text, pl_gate_tolerances *tolerances,
                                   pl_error *error);

/* Returns the allowed difference from `value`, in the metric's unit. `dt`: the run's step, s. */
double pl_gate_tolerance_at(const pl_gate_tolerance *tolerance, int metric, double value,
                            double dt);

/* Each bit is one of the three results of a comparison; it is set if the rule holds for that result. */
typedef enum pl_gate_operator {
    PL_GATE_BELOW = 1,                                /* < */
    PL_GATE_EQUAL = 2,                                /* == */
    PL_GATE_ABOVE = 4,                                /* > */
    PL_GATE_AT_MOST = PL_GATE_BELOW | PL_GATE_EQUAL,  /* <= */
    PL_GATE_AT_LEAST = PL_GATE_ABOVE | PL_GATE_EQUAL, /* >= */
    PL_GATE_OTHER = PL_GATE_BELOW | PL_GATE_ABOVE     /* != */
} pl_gate_operator;

/* A rule, [SCENARIO[/ENGINE]:] METRIC OP VALUE. */
typedef struct pl_gate_rule {
    const char *text;                /* as given, borrowed */
    char scenario[256], engine[256]; /* shell patterns; "": any */
    char metric[PL_NAME_SIZE];
    pl_gate_operator op;
    bool is_text, is_relative; /* relative: to the baseline */
    bool is_bound;             /* the operator is neither == nor != */
    double value;              /* +10 %: 0.1 */
    char word[64];             /* of a text */
    int value_column;          /* from 1 */
} pl_gate_rule;

/* Reads a rule. PL_BAD_INPUT names the column, from 1, what was expected and what was found, and
 * for an unknown metric the nearest one. */
pl_status pl_gate_rule_parse(const char *text, pl_gate_rule *rule, pl_error *error);

/* Whether the rule is about this row. A scenario is selected by its name or by the row's name with
 * parameters; an engine by its label, or all of its profiles by the engine's name. */
bool pl_gate_rule_selects(const pl_gate_rule *rule, const pl_gate_row *row);

/* Whether the rule's condition holds, so that the gate fails. */
bool pl_gate_rule_holds(const pl_gate_rule *rule, double value);

/* Whether a relative rule holds of `now` against `before`, and by more than `least`. */
bool pl_gate_rule_holds_relative(const pl_gate_rule *rule, double before, double now, double least);

/* Whether it judges a ratio to the reference engine: it is relative, of a time or instructions. */
bool pl_gate_rule_is_cost(const pl_gate_rule *rule);

/* ---- Files ---- */

/* Reads FILE, or FILE/results.jsonl where FILE is a directory; "-" is standard input. An incomplete
 * last line is left out and reported on standard error. The caller decrefs *results. */
pl_status pl_gate_read(const char *path, json_t **results, pl_error *error);

/* Makes a row of each cell of the table, sorted. The table must outlive *rows, which the caller frees. */
void pl_gate_gather(const pl_result_table *results, const pl_gate_tolerances *tolerances,
                    pl_gate_rows *rows);

/* Reads the rows of a baseline, sorted. PL_BAD_INPUT: FILE:LINE:COLUMN: field: what was expected, what was found;
 * also where there is no such file. The caller frees *rows, also on failure. */
pl_status pl_gate_baseline_read(const char *path, pl_gate_rows *rows, pl_error *error);

/* Writes all rows under a temporary name, and renames the file when it is complete. */
pl_status pl_gate_baseline_write(const char *path, const pl_gate_rows *rows, pl_error *error);

/* ---- Judgement ---- */

/* A failure or a notice. */
typedef struct pl_gate_entry {
    bool is_failure;        /* else a notice */
    const pl_gate_row *row; /* NULL: of no single row */
    const char *metric;     /* "outcome", "time_per_step" ...; borrowed */
    char before[96], after[96];
    char allowed[128]; /* the tolerance, or the rule; "" where there is none */
    char what[256];    /* in words, such as "worse by 1 %" */
    int row_count;     /* of a notice of several rows, else 0 */
} pl_gate_entry;

/* What is judged and by what, which the caller sets, and what the gate says of it. */
typedef struct pl_gate_verdict {
    const pl_gate_rows *before; /* the baseline; NULL: rules alone */
    const pl_gate_rows *now;
    const pl_gate_tolerances *tolerances;
    const pl_gate_rule *rules; /* (rule_count) */
    int rule_count;
    const char *reference; /* the engine that times are compared with; NULL: that of the baseline */
    pl_gate_entry *items;  /* failures, notices of one row, notices of several rows */
    int count;
    int failures, notices;
    int comparisons; /* values compared with a baseline or a rule */
} pl_gate_verdict;

/* Judges, and adds what is found to *verdict, which borrows from the rows and rules. The caller frees its items. */
void pl_gate_judge(pl_gate_verdict *verdict);

/* Writes "gate passed: 120 comparisons of 8 rows, 2 notices" into a buffer of `size`. */
void pl_gate_verdict_summary(const pl_gate_verdict *verdict, char *text, size_t size);

/* The formats of a verdict. */
typedef enum pl_gate_format {
    PL_GATE_TEXT,  /* one line an entry, then the summary */
    PL_GATE_JUNIT, /* a test case for each run, and one for rules that judged nothing and notices */
    PL_GATE_GITHUB, /* workflow commands of GitHub Actions, and the summary in plain text */
    PL_GATE_JSON    /* plumb.gate/1 (SCHEMA.md) */
} pl_gate_format;

/* Appends the verdict in a format. */
void pl_gate_write(pl_gate_format format, const pl_gate_verdict *verdict, pl_text_buffer *out);

/* Appends the summary page of a job of GitHub Actions. */
void pl_gate_write_markdown(const pl_gate_verdict *verdict, pl_text_buffer *out);

#endif
