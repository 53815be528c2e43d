#include "after_horizon.h"

#include "base/heap.h"
#include "plumb/jitter.h"
#include "studies/ensemble/sample.h"
#include "studies/ensemble/two_sample.h"
#include "studies/ensemble/verdict.h"

#include <math.h>
#include <stdlib.h>

const double pl_reference_most_member_work = 2.5e4;

/* ---- Runs ---- */

/* The members of several engines, with their results. */
typedef struct crowd {
    const pl_case *original;
    int refinement;
    pl_plan plan;
    pl_ensembles ensembles;
    json_t *runs;    /* of each ensemble an array of hashes */
    json_t *results; /* by the hashes of their runs */
} crowd;

static pl_status add_case(void *user, int setting, pl_plan *plan, pl_error *error)
{
    const crowd *c = user;
    (void)setting;
    plan->variation.refinement = c->refinement;
    return pl_plan_add_values(plan, c->original->descriptor, c->original->params, NULL, error);
}

static pl_status keep_result(void *user, json_t *result, pl_error *error)
{
    (void)error;
    json_object_set(user, pl_json_get_text(result, "run"), result);
    return PL_OK;
}

/* Plans and runs the members of the plan's configurations. */
static pl_status run_crowd(const pl_reference_def *def, crowd *c, int *signal_number,
                           pl_error *error)
{
    const pl_members_def members = {.members = PL_REFERENCE_MEMBERS, .user = c, .add = add_case};
    c->runs = json_array();
    c->results = json_object();
    c->plan.seed = def->execution.plan->seed;
    c->plan.study = def->study;
    const pl_status status = pl_members_plan(&members, &c->plan, &c->ensembles, error);
    if (status != PL_OK) {
        return status;
    }
    pl_execution_def execution = def->execution;
    execution.plan = &c->plan;
    execution.needs_positions = true;
    execution.user = c->results;
    execution.take = keep_result;
    if (execution.bar != NULL) {
        execution.bar->total += pl_plan_size(&c->plan);
    }
    for (int i = 0; i < c->ensembles.count; ++i) {
        json_array_append_new(c->runs,
                              pl_member_runs(&c->plan, &c->ensembles, &c->ensembles.items[i]));
    }
    return pl_execute(&execution, signal_number, error);
}

static void free_crowd(crowd *c)
{
    json_decref(c->runs);
    json_decref(c->results);
    free(c->ensembles.items);
    pl_plan_free(&c->plan);
}

/* ---- Tests ---- */

/* Where a body (index in the scene) ends along an axis, in the members that ran to their end. Returns
 * how many they are. */
static int ends_of(const crowd *c, int ensemble, int body, int axis,
                   double ends[PL_REFERENCE_MEMBERS])
{
    int count = 0;
    size_t index;
    const json_t *run;
    json_array_foreach(json_array_get(c->runs, (size_t)ensemble), index, run)
    {
        const json_t *result = json_object_get(c->results, json_string_value(run));
        const json_t *steps = json_object_get(result, "steps");
        const json_t *pose = json_array_get(json_object_get(result, "final_poses"), (size_t)body);
        if (json_is_array(pose) &&
            json_equal(json_object_get(steps, "asked"), json_object_get(steps, "done"))) {
            ends[count++] = json_number_value(json_array_get(pose, (size_t)axis));
        }
    }
    return count;
}

/* Pools the ends of the reference's members and of an engine's. Fewer than two on a side leave the
 * pool empty. */
static pl_pool pool_ends(const crowd *own, const crowd *others, const pl_end_test *test,
                         int scene_body)
{
    double a[PL_REFERENCE_MEMBERS], b[PL_REFERENCE_MEMBERS];
    const int count_a = ends_of(own, 0, scene_body, test->axis, a);
    const int count_b = ends_of(others, test->engine, scene_body, test->axis, b);
    return count_a < 2 || count_b < 2 ? (pl_pool){.count = 0}
                                      : pl_pool_make(a, count_a, b, count_b);
}

static int by_ks(const void *a, const void *b)
{
    const pl_end_test *s = a, *t = b;
    return (s->ks < t->ks) - (s->ks > t->ks);
}

/* The chance of each difference; the tests come in the order of decreasing differences. */
static void find_chances(const crowd *own, const crowd *others, const pl_reference *reference,
                         pl_after_horizon *after)
{
    const size_t count = (size_t)after->test_count;
    double *p = pl_heap_new(count, sizeof *p), *corrected = pl_heap_new(count, sizeof *corrected);
    qsort(after->tests, (size_t)after->test_count, sizeof *after->tests, by_ks);
    for (int i = 0; i < after->test_count; ++i) {
        pl_end_test *test = &after->tests[i];
        test->p = 1;
        if (i < PL_REFERENCE_MOST_TESTS) {
            pl_pool pool = pool_ends(own, others, test, reference->body[test->body]);
            test->p = pl_permutation_p(&pool);
            pl_pool_free(&pool);
        }
        p[i] = test->p;
    }
    pl_holm(p, after->test_count, corrected);
    for (int i = 0; i < after->test_count; ++i) {
        after->tests[i].corrected = corrected[i];
    }
    free(p);
    free(corrected);
}

static void test_ends(const crowd *own, const crowd *others, const pl_reference *reference,
                      pl_after_horizon *after)
{
    after->tests = pl_heap_new(3 * (size_t)reference->bodies * (size_t)others->ensembles.count,
                               sizeof *after->tests);
    for (int e = 0; e < others->ensembles.count; ++e) {
        for (int k = 0; k < 3 * reference->bodies; ++k) {
            pl_end_test test = {.engine = e, .body = k / 3, .axis = k % 3};
            pl_pool pool = {.count = 0};
            if (reference->horizon[test.body] < reference->samples) {
                pool = pool_ends(own, others, &test, reference->body[test.body]);
            }
            if (pool.count > 0) {
                test.ks = pl_kolmogorov_smirnov(&pool);
                after->tests[after->test_count++] = test;
            }
            pl_pool_free(&pool);
        }
    }
    find_chances(own, others, reference, after);
}

/* ---- The whole ---- */

/* Whether the members of the reference part. */
static void find_parting(const crowd *own, const char *folder, pl_after_horizon *after)
{
    const pl_case *first = &own->plan.cases[own->ensembles.items[0].first];
    json_t *horizon =
        pl_horizon_find(folder, json_array_get(own->runs, 0), pl_scene_least_size(&first->scene));
    const json_t *time = json_object_get(horizon, "time");
    if (json_is_number(time)) {
        after->parted = json_number_value(time);
        after->chaotic = true;
    }
    json_decref(horizon);
}

static pl_status compare_crowds(const pl_reference_def *def, const pl_reference_verdict *verdict,
                                pl_after_horizon *after, int *signal_number, pl_error *error)
{
    const pl_plan *plan = def->execution.plan;
    crowd own = {.original = def->original,
                 .refinement = PL_REFERENCE_MEMBER_REFINEMENT,
                 .plan = {.repeats = 1}};
    crowd others = {.original = def->original, .plan = {.repeats = 1}};
    pl_status status = pl_plan_add_engine(&own.plan, pl_reference_engine, error);
    if (status == PL_OK) {
        status = run_crowd(def, &own, signal_number, error);
    }
    if (status == PL_OK && *signal_number == 0) {
        after->made = true;
        find_parting(&own, def->execution.positions, after);
    }
    for (int i = 0; i < plan->configuration_count; ++i) {
        pl_plan_add_choice(&others.plan, &plan->configurations[i].choice,
                           plan->configurations[i].label);
    }
    if (status == PL_OK && *signal_number == 0 && after->chaotic) {
        status = run_crowd(def, &others, signal_number, error);
        if (status == PL_OK && *signal_number == 0) {
            test_ends(&own, &others, verdict->reference, after);
        }
    }
    free_crowd(&own);
    free_crowd(&others);
    return status;
}

pl_status pl_after_horizon_make(const pl_reference_def *def, const pl_reference_verdict *verdict,
                                pl_after_horizon *after, int *signal_number, pl_error *error)
{
    const pl_reference *reference = verdict->reference;
    const double work = (double)pl_scene_steps(&def->original->scene) * (double)reference->bodies;
    *after = (pl_after_horizon){.from = reference->samples, .parted = (double)NAN};
    *signal_number = 0;
    for (int b = 0; b < reference->bodies; ++b) {
        after->from = reference->horizon[b] < after->from ? reference->horizon[b] : after->from;
    }
    if (after->from == reference->samples) {
        return PL_OK;
    }
    if (work > pl_reference_most_member_work) {
        snprintf(
            after->reason, sizeof after->reason,
            "an ensemble would take more than %.0f steps times bodies a member: plumb ensemble "
            "makes it",
            pl_reference_most_member_work);
        return PL_OK;
    }
    return compare_crowds(def, verdict, after, signal_number, error);
}

void pl_after_horizon_free(pl_after_horizon *after)
{
    free(after->tests);
    *after = (pl_after_horizon){.from = 0};
}

/* ---- Sentences ---- */

enum { MOST_NAMES = 3 };

/* "box b", "box b and ball", "a, b, c and 4 more bodies" */
static void add_names(pl_text_buffer *text, const pl_reference_verdict *v, const bool *wanted)
{
    int count = 0, named = 0;
    for (int b = 0; b < v->reference->bodies; ++b) {
        count += wanted[b];
    }
    for (int b = 0; b < v->reference->bodies && named < MOST_NAMES; ++b) {
        if (wanted[b]) {
            const bool last = named + 1 == count;
            pl_text_format(text, "%s%s",
                           named == 0 ? ""
                           : last     ? " and "
                                      : ", ",
                           v->test_case->scene.bodies[v->reference->body[b]].name);
            named += 1;
        }
    }
    if (count > named) {
        pl_text_format(text, " and %d more %s", count - named,
                       count - named == 1 ? "body" : "bodies");
    }
}

/* "bullet:si differs in where box b ends (p = 0.003)"; false where it does not differ. */
static bool add_difference(pl_text_buffer *text, const pl_reference_verdict *v,
                           const pl_after_horizon *after, int engine, bool *wanted)
{
    double least = 1;
    int bodies = 0;
    for (int b = 0; b < v->reference->bodies; ++b) {
        wanted[b] = false;
    }
    for (int i = 0; i < after->test_count; ++i) {
        const pl_end_test *t = &after->tests[i];
        if (t->engine == engine && t->corrected < pl_significance) {
            bodies += !wanted[t->body];
            wanted[t->body] = true;
            least = fmin(least, t->corrected);
        }
    }
    if (bodies > 0) {
        pl_text_format(text, "%s differs in where ", v->engines[engine].label);
        add_names(text, v, wanted);
        pl_text_format(text, " end%s (p = %.1g)", bodies == 1 ? "s" : "", least);
    }
    return bodies > 0;
}

/* " of box b and ball": the bodies that have a horizon, where others have none. */
static void add_affected(pl_text_buffer *text, const pl_reference_verdict *v, bool *wanted)
{
    int affected = 0;
    for (int b = 0; b < v->reference->bodies; ++b) {
        wanted[b] = v->reference->horizon[b] < v->reference->samples;
        affected += wanted[b];
    }
    if (affected < v->reference->bodies) {
        pl_text_add(text, " of ");
        add_names(text, v, wanted);
    }
}

/* The first words of the first sentence: of which bodies the motion is chaotic, and from when on. */
static void add_beginning(pl_text_buffer *text, const pl_reference_verdict *v,
                          const pl_after_horizon *after, bool *wanted)
{
    pl_text_add(text, "The motion");
    add_affected(text, v, wanted);
    pl_text_format(text, " is chaotic from t = %.2g s on; as ensembles of %d members, ",
                   (double)after->from * v->reference->interval, PL_REFERENCE_MEMBERS);
}

static void say_unconverged(const pl_reference_verdict *v, const pl_after_horizon *after,
                            json_t *sentences, bool *wanted)
{
    pl_text_buffer text = {0};
    pl_text_add(&text, "The reference");
    add_affected(&text, v, wanted);
    pl_text_format(
        &text, " has not converged from t = %.2g s on, and no engine is judged there%s%s",
        (double)after->from * v->reference->interval, after->made ? "" : ": ", after->reason);
    pl_sentence_add(sentences, &text);
}

static void say_ensembles(const pl_reference_verdict *v, const pl_after_horizon *after,
                          json_t *sentences, bool *wanted)
{
    bool begun = false;
    for (int e = 0; e < v->engine_count; ++e) {
        pl_text_buffer text = {0}, difference = {0};
        if (add_difference(&difference, v, after, e, wanted)) {
            if (begun) {
                pl_text_format(&text, "As ensembles, ");
            } else {
                add_beginning(&text, v, after, wanted);
            }
            pl_text_add(&text, difference.data);
            begun = true;
            pl_sentence_add(sentences, &text);
        }
        pl_text_free(&difference);
    }
    if (!begun) {
        pl_text_buffer text = {0};
        add_beginning(&text, v, after, wanted);
        pl_text_add(&text, "no engine differs from the reference in where a body ends");
        pl_sentence_add(sentences, &text);
    }
}

void pl_after_horizon_sentences(const pl_reference_verdict *v, const pl_after_horizon *after,
                                json_t *sentences)
{
    const pl_reference *reference = v->reference;
    if (after->from == reference->samples) {
        return;
    }
    bool *wanted = pl_heap_new((size_t)reference->bodies, sizeof *wanted);
    (after->chaotic ? say_ensembles : say_unconverged)(v, after, sentences, wanted);
    free(wanted);
}
