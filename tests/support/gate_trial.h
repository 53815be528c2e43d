/* Results made by hand, judged by the gate against results made by hand. */
#ifndef PLUMB_TEST_GATE_TRIAL_H
#define PLUMB_TEST_GATE_TRIAL_H

#include "gate/gather.h"
#include "gate/judge.h"
#include "plumb_process.h"

/* Two lists of results, the first of which goes through a baseline file, and what came of it. */
typedef struct trial {
    pl_gate_file old_file, new_file;
    pl_gate_rows made, before, now;
    pl_gate_tolerances tolerances;
    pl_gate_rule rules[2];
    int rule_count;
    pl_gate_verdict verdict;
} trial;

/* Takes both lists. */
trial begin_trial(json_t *old_results, json_t *new_results);

/* What is no rule, or no limit, fails the test. */
void add_rule(trial *t, const char *text);
void set_limit(trial *t, const char *text);

/* Judges by a baseline file in the workspace. */
void judge(const workspace *w, trial *t);
void end_trial(trial *t);

/* Judges and ends: the findings are these many, of which the first says `what` of `metric`. */
void expect(const workspace *w, trial t, int failures, int notices, const char *metric,
            const char *what);

/* One run of mine:p in `scene` with one metric, whose value is taken. */
json_t *single(const char *metric, json_t *value);

/* Such a run before and now. */
trial pair(const char *metric, double before, double now);

#endif
