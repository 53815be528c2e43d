/* The words of the answer to hello, which hello.c reads and hello_write.c writes. */
#ifndef PLUMB_HELLO_WORDS_H
#define PLUMB_HELLO_WORDS_H

#include "plumb/engine_abi.h"

static const char PROTOCOL[] = "plumb.engine/1";

static const char *const precisions[] = {
    [PL_PRECISION_DOUBLE] = "double", [PL_PRECISION_FLOAT] = "float", NULL};
static const char *const integrators[] = {[PL_INTEGRATOR_UNKNOWN] = "unknown",
                                          [PL_INTEGRATOR_SEMI_IMPLICIT_EULER] =
                                              "semi-implicit Euler",
                                          [PL_INTEGRATOR_EXPLICIT_EULER] = "explicit Euler",
                                          [PL_INTEGRATOR_MIDPOINT] = "midpoint",
                                          NULL};
static const char *const gyroscopics[] = {[PL_GYROSCOPIC_UNKNOWN] = "unknown",
                                          [PL_GYROSCOPIC_NONE] = "none",
                                          [PL_GYROSCOPIC_EXPLICIT] = "explicit",
                                          [PL_GYROSCOPIC_IMPLICIT] = "implicit",
                                          NULL};
static const char *const contacts[] = {"points", "impulses", "torques", NULL};
static const char *const readings[] = {"settings", "pairs", NULL};

#endif
