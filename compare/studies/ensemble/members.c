/* Plans the cases and the runs of ensembles. */
#include "members.h"

#include "base/heap.h"
#include "engines/process.h"
#include "plumb/jitter.h"
#include "runner/session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The plan's index of the first case of each setting and member. */
typedef struct firsts {
    int *index; /* ((settings + 2) x members): the last row is that of the references */
    int members;
} firsts;

static int *first_of(const firsts *f, int row, int member)
{
    return &f->index[row * f->members + member];
}

/* Adds the cases of one member in one setting. */
static pl_status add_member(const pl_members_def *def, int setting, bool reference, int member,
                            pl_plan *plan, int *count, pl_error *error)
{
    const int before = plan->case_count;
    plan->variation = (pl_variation){.is_member = true,
                                     .member = setting * def->members + member,
                                     .refinement = reference ? PL_FINER_STEPS : 0};
    pl_status status = def->add(def->user, setting, plan, error);
    const int added = plan->case_count - before;
    plan->variation = (pl_variation){.member = 0};
    for (int i = before; i < plan->case_count && status == PL_OK; ++i) {
        if (!isfinite(pl_scene_least_size(&plan->cases[i].scene))) {
            status = pl_fail(error, PL_BAD_INPUT, "%s: nothing in the scene can move",
                             plan->cases[i].name);
        }
    }
    if (status == PL_OK && *count >= 0 && added != *count) {
        status = pl_fail(error, PL_BAD_INPUT,
                         "two of the scenarios asked for are the same in one setting and differ in "
                         "another: ask for them one at a time");
    }
    *count = added;
    return status;
}

static pl_status add_cases(const pl_members_def *def, pl_plan *plan, firsts *f, int *count,
                           pl_error *error)
{
    pl_status status = PL_OK;
    const int rows = def->setting_count + 1 + (def->references ? 1 : 0);
    *count = -1;
    for (int row = 0; row < rows && status == PL_OK; ++row) {
        const bool reference = row > def->setting_count;
        for (int k = 0; k < def->members && status == PL_OK; ++k) {
            *first_of(f, row, k) = plan->case_count;
            status = add_member(def, reference ? 0 : row, reference, k, plan, count, error);
        }
    }
    return status;
}

/* An attempt, in a process of its own, to create the engine with these values. */
typedef struct attempt {
    const pl_scene *scene;
    const pl_engine_choice *choice;
} attempt;

static void try_values(void *user, FILE *out)
{
    const attempt *a = user;
    pl_error error = {.message = ""};
    pl_session session = pl_session_begin(a->choice);
    pl_status status = pl_session_load(&session, &error);
    if (status == PL_OK) {
        status = pl_session_create(&session, a->scene, &error);
    }
    fputs(status == PL_UNSUPPORTED ? "unsupported" : "other", out);
}

/* Sets *refused to whether the engine's profile reports these values as unsupported. */
static pl_status refuses(const attempt *a, bool *refused, pl_error *error)
{
    const pl_limits limits = {.timeout = 60};
    pl_process process;
    pl_status status =
        pl_process_start(&process, &limits, try_values, &(attempt){a->scene, a->choice}, error);
    *refused = false;
    if (status != PL_OK) {
        return status;
    }
    status = pl_process_wait(&process, error);
    if (status != PL_OK) {
        return status;
    }
    *refused = process.text_length == strlen("unsupported") &&
               memcmp(process.text, "unsupported", process.text_length) == 0;
    pl_process_free(&process);
    return PL_OK;
}

/* Raises the engine's iterations, where it has that option and its profile takes the value. */
static pl_status strengthen(const pl_scene *scene, pl_engine_choice *choice, pl_error *error)
{
    const int option = pl_engine_option_index(choice->engine, "iterations");
    if (option < 0) {
        return PL_OK;
    }
    pl_engine_choice stronger = *choice;
    stronger.values[option] =
        fmin(PL_MORE_ITERATIONS * choice->values[option], choice->engine->options[option].max);
    bool refused = false;
    pl_status status = refuses(&(attempt){scene, &stronger}, &refused, error);
    if (status == PL_OK && !refused) {
        *choice = stronger;
    }
    return status;
}

/* Adds a configuration NAME@converged for each of the first `count`. */
static pl_status add_references(pl_plan *plan, int count, int test_case, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        char label[2 * PL_NAME_SIZE + 16];
        pl_engine_choice choice = plan->configurations[i].choice;
        snprintf(label, sizeof label, "%.100s@converged", plan->configurations[i].label);
        status = strengthen(&plan->cases[test_case].scene, &choice, error);
        if (status == PL_OK) {
            pl_plan_add_choice(plan, &choice, label);
        }
    }
    return status;
}

static void add_ensemble(const pl_members_def *def, const firsts *f, pl_ensemble added, int row,
                         pl_ensembles *all)
{
    added.cases = pl_heap_new((size_t)def->members, sizeof *added.cases);
    for (int k = 0; k < def->members; ++k) {
        added.cases[k] = *first_of(f, row, k) + added.test_case;
    }
    all->items[all->count++] = added;
}

static void list_ensembles(const pl_members_def *def, int engines, const firsts *f,
                           pl_ensembles *all)
{
    const int rows = def->setting_count + 1 + (def->references ? 1 : 0);
    all->items =
        pl_heap_new((size_t)all->case_count * (size_t)rows * (size_t)engines, sizeof *all->items);
    for (int p = 0; p < all->case_count; ++p) {
        for (int row = 0; row < rows; ++row) {
            const bool reference = row > def->setting_count;
            for (int e = 0; e < engines; ++e) {
                const pl_ensemble added = {.test_case = p,
                                           .setting = reference ? 0 : row,
                                           .reference = reference,
                                           .configuration = reference ? engines + e : e};
                add_ensemble(def, f, added, row, all);
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
                    /* NOLINTNEXTLINE(clang-analyzer-core.*): add_ensemble sets e->cases */
                    pl_plan_add_pairing(plan, e->cases[k], e->configuration);
                }
            }
        }
    }
}

pl_status pl_members_plan(const pl_members_def *def, pl_plan *plan, pl_ensembles *ensembles,
                          pl_error *error)
{
    const int engines = plan->configuration_count;
    firsts f = {.members = def->members};
    *ensembles = (pl_ensembles){.members = def->members};
    f.index = pl_heap_new(((size_t)def->setting_count + 2) * (size_t)def->members, sizeof *f.index);
    pl_status status = add_cases(def, plan, &f, &ensembles->case_count, error);
    if (status == PL_OK && def->references && ensembles->case_count > 0) {
        status = add_references(plan, engines, 0, error);
    }
    if (status == PL_OK) {
        list_ensembles(def, engines, &f, ensembles);
        pair_up(ensembles, plan);
    }
    free(f.index);
    return status;
}

void pl_ensembles_free(pl_ensembles *ensembles)
{
    for (int i = 0; i < ensembles->count; ++i) {
        free(ensembles->items[i].cases);
    }
    free(ensembles->items);
    *ensembles = (pl_ensembles){.count = 0};
}

json_t *pl_member_runs(const pl_plan *plan, const pl_ensemble *ensemble, int members)
{
    json_t *runs = json_array();
    for (int k = 0; k < members; ++k) {
        const pl_planned_run planned = {.test_case = &plan->cases[ensemble->cases[k]],
                                        .configuration =
                                            &plan->configurations[ensemble->configuration]};
        char run[17];
        pl_planned_run_hash(plan, &planned, run);
        json_array_append_new(runs, json_string(run));
    }
    return runs;
}
