/* A converged reference for one scene: the paths of plumb:accurate at the finest of several steps
 * dt, dt/2, dt/4, ..., with their estimated error over time (halving_error.h), and a second engine
 * at the same steps that confirms them or does not.
 *
 * Two codes that share no line and converge to one answer are hardly both wrong in the same way, so
 * the second engine says whether the limit is right, and the halvings of the first how far from the
 * limit it still is (verification and validation are different things: Roache 1998, chapter 2). A
 * second engine that converges slowly does not spoil the estimate: where the two are no farther
 * apart than three times the sum of what each has still to go, they may have the same limit; and where
 * the second one's own error is beyond the bound of the body, it has no limit yet that could be
 * compared. Otherwise, where they are farther apart, and by more than that bound, they converge to
 * different answers, and their distance counts as the error of the reference. */
#ifndef PLUMB_CONVERGED_REFERENCE_H
#define PLUMB_CONVERGED_REFERENCE_H

#include "body_paths.h"
#include "runner/execute.h"

/* The largest number of steps that are tried: dt to dt / 64. */
enum { PL_REFERENCE_LEVELS = 7, PL_REFERENCE_LEAST_LEVELS = 3, PL_REFERENCE_CANDIDATES = 3 };

/* Bounds of the cost: a scene that takes more steps times bodies at the asked step gets no reference,
 * and after dt / 4 no smaller step is tried at which a run would. */
extern const double pl_reference_most_work;
/* A body differs beyond this share of its size (its smallest dimension), but at least beyond
 * pl_reference_least_bound (m), and beyond pl_reference_safety times the error of the reference. */
extern const double pl_reference_share, pl_reference_least_bound, pl_reference_safety;
/* No error is estimated smaller than this share of the smallest body's size. */
extern const double pl_reference_floor;

/* The spec of the engine that makes references. */
extern const char pl_reference_engine[];

/* An engine that may confirm a reference. */
typedef struct pl_reference_candidate {
    const char *spec;
    int most_bodies; /* dynamic ones: a step of a dense solver costs their number cubed */
} pl_reference_candidate;

extern const pl_reference_candidate pl_reference_candidates[PL_REFERENCE_CANDIDATES];

/* What a reference is made of. The pointers are borrowed. */
typedef struct pl_reference_def {
    const pl_case *original;    /* a case of a scene file */
    pl_execution_def execution; /* all but the plan is used */
    json_t *study;              /* that the runs belong to, as in results */
    const json_t *results;      /* of the compared configurations; NULL: none is known */
    bool without_second;        /* for tests: no engine confirms it */
} pl_reference_def;

/* One engine at the steps that it was run at. */
typedef struct pl_reference_runs {
    char label[PL_LABEL_SIZE];
    pl_body_paths levels[PL_REFERENCE_LEVELS];
    int count;                          /* the first so many levels ran to their end */
    double change[PL_REFERENCE_LEVELS]; /* m: the largest by the halving to this level; NAN: none */
    double apart;     /* m: the largest distance from the reference engine at the third level */
    char reason[256]; /* why it has fewer levels; "": none */
} pl_reference_runs;

/* The reference of one case. */
typedef struct pl_reference {
    pl_reference_runs engines[1 + PL_REFERENCE_CANDIDATES]; /* the first is the reference's own */
    int engine_count;
    int second;      /* the index of the one that confirms it; 0: none */
    long stride;     /* steps of the asked size from one sample to the next */
    double dt;       /* s: the asked step */
    double interval; /* s, from one sample to the next */
    double floor;    /* m: no error is estimated smaller */
    int bodies;      /* dynamic ones, in scene order */
    int *body;       /* (bodies): index in the scene */
    double *bounds;  /* (bodies): m */
    bool known;      /* false: there is none, and `reason` says why; the rest is undefined */
    char reason[512];
    long samples;
    double *error;     /* (samples x bodies): estimated from the halvings alone, m */
    double *allowance; /* (samples x bodies): the same; where the engines differ, their distance */
    long *
        horizon; /* (bodies): the sample from which on the error stays beyond the bound; samples: it
                      does not */
    double
        confirmed; /* m: the largest distance of the two engines, within the horizons; NAN: none */
    int unconfirmed; /* bodies in which the second engine ends beyond the bound, but has not converged */
    int disputed;      /* bodies of which the two engines converge to different answers */
    int most_disputed; /* of them the one farthest apart at the end; -1: none */
} pl_reference;

/* Whether a case is one of a scene file that expects nothing and in which something can move. */
bool pl_reference_applies(const pl_case *test_case);

/* The bound of a body from its size, m. */
double pl_reference_bound(const pl_body *body);

/* Runs the engines and evaluates them. Runs that fail are no error: the reference is then not known.
 * A signal ends it as in pl_execute. The caller frees *reference in any case. */
pl_status pl_reference_make(const pl_reference_def *def, pl_reference *reference,
                            int *signal_number, pl_error *error);

/* The reference's paths: those at the finest step. */
const pl_body_paths *pl_reference_paths(const pl_reference *reference);

/* Frees what pl_reference_make allocated. */
void pl_reference_free(pl_reference *reference);

#endif
