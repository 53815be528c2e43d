/* Judges results: metric by metric against the baseline, times and instructions as ratios to the
 * reference engine of the same results, and by the caller's rules. */
#include "gate.h"

#include "base/heap.h"
#include "base/json_field.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Entries ---- */

/* Adds an entry, whose other texts the caller fills in before the next one is added. */
static pl_gate_entry *add(pl_gate_verdict *verdict, bool is_failure, const pl_gate_row *row,
                          const char *metric, const char *what)
{
    pl_gate_entry entry = {.is_failure = is_failure, .row = row, .metric = metric};
    snprintf(entry.what, sizeof entry.what, "%.250s", what);
    pl_push(&verdict->items, &verdict->count, &entry, sizeof entry);
    verdict->failures += is_failure;
    verdict->notices += !is_failure;
    return &verdict->items[verdict->count - 1];
}

static void describe(pl_gate_entry *entry, const char *before, const char *after,
                     const char *allowed)
{
    snprintf(entry->before, sizeof entry->before, "%.90s", before);
    snprintf(entry->after, sizeof entry->after, "%.90s", after);
    snprintf(entry->allowed, sizeof entry->allowed, "%.125s", allowed);
}

/* Adds one row to a notice. Notices of equal metric and words become one. */
static void note(pl_gate_verdict *verdict, const char *metric, const char *what)
{
    for (int i = 0; i < verdict->count; ++i) {
        pl_gate_entry *known = &verdict->items[i];
        if (known->row_count > 0 && strcmp(known->metric, metric) == 0 &&
            strcmp(known->what, what) == 0) {
            ++known->row_count;
            return;
        }
    }
    add(verdict, false, NULL, metric, what)->row_count = 1;
}

/* Sorts the entries: failures, notices of one row, notices of several rows. The sort is stable. */
static void sort_entries(pl_gate_verdict *verdict)
{
    pl_gate_entry *sorted = NULL;
    int count = 0;
    for (int part = 0; part < 3; ++part) {
        for (int i = 0; i < verdict->count; ++i) {
            const pl_gate_entry *entry = &verdict->items[i];
            if (!entry->is_failure + (entry->row_count > 0) == part) {
                pl_push(&sorted, &count, entry, sizeof *entry);
            }
        }
    }
    free(verdict->items);
    verdict->items = sorted;
}

/* Writes both values with as few digits as distinguish them, and their unit ("": none). */
static void write_numbers(pl_gate_entry *entry, double before, double after, const char *unit)
{
    static const int digits[] = {4, 6, 17};
    const char *blank = unit[0] == '\0' ? "" : " ";
    for (size_t i = 0; i < sizeof digits / sizeof digits[0]; ++i) {
        snprintf(entry->before, sizeof entry->before, "%.*g%s%.40s", digits[i], before, blank,
                 unit);
        snprintf(entry->after, sizeof entry->after, "%.*g%s%.40s", digits[i], after, blank, unit);
        if (before == after || strcmp(entry->before, entry->after) != 0) {
            return;
        }
    }
}

/* What is said about an improvement. */
static const char BETTER[] = "better: --update-baseline tightens the baseline";

static const char *unit_of(const char *metric)
{
    return pl_metric_table_unit(pl_metric_by_name(metric));
}

/* ---- Metrics ---- */

/* Writes a value, or why there is none. */
static void value_text(const json_t *value, char text[96])
{
    if (json_is_string(value)) {
        snprintf(text, 96, "%.90s", json_string_value(value));
    } else if (json_is_number(value)) {
        snprintf(text, 96, "%.6g", json_number_value(value));
    } else {
        snprintf(text, 96, "%s", value == NULL ? "absent" : "no value");
    }
}

/* Judges a metric of which at least one value is not a number. */
static void judge_others(const pl_gate_row *row, const char *metric, const json_t *before,
                         const json_t *now, pl_gate_verdict *verdict)
{
    int id = pl_metric_by_name(metric);
    ++verdict->comparisons;
    if (now != NULL && json_equal(before, now)) {
        return;
    }
    if (id == PL_METRIC_STATE_HASH && !verdict->tolerances->of[id].given) {
        note(verdict, "state_hash", "other bits");
        return;
    }
    const bool gained = json_is_null(before) && json_is_number(now);
    const char *reason = pl_gate_cell_metric(row->cell, metric).reason;
    const bool has_reason = json_is_null(now) && reason != NULL && reason[0] != '\0';
    char old_text[96], new_text[96];
    value_text(before, old_text);
    value_text(now, new_text);
    describe(add(verdict, !gained, row, metric,
                 gained        ? "has a value now"
                 : now == NULL ? "the metric is gone"
                 : has_reason  ? reason
                               : "changed"),
             old_text, new_text, gained ? "" : "the same");
}

/* Whether a number that every repeat should have differs between them. */
static bool is_spread(const pl_metric_summary *summary)
{
    return summary->state == PL_METRIC_VALUE && summary->is_deterministic &&
           summary->min != summary->max;
}

/* Where repeats differ, returns the value that is farthest on the wrong side of `before`. */
static double worst_of(const pl_metric_summary *summary, pl_direction direction, double before)
{
    if (!is_spread(summary)) {
        return summary->value;
    }
    const double least = summary->min, largest = summary->max;
    if (direction == PL_NO_DIRECTION) {
        return fabs(least - before) > fabs(largest - before) ? least : largest;
    }
    return direction == PL_LOWER_IS_BETTER ? largest : least;
}

/* Says how far `now` is from `before`; `word` is "worse", "better" or "changed". `hint` comes after it. */
static void describe_change(double before, double now, const char *word, const char *hint,
                            char what[256])
{
    double part = fabs(now - before) / fabs(before);
    if (!isfinite(part)) {
        snprintf(what, 256, "%s%s", word, hint);
    } else if (part < 10) {
        snprintf(what, 256, "%s by %.3g %%%s", word, 100 * part, hint);
    } else {
        snprintf(what, 256, "%s, %.3g times%s", word, now / before, hint);
    }
}

static void judge_number(const pl_gate_row *row, const char *metric, double before,
                         pl_gate_verdict *verdict)
{
    static const pl_gate_tolerance unknown = {.relative = 1e-6, .absolute = 1e-9};
    int id = pl_metric_by_name(metric);
    pl_direction direction = id < 0 ? PL_NO_DIRECTION : pl_metric_table[id].direction;
    double dt = pl_json_get_number(row->json, "dt");
    double allowed =
        pl_gate_tolerance_at(id < 0 ? &unknown : &verdict->tolerances->of[id], id, before, dt);
    const pl_metric_summary summary = pl_gate_cell_metric(row->cell, metric);
    const double now = worst_of(&summary, direction, before);
    ++verdict->comparisons;
    if (is_spread(&summary)) {
        note(verdict, metric, "repeats differ, and the worst of them counts");
    }
    if (fabs(now - before) <= allowed) {
        return;
    }
    bool grew = now > before;
    bool is_better = direction != PL_NO_DIRECTION && grew == (direction == PL_HIGHER_IS_BETTER);
    const char *unit = pl_metric_table_unit(id);
    const char *word = is_better ? "better" : direction == PL_NO_DIRECTION ? "changed" : "worse";
    char what[256];
    describe_change(before, now, word, is_better ? BETTER + strlen("better") : "", what);
    pl_gate_entry *entry = add(verdict, !is_better, row, metric, what);
    write_numbers(entry, before, now, unit);
    snprintf(entry->allowed, sizeof entry->allowed, "a difference of %.3g%s%.40s", allowed,
             unit[0] == '\0' ? "" : " ", unit);
}

static void judge_metrics(const pl_gate_row *before, const pl_gate_row *now,
                          pl_gate_verdict *verdict)
{
    const char *metric;
    json_t *value;
    json_object_foreach((json_t *)before->metrics, metric, value)
    {
        int id = pl_metric_by_name(metric);
        const json_t *found = json_object_get(now->metrics, metric);
        if (id >= 0 && verdict->tolerances->of[id].off) {
            continue;
        }
        if (found == NULL && pl_gate_cell_metric(now->cell, metric).state != PL_METRIC_ABSENT) {
            note(verdict, metric, "is compared only with --tolerance");
        } else if (json_is_number(value) && json_is_number(found)) {
            judge_number(now, metric, json_number_value(value), verdict);
        } else {
            judge_others(now, metric, value, found, verdict);
        }
    }
    json_object_foreach((json_t *)now->metrics, metric, value)
    {
        int id = pl_metric_by_name(metric);
        bool is_off = id >= 0 && verdict->tolerances->of[id].off;
        if (!is_off && json_object_get(before->metrics, metric) == NULL) {
            note(verdict, metric, "the baseline has no such metric");
        }
    }
}

/* ---- Times and instructions ---- */

/* Returns the last relative rule on this cost of the row, which replaces the general limit. */
static const pl_gate_rule *rule_of(const pl_gate_verdict *verdict, const pl_gate_row *row, int cost)
{
    const pl_gate_rule *found = NULL;
    for (int i = 0; i < verdict->rule_count; ++i) {
        const pl_gate_rule *rule = &verdict->rules[i];
        if (pl_gate_rule_is_cost(rule) && pl_gate_cost_of(rule->metric) == cost &&
            pl_gate_rule_selects(rule, row)) {
            found = rule;
        }
    }
    return found;
}

/* Judges a ratio against `kept`, that of the baseline. */
static void judge_trend(const pl_gate_row *row, int cost, const json_t *kept,
                        const pl_gate_ratio *now, double limit, pl_gate_verdict *verdict)
{
    static const char *const words[] = {[PL_GATE_STEADY] = "",
                                        [PL_GATE_SLOWER] = "costlier",
                                        [PL_GATE_FASTER] = "cheaper",
                                        [PL_GATE_FEW] = "",
                                        [PL_GATE_NOISY] = "inconclusive"};
    const char *metric = pl_metric_table[cost].name;
    double growth, noise;
    const pl_gate_ratio before = pl_gate_ratio_of_json(kept);
    pl_gate_trend trend = pl_gate_ratio_trend(&before, now, limit, &growth, &noise);
    if (trend == PL_GATE_FEW) {
        note(verdict, metric,
             "inconclusive: noise is known from 5 repeats or more (--repeat 5), "
             "here and in the baseline");
        return;
    }
    ++verdict->comparisons;
    if (trend == PL_GATE_STEADY) {
        return;
    }
    char unit[80], what[256];
    snprintf(unit, sizeof unit, "times %.70s's", pl_json_get_text(kept, "reference"));
    snprintf(what, sizeof what, "%s: %+.3g %%, noise %.2g %%", words[trend], 100 * growth,
             100 * noise);
    pl_gate_entry *entry = add(verdict, trend == PL_GATE_SLOWER, row, metric, what);
    write_numbers(entry, before.value, now->value, unit);
    snprintf(entry->allowed, sizeof entry->allowed, "+%.3g %% and the noise", 100 * limit);
}

static void judge_cost(const pl_gate_row *before, const pl_gate_row *now, int cost,
                       pl_gate_verdict *verdict)
{
    const char *metric = pl_metric_table[cost].name;
    const json_t *kept = json_object_get(before->json, pl_metric_table[cost].ratio);
    const pl_gate_rule *rule = rule_of(verdict, now, cost);
    if (kept == NULL || (!pl_metric_is(cost, PL_TRAIT_GATED) && rule == NULL)) {
        return;
    }
    const char *kept_reference = pl_json_get_text(kept, "reference");
    if (verdict->reference != NULL && strcmp(verdict->reference, kept_reference) != 0) {
        note(verdict, metric, "not compared: the baseline has another reference");
        return;
    }
    const pl_gate_ratio ratio = pl_gate_ratio_measure(
        now->cell, pl_gate_reference_of(verdict->now, now, kept_reference), metric);
    if (ratio.repeats == 0) {
        note(verdict, metric, "not compared: no run of the reference engine on the same case");
        return;
    }
    double limit = rule != NULL                      ? rule->value
                   : cost == PL_METRIC_TIME_PER_STEP ? verdict->tolerances->time
                                                     : verdict->tolerances->instructions;
    judge_trend(now, cost, kept, &ratio, limit, verdict);
}

/* ---- Rules ---- */

/* The finding of a rule about a row. */
typedef enum judgement {
    SKIPPED, /* it has no value that the rule is about */
    PASSES,
    FAILS,
    KNOWN /* judge_cost judged it */
} judgement;

/* Each of these functions fills the texts of the entry that a failure gets. */

/* `reason`: why the text is what it is, or "". */
static judgement judge_text(const pl_gate_rule *rule, const char *found, const char *reason,
                            pl_gate_entry *entry)
{
    snprintf(entry->after, sizeof entry->after, "%.90s", found);
    snprintf(entry->what, sizeof entry->what, "%.250s", reason);
    return (strcmp(found, rule->word) == 0) == (rule->op == PL_GATE_EQUAL) ? FAILS : PASSES;
}

/* A run that is not ok may lack the value that the rule is about, and fails. */
static judgement judge_no_value(const pl_gate_row *row, const pl_metric_summary *found,
                                pl_gate_entry *entry)
{
    const bool is_ok = pl_gate_row_is_ok(row);
    const char *reason = found->reason == NULL ? "" : found->reason;
    snprintf(entry->what, sizeof entry->what, "%.120s%s%.120s", is_ok ? reason : row->outcome,
             row->reason[0] == '\0' ? "" : ": ", row->reason);
    snprintf(entry->after, sizeof entry->after, "no value");
    return found->state == PL_METRIC_ABSENT && is_ok ? SKIPPED : FAILS;
}

/* The rule fails the row where it holds of any repeat. */
static judgement judge_absolute(const pl_gate_rule *rule, const pl_metric_summary *found,
                                pl_gate_entry *entry)
{
    const double numbers[] = {found->value, found->min, found->max};
    const int count = is_spread(found) ? 3 : 1;
    for (int i = 0; i < count; ++i) {
        if (pl_gate_rule_holds(rule, numbers[i])) {
            write_numbers(entry, numbers[i], numbers[i], unit_of(rule->metric));
            entry->before[0] = '\0';
            return FAILS;
        }
    }
    return PASSES;
}

static judgement judge_relative(const pl_gate_verdict *verdict, const pl_gate_rule *rule,
                                const pl_gate_row *row, double now, pl_gate_entry *entry)
{
    const pl_gate_row *before =
        verdict->before == NULL ? NULL : pl_gate_rows_find(verdict->before, row->key);
    const json_t *kept = before == NULL ? NULL : json_object_get(before->metrics, rule->metric);
    if (!json_is_number(kept)) {
        return SKIPPED;
    }
    const int id = pl_metric_by_name(rule->metric);
    const double least = id < 0 ? 0 : verdict->tolerances->of[id].absolute;
    write_numbers(entry, json_number_value(kept), now, unit_of(rule->metric));
    return pl_gate_rule_holds_relative(rule, json_number_value(kept), now, least) ? FAILS : PASSES;
}

/* Judges a ratio by an absolute rule. */
static judgement judge_ratio(const pl_gate_verdict *verdict, const pl_gate_rule *rule,
                             const pl_gate_row *row, pl_gate_entry *entry)
{
    const pl_result_cell *reference = pl_gate_reference_of(verdict->now, row, verdict->reference);
    const pl_gate_ratio ratio = pl_gate_ratio_measure(
        row->cell, reference, pl_metric_table[pl_gate_cost_of(rule->metric)].name);
    if (ratio.repeats == 0) {
        return SKIPPED;
    }
    snprintf(entry->after, sizeof entry->after, "%.4g times %.60s's", ratio.value,
             pl_gate_label_of(verdict->now, reference));
    return pl_gate_rule_holds(rule, ratio.value) ? FAILS : PASSES;
}

static judgement judge_by_rule(const pl_gate_verdict *verdict, const pl_gate_rule *rule,
                               const pl_gate_row *row, pl_gate_entry *entry)
{
    const int cost = pl_gate_cost_of(rule->metric);
    if (pl_gate_rule_is_cost(rule)) {
        const pl_gate_row *before =
            verdict->before == NULL ? NULL : pl_gate_rows_find(verdict->before, row->key);
        const char *ratio = pl_metric_table[cost].ratio;
        return before != NULL && json_object_get(before->json, ratio) != NULL ? KNOWN : SKIPPED;
    }
    if (cost >= 0 && strcmp(rule->metric, pl_metric_table[cost].ratio) == 0) {
        return judge_ratio(verdict, rule, row, entry);
    }
    if (strcmp(rule->metric, "outcome") == 0) {
        return judge_text(rule, row->outcome, row->reason, entry);
    }
    if (strcmp(rule->metric, "verdict") == 0) {
        return judge_text(rule, pl_verdict_name(row->verdict), row->verdict_reason, entry);
    }
    const pl_metric_summary found = pl_gate_cell_metric(row->cell, rule->metric);
    if (rule->is_text) {
        return found.state == PL_METRIC_TEXT ? judge_text(rule, found.text, row->reason, entry)
                                             : SKIPPED;
    }
    return found.state != PL_METRIC_VALUE ? judge_no_value(row, &found, entry)
           : rule->is_relative            ? judge_relative(verdict, rule, row, found.value, entry)
                                          : judge_absolute(rule, &found, entry);
}

static void add_rule_failure(const pl_gate_rule *rule, const pl_gate_entry *made,
                             pl_gate_verdict *verdict)
{
    pl_gate_entry *entry = add(verdict, true, made->row, rule->metric,
                               made->what[0] == '\0' ? "the rule fails it" : made->what);
    describe(entry, made->before, made->after, "");
    snprintf(entry->allowed, sizeof entry->allowed, "not %.120s", rule->text);
}

/* A rule that judges nothing fails: otherwise a misspelt name, or a run that is missing, would let
 * everything pass. */
static void judge_rule(const pl_gate_rule *rule, pl_gate_verdict *verdict)
{
    int selected = 0, judged = 0;
    for (int k = 0; k < verdict->now->count; ++k) {
        const pl_gate_row *row = &verdict->now->items[k];
        if (pl_gate_rule_selects(rule, row)) {
            pl_gate_entry entry = {.row = row};
            const judgement found = judge_by_rule(verdict, rule, row, &entry);
            ++selected;
            judged += found != SKIPPED;
            verdict->comparisons += found == PASSES || found == FAILS;
            if (found == FAILS) {
                add_rule_failure(rule, &entry, verdict);
            }
        }
    }
    if (judged == 0) {
        pl_gate_entry entry = {.row = NULL};
        snprintf(entry.what, sizeof entry.what, "the rule judges nothing: %s",
                 selected == 0 ? "no row is of that scenario and engine"
                               : "no row that it is of has the value");
        add_rule_failure(rule, &entry, verdict);
    }
}

/* ---- Runs ---- */

/* Returns true when both are ok, so that their numbers can be compared. */
static bool judge_outcome(const pl_gate_row *before, const pl_gate_row *now,
                          pl_gate_verdict *verdict)
{
    ++verdict->comparisons;
    if (strcmp(before->outcome, now->outcome) == 0) {
        return pl_gate_row_is_ok(now);
    }
    const bool is_better = pl_gate_row_is_ok(now);
    describe(add(verdict, !is_better, now, "outcome",
                 is_better             ? BETTER
                 : now->reason[0] != 0 ? now->reason
                                       : "another outcome"),
             before->outcome, now->outcome, "the same outcome");
    return false;
}

/* Of runs that both ended ok. The order of verdicts is from right to wrong. */
static void judge_verdict(const pl_gate_row *before, const pl_gate_row *now,
                          pl_gate_verdict *verdict)
{
    if (before->verdict == PL_VERDICT_UNJUDGED || now->verdict == PL_VERDICT_UNJUDGED) {
        if (before->verdict != now->verdict) {
            note(verdict, "verdict",
                 now->verdict == PL_VERDICT_UNJUDGED
                     ? "is no longer judged"
                     : "the baseline has none: --update-baseline takes it in");
        }
        return;
    }
    ++verdict->comparisons;
    if (before->verdict == now->verdict) {
        return;
    }
    const bool is_better = now->verdict < before->verdict;
    describe(add(verdict, !is_better, now, "verdict", is_better ? BETTER : now->verdict_reason),
             pl_verdict_name(before->verdict), pl_verdict_name(now->verdict), "no worse verdict");
}

static void judge_row(const pl_gate_row *before, const pl_gate_row *now, pl_gate_verdict *verdict)
{
    const char *hash = json_string_value(json_object_get(before->json, "scene_hash"));
    const char *new_hash = json_string_value(json_object_get(now->json, "scene_hash"));
    if (hash != NULL && new_hash != NULL && strcmp(hash, new_hash) != 0) {
        describe(add(verdict, false, now, "scene_hash", "the scene is another one"), hash, new_hash,
                 "");
    }
    if (!judge_outcome(before, now, verdict)) {
        return;
    }
    judge_verdict(before, now, verdict);
    judge_metrics(before, now, verdict);
    for (int cost = 0; cost < PL_METRIC_COUNT; ++cost) {
        judge_cost(before, now, cost, verdict);
    }
}

static void judge_baseline(pl_gate_verdict *verdict)
{
    for (int i = 0; i < verdict->before->count; ++i) {
        const pl_gate_row *before = &verdict->before->items[i];
        const pl_gate_row *now = pl_gate_rows_find(verdict->now, before->key);
        if (now == NULL) {
            describe(add(verdict, true, before, "outcome", "the results have no such run"),
                     before->outcome, "missing", "every run of the baseline");
        } else {
            judge_row(before, now, verdict);
        }
    }
    for (int i = 0; i < verdict->now->count; ++i) {
        const pl_gate_row *now = &verdict->now->items[i];
        if (pl_gate_rows_find(verdict->before, now->key) == NULL) {
            describe(add(verdict, false, now, "outcome",
                         "not in the baseline: --update-baseline takes it in"),
                     "none", now->outcome, "");
        }
    }
}

void pl_gate_judge(pl_gate_verdict *verdict)
{
    if (verdict->before != NULL) {
        judge_baseline(verdict);
    }
    for (int i = 0; i < verdict->rule_count; ++i) {
        judge_rule(&verdict->rules[i], verdict);
    }
    sort_entries(verdict);
}
