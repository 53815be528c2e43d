#include "threshold_row.h"

#include <math.h>
#include <string.h>

/* The middle of the bracket; NAN unless the value was found. */
static double value_of(const pl_threshold_search *search)
{
    const pl_bisection *b = &search->bisection;
    bool found = search->outcome[0] == '\0' && b->state == PL_BISECTION_FOUND;
    return found ? b->low + (b->high - b->low) / 2 : (double)NAN;
}

static json_t *number(double value)
{
    return pl_json_number_or_null(value);
}

/* The keys of a run's identity that also hold for a search. */
static json_t *identity_of(const pl_plan *plan, const pl_threshold_search *search)
{
    static const char *const of_one_run[] = {"run", "repeat", "scene_hash"};
    const pl_planned_run planned = {.test_case = &plan->cases[search->problem],
                                    .configuration = &plan->configurations[search->configuration]};
    json_t *identity = pl_planned_run_identity(plan, &planned);
    for (size_t i = 0; identity != NULL && i < sizeof of_one_run / sizeof of_one_run[0]; ++i) {
        json_object_del(identity, of_one_run[i]);
    }
    const pl_scenario *scenario = planned.test_case->descriptor;
    json_object_del(json_object_get(identity, "params"), scenario->threshold->param);
    return identity;
}

json_t *pl_threshold_json(const pl_plan *plan, const pl_threshold_search *search,
                          json_t *provenance, const char *started)
{
    const pl_scenario *scenario = plan->cases[search->problem].descriptor;
    const pl_threshold *t = scenario->threshold;
    const double value = value_of(search), critical = pl_threshold_critical(plan, search);
    const double low = isnan(value) ? value : search->bisection.low;
    const double high = isnan(value) ? value : search->bisection.high;
    const char *reason = search->reason[0] != '\0' ? search->reason : NULL;
    json_t *row = identity_of(plan, search);
    json_t *found = json_pack(
        "{s:s, s:s, s:s, s:s, s:s?, s:o, s:[o,o], s:[f,f], s:b, s:f, s:o, s:s?, s:o, s:o, s:i, "
        "s:s}",
        "schema", "plumb.threshold/1", "param", t->param, "unit",
        scenario->params[search->param].unit, "finding", pl_threshold_outcome(search), "reason",
        reason, "value", number(value), "bracket", number(low), number(high), "searched", t->low,
        t->high, "holds_below", (int)t->holds_below, "tolerance", t->tolerance, "closed_form",
        number(critical), "formula", t->formula, "error", number(value - critical),
        "relative_error", number((value - critical) / critical), "runs", search->runs, "started",
        started);
    if (row == NULL || found == NULL || json_object_update(row, found) != 0 ||
        json_object_update(row, provenance) != 0) {
        json_decref(row);
        row = NULL;
    }
    json_decref(found);
    return row;
}

static void print_head(FILE *out, const pl_plan *plan, const pl_threshold_search *search, int width)
{
    const pl_scenario *scenario = plan->cases[search->problem].descriptor;
    const pl_threshold *t = scenario->threshold;
    const pl_param *param = &scenario->params[search->param];
    const bool plain = strcmp(param->unit, "1") == 0;
    const double critical = pl_threshold_critical(plan, search);
    fprintf(out, "%s: critical %s%s%s, searched from %g to %g, holds %s it\n", scenario->name,
            t->param, plain ? "" : ", ", plain ? "" : param->unit, t->low, t->high,
            t->holds_below ? "below" : "above");
    if (isnan(critical)) {
        fprintf(out, "  no closed form\n");
    } else {
        fprintf(out, "  closed form: %.9g = %s\n", critical, t->formula);
    }
    fprintf(out, "  %-*s %14s %10s %12s %12s %5s\n", width, "engine", "value", "+-", "error",
            "relative", "runs");
}

static void print_row(FILE *out, const pl_plan *plan, const pl_threshold_search *search, int width)
{
    const double value = value_of(search), critical = pl_threshold_critical(plan, search);
    fprintf(out, "  %-*s ", width, plan->contenders[search->contender].label);
    if (isnan(value)) {
        fprintf(out, "%s", pl_threshold_outcome(search));
        if (search->reason[0] != '\0') {
            fprintf(out, ": %s", search->reason);
        }
        fprintf(out, " (%d %s)\n", search->runs, search->runs == 1 ? "run" : "runs");
        return;
    }
    fprintf(out, "%14.9g %10.2g", value, (search->bisection.high - search->bisection.low) / 2);
    if (isnan(critical)) {
        fprintf(out, " %12s %12s", "-", "-");
    } else {
        fprintf(out, " %12.2e %12.2e", value - critical, (value - critical) / critical);
    }
    fprintf(out, " %5d\n", search->runs);
}

void pl_threshold_print(FILE *out, const pl_plan *plan, const pl_threshold_search *searches,
                        int count)
{
    int width = (int)strlen("engine"), problem = -1;
    for (int i = 0; i < plan->configuration_count; ++i) {
        int length = (int)strlen(plan->configurations[i].label);
        width = length > width ? length : width;
    }
    for (int i = 0; i < count; ++i) {
        if (searches[i].problem != problem) {
            problem = searches[i].problem;
            fprintf(out, "%s", i == 0 ? "" : "\n");
            print_head(out, plan, &searches[i], width);
        }
        print_row(out, plan, &searches[i], width);
    }
}
