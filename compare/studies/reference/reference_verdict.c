#include "reference_verdict.h"

#include "adapters/built_in.h"
#include "base/heap.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More bodies of an engine than this are reported in one sentence, and of all single bodies the
 * farthest only. */
enum { MOST_SINGLE_BODIES = 4, MOST_SINGLE_SENTENCES = 10 };

/* Others that are no farther from the reference than this share of a distance are where it is: they
 * are then "the others" that it is a distance from. */
static const double negligible_share = 0.1;

/* ---- Numbers ---- */

pl_body_verdict pl_body_judge(const pl_reference *reference, const pl_body_paths *paths, int body)
{
    const pl_body_paths *own = pl_reference_paths(reference);
    pl_body_verdict verdict = {
        .final = (double)NAN, .largest = 0, .differs_from = (double)NAN, .strays_at = (double)NAN};
    long judged = paths->samples < reference->samples ? paths->samples : reference->samples;
    judged = judged < reference->horizon[body] ? judged : reference->horizon[body];
    long from = judged;
    for (long i = 0; i < judged; ++i) {
        const double error = reference->allowance[i * reference->bodies + body];
        const double allowed = fmax(reference->bounds[body], pl_reference_safety * error);
        verdict.final = pl_body_paths_distance(own, paths, body, i);
        verdict.largest = fmax(verdict.largest, verdict.final);
        verdict.until = (double)i * reference->interval;
        if (!(verdict.final > allowed)) {
            from = judged;
            continue;
        }
        from = from == judged ? i : from;
        if (verdict.final > verdict.stray) {
            verdict.stray = verdict.final;
            verdict.strays_at = verdict.until;
        }
    }
    if (from < judged) {
        verdict.differs_from = (double)from * reference->interval;
        verdict.stray = 0;
        verdict.strays_at = (double)NAN;
    }
    for (int k = 0; k < 3 && judged > 0 && paths->moved != NULL; ++k) {
        const size_t at = ((size_t)(judged - 1) * (size_t)own->bodies + (size_t)body) * 3;
        verdict.off[k] = paths->moved[at + (size_t)k] - own->moved[at + (size_t)k];
    }
    return verdict;
}

static void judge_engine(const pl_reference_work *work, const pl_configuration *configuration,
                         const pl_reference *reference, pl_engine_verdict *verdict)
{
    verdict->label = configuration->label;
    pl_engine_family(configuration->choice.engine->name, verdict->family);
    pl_reference_hash(work->execution.plan, work->original, configuration, verdict->run);
    pl_body_paths paths = pl_body_paths_read(work->execution.positions, verdict->run,
                                             &work->original->scene, reference->stride);
    if (paths.samples > 0) {
        verdict->completed = paths.completed;
        verdict->bodies = pl_heap_new((size_t)reference->bodies, sizeof *verdict->bodies);
    }
    for (int b = 0; b < reference->bodies && verdict->bodies != NULL; ++b) {
        verdict->bodies[b] = pl_body_judge(reference, &paths, b);
        verdict->differing += !isnan(verdict->bodies[b].differs_from);
        verdict->straying += !isnan(verdict->bodies[b].strays_at);
    }
    const json_t *result = pl_reference_result(work, verdict->run);
    verdict->is_unsupported =
        pl_outcome_named(pl_json_get_text(result, "outcome")) == PL_OUTCOME_UNSUPPORTED;
    pl_body_paths_free(&paths);
}

pl_reference_verdict pl_reference_judge(const pl_reference_work *work,
                                        const pl_reference *reference)
{
    const pl_plan *plan = work->execution.plan;
    pl_reference_verdict verdict = {.reference = reference,
                                    .test_case = work->original,
                                    .engine_count = plan->configuration_count};
    verdict.engines = pl_heap_new((size_t)verdict.engine_count, sizeof *verdict.engines);
    for (int i = 0; i < verdict.engine_count; ++i) {
        judge_engine(work, &plan->configurations[i], reference, &verdict.engines[i]);
    }
    return verdict;
}

void pl_reference_verdict_free(pl_reference_verdict *verdict)
{
    for (int i = 0; i < verdict->engine_count; ++i) {
        free(verdict->engines[i].bodies);
    }
    for (int i = 0; i < verdict->after.test_count; ++i) {
        pl_pool_free(&verdict->after.tests[i].ends);
    }
    free(verdict->engines);
    free(verdict->after.tests);
}

/* ---- Contradictions ---- */

/* Whether an engine of another family than the reference's ran to its end and differs in the body. */
static bool is_other(const pl_reference_verdict *v, int engine, int body)
{
    const pl_engine_verdict *e = &v->engines[engine];
    char own[PL_FAMILY_SIZE];
    pl_engine_family(pl_reference_engine, own);
    return e->bodies != NULL && e->completed && !isnan(e->bodies[body].differs_from) &&
           strcmp(e->family, own) != 0;
}

/* How far apart two engines end in the body, m. */
static double apart(const pl_body_verdict *a, const pl_body_verdict *b)
{
    return hypot(hypot(a->off[0] - b->off[0], a->off[1] - b->off[1]), a->off[2] - b->off[2]);
}

/* Whether an engine of another family converges to the same answer. */
static bool is_confirmed(const pl_reference *reference)
{
    return reference->second > 0 && reference->disputed == 0 && reference->unconfirmed == 0;
}

bool pl_reference_is_contradicted(const pl_reference_verdict *v, int body, int *one, int *other)
{
    for (int i = 0; i < v->engine_count && !is_confirmed(v->reference); ++i) {
        for (int j = i + 1; j < v->engine_count && is_other(v, i, body); ++j) {
            if (!is_other(v, j, body) || strcmp(v->engines[i].family, v->engines[j].family) == 0) {
                continue;
            }
            const pl_body_verdict *a = &v->engines[i].bodies[body],
                                  *b = &v->engines[j].bodies[body];
            const double near = negligible_share * fmin(a->final, b->final);
            if (apart(a, b) <= fmax(v->reference->bounds[body], near)) {
                if (one != NULL && other != NULL) {
                    *one = i;
                    *other = j;
                }
                return true;
            }
        }
    }
    return false;
}

/* The number of bodies in which engines of other families contradict the reference. *first: one. */
static int count_contradicted(const pl_reference_verdict *v, int *first)
{
    int count = 0;
    for (int b = v->reference->bodies - 1; b >= 0; --b) {
        if (pl_reference_is_contradicted(v, b, NULL, NULL)) {
            count += 1;
            *first = b;
        }
    }
    return count;
}

/* ---- Sentences ---- */

void pl_sentence_add(json_t *sentences, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *text = pl_heap_format_list(format, arguments);
    va_end(arguments);
    json_array_append_new(sentences, pl_json_text(text));
    free(text);
}

static const char *body_name(const pl_reference_verdict *v, int body)
{
    return v->test_case->scene.bodies[v->reference->body[body]].name;
}

/* The finest step of an engine, s. */
static double last_step(const pl_reference *reference, const pl_reference_runs *runs)
{
    return reference->dt / (1 << (runs->count - 1));
}

/* Who contradicts the reference. Nobody is judged by it then. */
static void say_contradiction(const pl_reference_verdict *v, json_t *sentences)
{
    const pl_reference *reference = v->reference;
    int body = 0, one = 0, other = 0;
    char more[64] = "";
    const int count = count_contradicted(v, &body);
    pl_reference_is_contradicted(v, body, &one, &other);
    const pl_body_verdict *a = &v->engines[one].bodies[body], *b = &v->engines[other].bodies[body];
    if (count > 1) {
        snprintf(more, sizeof more, "; so it is with %d bodies in all", count);
    }
    pl_sentence_add(
        sentences,
        "%s: %s and %s, which share no code, end %.2g m from each other and %.3g m from "
        "the reference, which is %s at a step of %.3g s%s. The reference may be wrong: it has no "
        "error estimate, and no engine is judged by it",
        body_name(v, body), v->engines[one].label, v->engines[other].label, apart(a, b),
        fmin(a->final, b->final), reference->engines[0].label,
        last_step(reference, &reference->engines[0]), more);
}

/* Adds whether a second engine confirms the reference. */
static void say_second(const pl_reference_verdict *v, pl_text_buffer *text)
{
    const pl_reference *reference = v->reference;
    const pl_reference_runs *second = &reference->engines[reference->second];
    if (reference->second == 0) {
        pl_text_add(text, "; no other engine confirms it");
    } else if (reference->disputed == 0) {
        pl_text_format(text, "; %s at %.3g s %s %.2g m%s", second->label,
                       last_step(reference, second),
                       reference->unconfirmed == 0 ? "confirms it to within" : "stays within",
                       reference->confirmed,
                       reference->unconfirmed == 0
                           ? ""
                           : " of it but has not converged itself, so that nothing confirms it");
    }
}

/* Where the reference comes from, and what confirms it. */
static void say_reference(const pl_reference_verdict *v, json_t *sentences)
{
    const pl_reference *reference = v->reference;
    const pl_reference_runs *own = &reference->engines[0];
    const pl_reference_runs *second = &reference->engines[reference->second];
    pl_text_buffer confirmation = {0};
    double largest = 0;
    for (int b = 0; b < reference->bodies; ++b) {
        for (long i = 0; i < reference->horizon[b]; ++i) {
            largest = fmax(largest, reference->error[i * reference->bodies + b]);
        }
    }
    say_second(v, &confirmation);
    char *text = pl_text_take(&confirmation);
    pl_sentence_add(
        sentences,
        "The reference is %s at a step of %.3g s, with an estimated error of up to %.2g m%s",
        own->label, last_step(reference, own), largest, text);
    free(text);
    if (reference->disputed > 0) {
        const int body = reference->most_disputed;
        pl_sentence_add(sentences,
                        "%s and %s converge to different answers: %s ends %.3g m apart; what lies "
                        "within three times their distance is not judged",
                        own->label, second->label, body_name(v, body),
                        pl_body_paths_distance(pl_reference_paths(reference),
                                               &second->levels[second->count - 1], body,
                                               reference->horizon[body] - 1));
    }
}

/* Whether at least one other configuration ran to its end, and all of them are near the reference in
 * the body, compared with this one. */
static bool others_agree(const pl_reference_verdict *v, int engine, int body)
{
    /* NOLINTNEXTLINE(clang-analyzer-core.*): an engine without bodies has none that differs */
    const double distance = v->engines[engine].bodies[body].final;
    int others = 0;
    for (int i = 0; i < v->engine_count; ++i) {
        const pl_engine_verdict *e = &v->engines[i];
        if (i != engine && e->bodies != NULL && e->completed) {
            others += 1;
            if (!(e->bodies[body].final <= negligible_share * distance)) {
                return false;
            }
        }
    }
    return others > 0;
}

/* "box b: bullet:si ends 1.34 m away from the others, from t = 1.3 s on" */
static void say_body(const pl_reference_verdict *v, int engine, int body, json_t *sentences)
{
    const pl_engine_verdict *e = &v->engines[engine];
    const pl_body_verdict *b = &e->bodies[body];
    const bool to_end = e->completed && v->reference->horizon[body] >= v->reference->samples;
    char when[32] = "";
    if (!to_end) {
        snprintf(when, sizeof when, " at t = %.3g s", b->until);
    }
    pl_sentence_add(sentences, "%s: %s %s %.3g m away from %s%s, from t = %.2g s on",
                    body_name(v, body), e->label, to_end ? "ends" : "is", b->final,
                    others_agree(v, engine, body) ? "the others" : "the reference", when,
                    b->differs_from);
}

/* The same of many bodies at once. */
static void say_bodies(const pl_reference_verdict *v, int engine, json_t *sentences)
{
    const pl_engine_verdict *e = &v->engines[engine];
    int first = -1, worst = -1;
    for (int b = 0; b < v->reference->bodies; ++b) {
        if (!isnan(e->bodies[b].differs_from)) {
            first =
                first < 0 || e->bodies[b].differs_from < e->bodies[first].differs_from ? b : first;
            worst = worst < 0 || e->bodies[b].final > e->bodies[worst].final ? b : worst;
        }
    }
    pl_sentence_add(sentences,
                    "%d of %d bodies: %s differs from the reference, most of all in %s, by %.3g m, "
                    "and first in %s, from t = %.2g s on",
                    e->differing, v->reference->bodies, e->label, body_name(v, worst),
                    e->bodies[worst].final, body_name(v, first), e->bodies[first].differs_from);
}

/* A body of an engine that differs. */
typedef struct difference {
    double final; /* m */
    int engine, body;
} difference;

static int by_final(const void *a, const void *b)
{
    const difference *x = a, *y = b;
    return (x->final < y->final) - (x->final > y->final);
}

/* A sentence for each engine with many such bodies, then one for each body of the others, the farthest
 * first. */
static void say_differences(const pl_reference_verdict *v, json_t *sentences)
{
    const size_t most = (size_t)v->engine_count * MOST_SINGLE_BODIES;
    difference *single = pl_heap_new(most, sizeof *single);
    size_t count = 0;
    for (int i = 0; i < v->engine_count; ++i) {
        const pl_engine_verdict *e = &v->engines[i];
        if (e->bodies == NULL) {
            continue;
        }
        if (e->differing > MOST_SINGLE_BODIES) {
            say_bodies(v, i, sentences);
            continue;
        }
        for (int b = 0; b < v->reference->bodies; ++b) {
            if (!isnan(e->bodies[b].differs_from)) {
                single[count++] = (difference){e->bodies[b].final, i, b};
            }
        }
    }
    qsort(single, count, sizeof *single, by_final);
    for (size_t i = 0; i < count && i < MOST_SINGLE_SENTENCES; ++i) {
        say_body(v, single[i].engine, single[i].body, sentences);
    }
    if (count > MOST_SINGLE_SENTENCES) {
        const size_t left = count - MOST_SINGLE_SENTENCES;
        pl_sentence_add(sentences, "%zu more %s, by %.3g m at most", left,
                        left == 1 ? "body of an engine differs" : "bodies of engines differ",
                        single[MOST_SINGLE_SENTENCES].final);
    }
    free(single);
}

/* The engines that leave the reference for a while. */
static void say_strays(const pl_reference_verdict *v, json_t *sentences)
{
    for (int i = 0; i < v->engine_count; ++i) {
        const pl_engine_verdict *e = &v->engines[i];
        int worst = -1;
        for (int b = 0; b < v->reference->bodies && e->straying > 0; ++b) {
            worst = !isnan(e->bodies[b].strays_at) &&
                            (worst < 0 || e->bodies[b].stray > e->bodies[worst].stray)
                        ? b
                        : worst;
        }
        if (worst >= 0) {
            char more[64] = "";
            if (e->straying > 1) {
                snprintf(more, sizeof more, "; so are %d bodies in all", e->straying);
            }
            pl_sentence_add(sentences,
                            "%s: %s is up to %.3g m away from the reference, at t = %.3g s, "
                            "and near it again at the end%s",
                            body_name(v, worst), e->label, e->bodies[worst].stray,
                            e->bodies[worst].strays_at, more);
        }
    }
}

/* The engines that could not be compared, or not to the end. */
static void say_missing(const pl_reference_verdict *v, json_t *sentences)
{
    for (int i = 0; i < v->engine_count; ++i) {
        const pl_engine_verdict *e = &v->engines[i];
        if (e->bodies == NULL || !e->completed) {
            pl_sentence_add(sentences, "%s is %s", e->label,
                            e->is_unsupported ? "not compared: it does not support the scene"
                            : e->bodies == NULL
                                ? "not compared, because it left no path"
                                : "compared only until its run ended, before the end of the scene");
        }
    }
}

/* "All engines agree with the reference to within X m", or which of them do. */
static void say_agreement(const pl_reference_verdict *v, json_t *sentences)
{
    pl_text_buffer names = {0};
    double largest = 0;
    int agreeing = 0;
    const bool whole = v->after.from == v->reference->samples;
    for (int i = 0; i < v->engine_count; ++i) {
        const pl_engine_verdict *e = &v->engines[i];
        if (e->bodies != NULL && e->completed && e->differing == 0 && e->straying == 0) {
            pl_text_format(&names, "%s%s", agreeing == 0 ? "" : ", ", e->label);
            agreeing += 1;
            for (int b = 0; b < v->reference->bodies; ++b) {
                largest = fmax(largest, e->bodies[b].largest);
            }
        }
    }
    char *who = pl_text_take(&names);
    if (agreeing > 0) {
        pl_sentence_add(sentences, "%s agree%s with the reference to within %.2g m%s",
                        agreeing == v->engine_count && agreeing > 1 ? "All engines" : who,
                        agreeing == 1 ? "s" : "", largest,
                        whole ? "" : " as long as the motion can be predicted");
    }
    free(who);
}

void pl_reference_sentences(const pl_reference_verdict *verdict, json_t *sentences)
{
    int first = 0;
    if (count_contradicted(verdict, &first) > 0) {
        say_contradiction(verdict, sentences);
        say_missing(verdict, sentences);
        return;
    }
    say_differences(verdict, sentences);
    say_strays(verdict, sentences);
    say_missing(verdict, sentences);
    say_agreement(verdict, sentences);
    say_reference(verdict, sentences);
}
