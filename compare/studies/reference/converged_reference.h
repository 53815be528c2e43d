/* A converged reference for one scene: the paths of one engine at the finest of several steps
 * dt, dt/2, dt/4, ..., with their estimated error over time (body_paths.h), and a second engine
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
enum { PL_REFERENCE_LEVELS = 7, PL_REFERENCE_CANDIDATES = 3 };

/* A body differs beyond this share of its size (its smallest dimension), but at least beyond
 * pl_reference_least_bound (m), and beyond pl_reference_safety times the error of the reference. */
extern const double pl_reference_share, pl_reference_least_bound, pl_reference_safety;

/* ---- Runs ---- */

/* A case of a scene file and how its runs are made. */
typedef struct pl_reference_work {
    const pl_case *original; /* borrowed */
    /* All but the plan is used. `positions` is an existing folder. The plan has the configurations to judge and
     * the seed. */
    pl_execution_def execution;
    pl_status status;  /* of the first call that failed; its error is in *error */
    pl_error *error;   /* borrowed */
    int signal_number; /* that ended the runs; 0: none */
} pl_reference_work;

/* Whether no call failed, and no signal ended the runs. */
bool pl_reference_goes_on(const pl_reference_work *work);

/* A plan without cases and engines, with the seed of the work. */
pl_plan pl_reference_plan(const pl_reference_work *work);

/* Makes the runs of a plan, with their positions every `stride` steps (0: pl_positions_stride), but not those that are
 * known to have crashed, to have timed out or to be unsupported; and none where the work does not go on. Returns whether
 * the work goes on. */
bool pl_reference_run(pl_reference_work *work, const pl_plan *plan, long stride);

/* The hash of the first run of a case on a configuration. */
void pl_reference_hash(const pl_plan *plan, const pl_case *test_case,
                       const pl_configuration *configuration, char run[17]);

/* The result of a run in the store; NULL: it has none. Borrowed. */
const json_t *pl_reference_result(const pl_reference_work *work, const char *run);

/* ---- The reference ---- */

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

/* Runs the engines and evaluates them. Runs that fail are no error: the reference is then not known.
 * The caller frees *reference in any case. */
void pl_reference_make(pl_reference_work *work, pl_reference *reference);

/* The reference's paths: those at the finest step. */
const pl_body_paths *pl_reference_paths(const pl_reference *reference);

/* Frees what pl_reference_make allocated. */
void pl_reference_free(pl_reference *reference);

#endif
