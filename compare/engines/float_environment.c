#include "load_engine.h"

#ifdef __SSE__
#include <xmmintrin.h>
#endif

/* The modes of MXCSR: FTZ, DAZ, rounding and the masks of exceptions. fegetround and fegetexcept need
 * not look there: code may set it apart from the x87 unit. */
enum { CONTROL_FLUSH = 0x8040, CONTROL_ROUNDING = 0x6000, CONTROL_TRAPS = 0x1f80 };

static unsigned control_now(void)
{
#ifdef __SSE__
    return _mm_getcsr() & (CONTROL_FLUSH | CONTROL_ROUNDING | CONTROL_TRAPS);
#else
    return 0;
#endif
}

pl_float_environment pl_float_environment_save(void)
{
    pl_float_environment saved = {
        .rounding = fegetround(), .traps = fegetexcept(), .control = control_now()};
    fegetenv(&saved.all);
    return saved;
}

unsigned pl_float_environment_restore(const pl_float_environment *saved)
{
    const unsigned control = control_now() ^ saved->control;
    unsigned changed = 0;
    if (fegetround() != saved->rounding || (control & CONTROL_ROUNDING) != 0) {
        changed |= PL_MODE_ROUNDING;
    }
    if (fegetexcept() != saved->traps || (control & CONTROL_TRAPS) != 0) {
        changed |= PL_MODE_TRAPS;
    }
    if ((control & CONTROL_FLUSH) != 0) {
        changed |= PL_MODE_FLUSH;
    }
    fesetenv(&saved->all);
    return changed;
}
