/* Results made by hand, judged by the gate against results made by hand. */
#ifndef PLUMB_TEST_GATE_TRIAL_H
#define PLUMB_TEST_GATE_TRIAL_H

#include "gate/gate.h"
#include "plumb_process.h"
#include "result_tables.h"

/* Two lists of results, the first of which goes through a baseline file, and the verdict. */
typedef struct trial {
    json_t *old_results, *new_results;
    pl_result_table *old_table, *new_table;
    pl_gate_rows made, before, now;
    pl_gate_tolerances tolerances;
    pl_gate_rule rules[2];
    int rule_count;
    pl_gate_verdict verdict;
} trial;

/* Makes a trial, which takes both lists. */
trial begin_trial(json_t *old_results, json_t *new_results);

/* Adds a rule or sets a tolerance. The test fails where the text is malformed. */
void add_rule(trial *t, const char *text);
void set_tolerance(trial *t, const char *text);

/* Judges by a baseline file in the workspace. */
void judge(const workspace *w, trial *t);

/* Frees everything. */
void end_trial(trial *t);

/* Judges and ends: expects that many failures and notices, of which the first says `what` of
 * `metric`. */
void expect(const workspace *w, trial t, int failures, int notices, const char *metric,
            const char *what);

/* Makes one run of mine:p in `scene` with one metric, whose value is taken. */
json_t *single(const char *metric, json_t *value);

/* Makes a trial of such a run before and now. */
trial pair(const char *metric, double before, double now);

#endif
