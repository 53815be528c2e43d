/* Which engine configuration differs from a converged reference, in which body, by how much and from
 * when on, and what can be said after the reference has lost its meaning; as numbers, sentences and JSON.
 *
 * From the horizon of a body on its motion may be chaotic. Then the engines are compared as ensembles of runs from almost
 * the same start (studies/ensemble). The reference's ensemble runs at a quarter of the step, and is compared with that
 * of each engine configuration at the step that was asked for: for each body without a reference, each coordinate of
 * where it ends, by the permutation test of the energy distance, corrected for all tests (Holm). The motion is chaotic
 * where the reference's members, which start within a ten-thousandth of a body's size, part by more than a hundredth
 * (horizon.h). */
#ifndef PLUMB_REFERENCE_VERDICT_H
#define PLUMB_REFERENCE_VERDICT_H

#include "adapters/built_in.h"
#include "converged_reference.h"
#include "studies/ensemble/two_sample.h"

#include <jansson.h>

enum {
    PL_REFERENCE_MEMBERS = 16,
    PL_REFERENCE_MEMBER_REFINEMENT = 4 /* of the step of the reference's members */
};

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

/* The comparison of one engine configuration with the reference in the end of one body. */
typedef struct pl_end_test {
    int engine, body; /* of the verdict, of the reference */
    int axis;         /* 0 to 2 */
    pl_pool ends;     /* along that axis, of the reference's members and of the engine's; m */
    double ks;        /* Kolmogorov-Smirnov distance, 1 */
    double p, corrected;
} pl_end_test;

/* What is known after the horizon. */
typedef struct pl_after_horizon {
    long
        from; /* the first sample from which on a body has no reference; that of the samples: none is without */
    bool made; /* false: no ensemble was made, and `reason` says why */
    char reason[256];
    bool chaotic;       /* the members of the reference part */
    double parted;      /* s: when they have parted; NAN: they do not, or it is not known */
    pl_end_test *tests; /* (test_count) */
    int test_count;
} pl_after_horizon;

/* All configurations of a plan against the reference of one of its cases. */
typedef struct pl_reference_verdict {
    const pl_reference *reference;
    const pl_case *test_case;
    pl_engine_verdict *engines; /* (engine_count) */
    int engine_count;
    pl_after_horizon after;
} pl_reference_verdict;

/* Judges a body. `bodies` in `paths` are those of the reference. */
pl_body_verdict pl_body_judge(const pl_reference *reference, const pl_body_paths *paths, int body);

/* Judges the first repeats of the case on all configurations, whose positions are there, by a reference that is known.
 * The caller frees the verdict. */
pl_reference_verdict pl_reference_judge(const pl_reference_work *work,
                                        const pl_reference *reference);

/* Runs and tests the ensembles, into verdict->after. Nothing is run where every body has a reference to its end. */
void pl_after_horizon_make(pl_reference_work *work, pl_reference_verdict *verdict);

/* Frees the verdicts and the tests. */
void pl_reference_verdict_free(pl_reference_verdict *verdict);

/* Whether engines of two other families than that of the reference differ from it in the body and agree
 * with each other: within the bound of the body, or a tenth of their distance from the reference. Then a
 * reference that no second engine confirms may be wrong. At the scene's own step engines can share an error
 * of that step, so that a confirmed reference is not contradicted. *one and *other (NULL allowed): such
 * engines. */
bool pl_reference_is_contradicted(const pl_reference_verdict *verdict, int body, int *one,
                                  int *other);

/* ---- Sentences ---- */

/* Appends a text, formatted as printf does, to an array of strings. */
__attribute__((format(printf, 2, 3))) void pl_sentence_add(json_t *sentences, const char *format,
                                                           ...);

/* Appends the sentences: on the reference, on the bodies that differ, and on the engines that agree. */
void pl_reference_sentences(const pl_reference_verdict *verdict, json_t *sentences);

/* Appends the sentences on what is after the horizon. */
void pl_after_horizon_sentences(const pl_reference_verdict *verdict, json_t *sentences);

/* ---- JSON: new references ---- */

/* The runs that the item of a case depends on, by their hashes, as an array: those of the compared
 * configurations, and that of the reference's engine at the asked step. */
json_t *pl_reference_runs_json(const pl_plan *plan, const pl_case *test_case);

/* The item of a case in `cases` of plumb.reference/1. `verdict` is NULL where there is no reference. `sentences` is
 * borrowed. */
json_t *pl_reference_case_json(const pl_reference_work *work, const pl_reference *reference,
                               const pl_reference_verdict *verdict, json_t *sentences);

#endif
