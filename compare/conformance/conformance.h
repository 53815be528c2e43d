/* Conformance of an engine and its adapter to the engine ABI: small scenes, each of which catches
 * one kind of mistake by what the engine does, not by what it says of itself.
 *
 * Every check runs in a process of its own. A check that crashes, hangs or exits has failed, and the
 * others go on. */
#ifndef PLUMB_CONFORMANCE_H
#define PLUMB_CONFORMANCE_H

#include "engines/process.h"
#include "engines/registry.h"

#include <stdio.h>

/* How a check ended. */
typedef enum pl_check_outcome {
    PL_CHECK_PASSED,
    PL_CHECK_FAILED,
    PL_CHECK_SKIPPED /* the engine does not claim what the check needs */
} pl_check_outcome;

/* Sizes of the texts of a check's result, with their terminating zeros. */
enum { PL_CHECK_TEXT_SIZE = 400 };

struct pl_probe;

/* A check. */
typedef struct pl_check {
    const char *name;  /* "normal-direction" */
    const char *title; /* what is checked, in a few words */
    uint32_t needs;    /* PL_NEEDS_* without which the check is skipped */
    uint32_t contacts; /* PL_CONTACTS_* without which it is skipped */
    void (*run)(struct pl_probe *probe);
    int variant; /* tells checks that share `run` from each other */
} pl_check;

/* The result of one check on one engine configuration. */
typedef struct pl_check_result {
    const pl_check *check;
    pl_check_outcome outcome;
    char expected[PL_CHECK_TEXT_SIZE]; /* what was expected; empty when passed */
    char found[PL_CHECK_TEXT_SIZE];    /* what was found; why it was skipped; how it crashed */
    char cause[PL_CHECK_TEXT_SIZE];    /* what usually causes it; may be empty */
} pl_check_result;

/* The check of that index from 0; NULL beyond the last. Static storage. */
const pl_check *pl_conformance_check(int index);

/* Runs a check on a configuration. PL_IO: it could not be run. */
pl_status pl_conformance_run(const pl_check *check, const pl_engine_choice *choice,
                             const pl_limits *limits, pl_check_result *result, pl_error *error);

#endif
