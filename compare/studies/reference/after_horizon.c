/* Ensembles of the engines, for where the reference has lost its meaning. */
#include "adapters/built_in.h"
#include "base/heap.h"
#include "plumb/jitter.h"
#include "reference_verdict.h"
#include "studies/ensemble/sample.h"
#include "studies/ensemble/two_sample.h"
#include "studies/ensemble/verdict.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Ensembles are made where a run at the asked step takes no more steps times bodies. */
static const double most_member_work = 2.5e4;

/* Chances are found of the largest differences; the others count as p = 1. */
enum { MOST_TESTS = 60 };

/* ---- Runs ---- */

/* The members of several engines. */
typedef struct crowd {
    pl_plan plan; /* a case a member; the engines are the configurations */
    json_t *runs; /* of each engine an array: the hashes of its members' runs */
} crowd;

/* Runs the members of the plan's configurations, at the step divided by `refinement`. Returns whether the work goes
 * on. */
static bool run_crowd(pl_reference_work *work, crowd *c, int refinement)
{
    const pl_case *original = work->original;
    json_t *study = json_pack("{s:s}", "name", "reference");
    c->plan.study = study;
    for (int k = 0; k < PL_REFERENCE_MEMBERS && work->status == PL_OK; ++k) {
        c->plan.variation =
            (pl_variation){.is_member = true, .member = k, .refinement = refinement};
        work->status =
            pl_plan_add_values(&c->plan, original->descriptor, original->params, NULL, work->error);
    }
    json_decref(study);
    for (int i = 0; i < c->plan.configuration_count; ++i) {
        json_t *runs = json_array();
        for (int k = 0; k < c->plan.case_count; ++k) {
            char run[17];
            pl_reference_hash(&c->plan, &c->plan.cases[k], &c->plan.configurations[i], run);
            json_array_append_new(runs, json_string(run));
        }
        json_array_append_new(c->runs, runs);
    }
    return pl_reference_run(work, &c->plan, 0);
}

/* ---- Tests ---- */

/* Where a body (index in the scene) ends along an axis, in the members that ran to their end. Returns
 * how many they are. */
static int ends_of(const pl_reference_work *work, const crowd *c, int engine, int body, int axis,
                   double ends[PL_REFERENCE_MEMBERS])
{
    int count = 0;
    size_t index;
    const json_t *run;
    json_array_foreach(json_array_get(c->runs, (size_t)engine), index, run)
    {
        const json_t *result = pl_reference_result(work, json_string_value(run));
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
static pl_pool pool_ends(const pl_reference_work *work, const crowd *own, const crowd *others,
                         const pl_end_test *test, int scene_body)
{
    double a[PL_REFERENCE_MEMBERS], b[PL_REFERENCE_MEMBERS];
    const int count_a = ends_of(work, own, 0, scene_body, test->axis, a);
    const int count_b = ends_of(work, others, test->engine, scene_body, test->axis, b);
    return count_a < 2 || count_b < 2 ? (pl_pool){.count = 0}
                                      : pl_pool_make(a, count_a, b, count_b);
}

static int by_ks(const void *a, const void *b)
{
    const pl_end_test *s = a, *t = b;
    return (s->ks < t->ks) - (s->ks > t->ks);
}

/* Sets the chance of each difference, and puts the tests in the order of decreasing differences. */
static void find_chances(pl_after_horizon *after)
{
    const size_t count = (size_t)after->test_count;
    double *p = pl_heap_new(count, sizeof *p), *corrected = pl_heap_new(count, sizeof *corrected);
    qsort(after->tests, count, sizeof *after->tests, by_ks);
    for (int i = 0; i < after->test_count; ++i) {
        p[i] = i < MOST_TESTS ? pl_permutation_p(&after->tests[i].ends) : 1;
    }
    pl_holm(p, after->test_count, corrected);
    for (int i = 0; i < after->test_count; ++i) {
        after->tests[i].p = p[i];
        after->tests[i].corrected = corrected[i];
    }
    free(p);
    free(corrected);
}

static void test_ends(const pl_reference_work *work, const crowd *own, const crowd *others,
                      const pl_reference *reference, pl_after_horizon *after)
{
    for (int e = 0; e < others->plan.configuration_count; ++e) {
        for (int k = 0; k < 3 * reference->bodies; ++k) {
            pl_end_test t = {.engine = e, .body = k / 3, .axis = k % 3};
            if (reference->horizon[k / 3] < reference->samples) {
                t.ends = pool_ends(work, own, others, &t, reference->body[k / 3]);
            }
            if (t.ends.count > 0) {
                t.ks = pl_kolmogorov_smirnov(&t.ends);
                pl_push(&after->tests, &after->test_count, &t, sizeof t);
            }
        }
    }
    if (after->test_count > 0) {
        find_chances(after);
    }
}

/* ---- The whole ---- */

/* Whether the members of the reference part. */
static void find_parting(const pl_reference_work *work, const crowd *own, pl_after_horizon *after)
{
    const double size = pl_scene_least_size(&own->plan.cases[0].scene);
    json_t *horizon =
        pl_horizon_find(work->execution.positions, json_array_get(own->runs, 0), size);
    const json_t *time = json_object_get(horizon, "time");
    if (json_is_number(time)) {
        after->parted = json_number_value(time);
        after->chaotic = true;
    }
    json_decref(horizon);
}

static void compare_crowds(pl_reference_work *work, pl_reference_verdict *v)
{
    const pl_plan *plan = work->execution.plan;
    crowd own = {pl_reference_plan(work), json_array()},
          others = {pl_reference_plan(work), json_array()};
    work->status = pl_plan_add_engine(&own.plan, pl_reference_engine, work->error);
    if (run_crowd(work, &own, PL_REFERENCE_MEMBER_REFINEMENT)) {
        v->after.made = true;
        find_parting(work, &own, &v->after);
    }
    for (int i = 0; i < plan->configuration_count; ++i) {
        pl_plan_add_choice(&others.plan, &plan->configurations[i].choice,
                           plan->configurations[i].label);
    }
    if (v->after.chaotic && run_crowd(work, &others, 0)) {
        test_ends(work, &own, &others, v->reference, &v->after);
    }
    json_decref(own.runs);
    json_decref(others.runs);
    pl_plan_free(&own.plan);
    pl_plan_free(&others.plan);
}

void pl_after_horizon_make(pl_reference_work *work, pl_reference_verdict *v)
{
    const pl_reference *reference = v->reference;
    const double steps = (double)pl_scene_steps(&work->original->scene) * (double)reference->bodies;
    pl_after_horizon *after = &v->after;
    *after = (pl_after_horizon){.from = reference->samples, .parted = (double)NAN};
    for (int b = 0; b < reference->bodies; ++b) {
        after->from = reference->horizon[b] < after->from ? reference->horizon[b] : after->from;
    }
    if (after->from < reference->samples && steps > most_member_work) {
        snprintf(
            after->reason, sizeof after->reason,
            "an ensemble would take more than %.0f steps times bodies a member: plumb ensemble "
            "makes it",
            most_member_work);
    } else if (after->from < reference->samples) {
        compare_crowds(work, v);
    }
}

/* ---- Sentences ---- */

enum { MOST_NAMES = 3 };

/* "box b", "box b and ball", "a, b, c and 4 more bodies". The caller frees. */
static char *names_of(const pl_reference_verdict *v, const bool *wanted)
{
    pl_text_buffer text = {0};
    int count = 0, named = 0;
    for (int b = 0; b < v->reference->bodies; ++b) {
        count += wanted[b];
    }
    for (int b = 0; b < v->reference->bodies && named < MOST_NAMES; ++b) {
        if (wanted[b]) {
            const char *before = named == 0 ? "" : named + 1 == count ? " and " : ", ";
            pl_text_format(&text, "%s%s", before,
                           v->test_case->scene.bodies[v->reference->body[b]].name);
            named += 1;
        }
    }
    if (count > named) {
        pl_text_format(&text, " and %d more %s", count - named,
                       count - named == 1 ? "body" : "bodies");
    }
    return pl_text_take(&text);
}

/* "bullet:si differs in where box b ends (p = 0.003)"; NULL: the engine does not differ. The caller frees. */
static char *difference_of(const pl_reference_verdict *v, int engine)
{
    bool *wanted = pl_heap_new((size_t)v->reference->bodies, sizeof *wanted);
    double least = 1;
    int bodies = 0;
    for (int i = 0; i < v->after.test_count; ++i) {
        const pl_end_test *t = &v->after.tests[i];
        if (t->engine == engine && t->corrected < pl_significance) {
            bodies += !wanted[t->body];
            wanted[t->body] = true;
            least = fmin(least, t->corrected);
        }
    }
    char *names = names_of(v, wanted);
    char *text = bodies == 0 ? NULL
                             : pl_heap_format("%s differs in where %s end%s (p = %.1g)",
                                              v->engines[engine].label, names,
                                              bodies == 1 ? "s" : "", least);
    free(names);
    free(wanted);
    return text;
}

/* " of box b and ball": the bodies that have a horizon, where others have none. The caller frees. */
static char *affected_of(const pl_reference_verdict *v)
{
    bool *wanted = pl_heap_new((size_t)v->reference->bodies, sizeof *wanted);
    int affected = 0;
    for (int b = 0; b < v->reference->bodies; ++b) {
        wanted[b] = v->reference->horizon[b] < v->reference->samples;
        affected += wanted[b];
    }
    char *names = names_of(v, wanted);
    char *text =
        affected < v->reference->bodies ? pl_heap_format(" of %s", names) : pl_heap_copy("");
    free(names);
    free(wanted);
    return text;
}

/* A sentence for each engine that differs. The first begins with the bodies whose motion is chaotic, and from when on. */
static void say_ensembles(const pl_reference_verdict *v, const char *affected, double from,
                          json_t *sentences)
{
    char *beginning =
        pl_heap_format("The motion%s is chaotic from t = %.2g s on; as ensembles of %d members, ",
                       affected, from, PL_REFERENCE_MEMBERS);
    const size_t before = json_array_size(sentences);
    for (int e = 0; e < v->engine_count; ++e) {
        char *difference = difference_of(v, e);
        if (difference != NULL) {
            pl_sentence_add(sentences, "%s%s",
                            json_array_size(sentences) == before ? beginning : "As ensembles, ",
                            difference);
        }
        free(difference);
    }
    if (json_array_size(sentences) == before) {
        pl_sentence_add(sentences, "%sno engine differs from the reference in where a body ends",
                        beginning);
    }
    free(beginning);
}

void pl_after_horizon_sentences(const pl_reference_verdict *v, json_t *sentences)
{
    const pl_after_horizon *after = &v->after;
    const double from = (double)after->from * v->reference->interval;
    char *affected = affected_of(v);
    if (after->chaotic) {
        say_ensembles(v, affected, from, sentences);
    } else if (after->from < v->reference->samples) {
        pl_sentence_add(sentences,
                        "The reference%s has not converged from t = %.2g s on, and no engine is "
                        "judged there%s%s",
                        affected, from, after->made ? "" : ": ", after->reason);
    }
    free(affected);
}
