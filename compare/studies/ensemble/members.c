/* Plans the cases and the runs of ensembles. */
#include "members.h"

#include "base/heap.h"
#include "plumb/jitter.h"
#include "runner/execute.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

/* The rows of cases: one for each setting, and one for the references. */
static int row_count(const pl_members_def *def)
{
    return def->setting_count + 1 + (def->references ? 1 : 0);
}

/* Adds the cases of one member of a row. */
static pl_status add_member(const pl_members_def *def, int row, int member, pl_plan *plan,
                            pl_ensembles *all, pl_error *error)
{
    const int before = plan->case_count, setting = row > def->setting_count ? 0 : row;
    plan->variation = (pl_variation){.is_member = true,
                                     .member = setting * def->members + member,
                                     .refinement = row > def->setting_count ? PL_FINER_STEPS : 0};
    pl_status status = def->add(def->user, setting, plan, error);
    const int added = plan->case_count - before;
    plan->variation = (pl_variation){.member = 0};
    for (int i = before; i < plan->case_count && status == PL_OK; ++i) {
        if (!isfinite(pl_scene_least_size(&plan->cases[i].scene))) {
            status = pl_fail(error, PL_BAD_INPUT, "%s: nothing in the scene can move",
                             plan->cases[i].name);
        }
    }
    if (before == 0) {
        all->case_count = added;
    } else if (status == PL_OK && added != all->case_count) {
        status = pl_fail(error, PL_BAD_INPUT,
                         "two of the scenarios asked for are the same in one setting and differ in "
                         "another: ask for them one at a time");
    }
    return status;
}

static void look_whether_refused(void *refused, json_t *result)
{
    *(bool *)refused = strcmp(pl_json_get_text(result, "outcome"), "unsupported") == 0;
}

/* Raises the engine's iterations, where it has that option and its profile takes the value, which a run of
 * one step shows. */
static pl_status strengthen(const pl_case *test_case, pl_configuration *configuration,
                            pl_error *error)
{
    const pl_engine_info *engine = configuration->choice.engine;
    const int option = pl_engine_option_index(engine, "iterations");
    if (option < 0) {
        return PL_OK;
    }
    bool is_refused = false;
    int signal_number = 0;
    pl_case short_case = *test_case;
    pl_configuration stronger = *configuration;
    const pl_plan trial = {.cases = &short_case,
                           .case_count = 1,
                           .configurations = &stronger,
                           .configuration_count = 1,
                           .repeats = 1};
    const pl_execution_def def = {.plan = &trial,
                                  .jobs = 1,
                                  .limits = {.timeout = 60},
                                  .user = &is_refused,
                                  .amend = look_whether_refused};
    double *value = &stronger.choice.values[option];
    *value = fmin(PL_MORE_ITERATIONS * *value, engine->options[option].max);
    short_case.scene.duration = short_case.scene.dt;
    const pl_status status = pl_execute(&def, &signal_number, error);
    if (signal_number != 0) {
        raise(signal_number);
    }
    if (!is_refused) {
        *configuration = stronger;
    }
    return status;
}

/* Adds a configuration NAME@converged for each of the first `count`. */
static pl_status add_references(pl_plan *plan, int count, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        char label[2 * PL_NAME_SIZE + 16];
        pl_configuration reference = plan->configurations[i];
        snprintf(label, sizeof label, "%.100s@converged", reference.label);
        status = strengthen(&plan->cases[0], &reference, error);
        if (status == PL_OK) {
            pl_plan_add_choice(plan, &reference.choice, label);
        }
    }
    return status;
}

static void list_ensembles(const pl_members_def *def, int engines, pl_ensembles *all)
{
    for (int p = 0; p < all->case_count; ++p) {
        for (int row = 0; row < row_count(def); ++row) {
            const bool reference = row > def->setting_count;
            for (int e = 0; e < engines; ++e) {
                const pl_ensemble added = {.test_case = p,
                                           .setting = reference ? 0 : row,
                                           .reference = reference,
                                           .configuration = reference ? engines + e : e,
                                           .first = row * all->members * all->case_count + p};
                pl_push(&all->items, &all->count, &added, sizeof added);
            }
        }
    }
}

/* Adds the runs member by member, so that an interrupted plan has runs of every ensemble.
 * References, which take longest, come last. */
static void pair_up(const pl_ensembles *all, pl_plan *plan)
{
    for (int pass = 0; pass < 2; ++pass) {
        for (int k = 0; k < all->members; ++k) {
            for (int i = 0; i < all->count; ++i) {
                const pl_ensemble *e = &all->items[i];
                if (e->reference == (pass == 1)) {
                    pl_plan_add_pairing(plan, pl_member_case(all, e, k), e->configuration);
                }
            }
        }
    }
}

pl_status pl_members_plan(const pl_members_def *def, pl_plan *plan, pl_ensembles *ensembles,
                          pl_error *error)
{
    const int engines = plan->configuration_count;
    pl_status status = PL_OK;
    *ensembles = (pl_ensembles){.members = def->members};
    for (int i = 0; i < row_count(def) * def->members && status == PL_OK; ++i) {
        status = add_member(def, i / def->members, i % def->members, plan, ensembles, error);
    }
    if (status == PL_OK && def->references && ensembles->case_count > 0) {
        status = add_references(plan, engines, error);
    }
    if (status == PL_OK) {
        list_ensembles(def, engines, ensembles);
        pair_up(ensembles, plan);
    }
    return status;
}

int pl_member_case(const pl_ensembles *ensembles, const pl_ensemble *ensemble, int member)
{
    return ensemble->first + member * ensembles->case_count;
}

json_t *pl_member_runs(const pl_plan *plan, const pl_ensembles *ensembles,
                       const pl_ensemble *ensemble)
{
    json_t *runs = json_array();
    for (int k = 0; k < ensembles->members; ++k) {
        const pl_planned_run planned = {
            .test_case = &plan->cases[pl_member_case(ensembles, ensemble, k)],
            .configuration = &plan->configurations[ensemble->configuration]};
        char run[17];
        pl_planned_run_hash(plan, &planned, run);
        json_array_append_new(runs, json_string(run));
    }
    return runs;
}
