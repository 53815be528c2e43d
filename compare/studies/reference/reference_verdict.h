/* Which engine configuration differs from a converged reference, in which body, by how much and from
 * when on, as numbers and as sentences. */
#ifndef PLUMB_REFERENCE_VERDICT_H
#define PLUMB_REFERENCE_VERDICT_H

#include "adapters/built_in.h"
#include "base/text_buffer.h"
#include "converged_reference.h"

#include <jansson.h>

/* One body of one configuration against the reference. */
typedef struct pl_body_verdict {
    double final;   /* m: the distance at the last sample that was judged */
    double largest; /* m: the largest distance of all samples that were judged */
    double until;   /* s: of that last sample */
    /* s: of the first sample from which on the body is farther from the reference than the bound and
     * than three times the reference's error, to the last; NAN: it does not differ */
    double differs_from;
    /* Of a body that is beyond that bound for a while, and within it at the end: its largest distance,
     * m, and when, s; 0 and NAN: of others */
    double stray, strays_at;
    double off[3]; /* m: from the reference to the body at the last sample that was judged */
} pl_body_verdict;

/* One engine configuration against the reference. */
typedef struct pl_engine_verdict {
    const char *label;           /* borrowed */
    char run[17];                /* of its result */
    bool completed;              /* its path has the last sample */
    pl_body_verdict *bodies;     /* (bodies); NULL: it left no path */
    int differing;               /* bodies that differ */
    int straying;                /* bodies that are beyond the bound for a while */
    bool is_unsupported;         /* the engine does not support the scene */
    char family[PL_FAMILY_SIZE]; /* of engines that share code */
} pl_engine_verdict;

/* All configurations of a plan against the reference of one of its cases. */
typedef struct pl_reference_verdict {
    const pl_reference *reference;
    const pl_case *test_case;
    pl_engine_verdict *engines; /* (engine_count) */
    int engine_count;
} pl_reference_verdict;

/* Judges a body. `bodies` in `paths` are those of the reference. */
pl_body_verdict pl_body_judge(const pl_reference *reference, const pl_body_paths *paths, int body);

/* Judges the first repeats of a case on all configurations of a plan, whose positions are in
 * `folder`; `results`, an array, says which runs are unsupported. The reference is known. The caller frees
 * the verdict. */
pl_reference_verdict pl_reference_judge(const pl_plan *plan, const pl_case *test_case,
                                        const char *folder, const json_t *results,
                                        const pl_reference *reference);

/* Frees the verdicts. */
void pl_reference_verdict_free(pl_reference_verdict *verdict);

/* Whether engines of two other families than that of the reference differ from it in the body and agree
 * with each other: within the bound of the body, or a tenth of their distance from the reference. Then a
 * reference that no second engine confirms may be wrong. At the scene's own step engines can share an error
 * of that step, so that a confirmed reference is not contradicted. *one and *other (NULL allowed): such
 * engines. */
bool pl_reference_is_contradicted(const pl_reference_verdict *verdict, int body, int *one,
                                  int *other);

/* Appends the sentences to an array of strings: on the reference, on the bodies that differ, and on
 * the engines that agree. */
void pl_reference_sentences(const pl_reference_verdict *verdict, json_t *sentences);

/* Appends a text as a string to an array, and empties it. */
void pl_sentence_add(json_t *sentences, pl_text_buffer *text);

#endif
