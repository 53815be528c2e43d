#include "float_environment.h"

#ifdef __SSE__
#include <xmmintrin.h>
#endif

/* Whether subnormal numbers are flushed to zero: FTZ and DAZ. 0 where there is no MXCSR. */
static unsigned flush_mode(void)
{
#ifdef __SSE__
    return _mm_getcsr() & 0x8040u;
#else
    return 0;
#endif
}

pl_float_environment pl_float_environment_save(void)
{
    pl_float_environment saved = {
        .rounding = fegetround(), .traps = fegetexcept(), .flush = flush_mode()};
    fegetenv(&saved.all);
    return saved;
}

unsigned pl_float_environment_restore(const pl_float_environment *saved)
{
    unsigned changed = fegetround() != saved->rounding ? PL_MODE_ROUNDING : 0u;
    changed |= fegetexcept() != saved->traps ? PL_MODE_TRAPS : 0u;
    changed |= flush_mode() != saved->flush ? PL_MODE_FLUSH : 0u;
    fesetenv(&saved->all);
    return changed;
}
