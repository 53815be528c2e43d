/* The floating-point environment around an engine's code: saved before a call, restored after it. */
#ifndef PLUMB_FLOAT_ENVIRONMENT_H
#define PLUMB_FLOAT_ENVIRONMENT_H

#include <fenv.h>

/* The floating-point modes that code may leave changed, as bits. */
enum {
    PL_MODE_ROUNDING = 1u << 0, /* the rounding mode */
    PL_MODE_TRAPS = 1u << 1,    /* which exceptions trap */
    PL_MODE_FLUSH = 1u << 2     /* whether subnormal numbers are flushed to zero (x86) */
};

/* An environment that was saved. */
typedef struct pl_float_environment {
    fenv_t all;
    int rounding;     /* fegetround */
    int traps;        /* fegetexcept */
    unsigned control; /* the modes of MXCSR; 0 where there is none */
} pl_float_environment;

/* The environment now. */
pl_float_environment pl_float_environment_save(void);

/* Restores it all, and returns the PL_MODE_* bits of the modes that had changed. Raised flags are
 * restored, and are no mode. */
unsigned pl_float_environment_restore(const pl_float_environment *saved);

#endif
