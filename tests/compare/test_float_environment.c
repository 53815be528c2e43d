/* The floating-point environment around an engine's code is restored, and what it changed is known. */
#include "check.h"
#include "engines/load_engine.h"

#ifdef __SSE__
#include <xmmintrin.h>
#endif

static unsigned modes_after(void (*change)(void))
{
    const pl_float_environment saved = pl_float_environment_save();
    change();
    const unsigned modes = pl_float_environment_restore(&saved);
    assert_int_equal(fegetround(), FE_TONEAREST);
    assert_int_equal(fegetexcept(), 0);
    assert_int_equal(pl_float_environment_restore(&saved), 0);
    return modes;
}

static void change_nothing(void)
{
}

static void round_upward(void)
{
    fesetround(FE_UPWARD);
}

static void trap_division(void)
{
    feenableexcept(FE_DIVBYZERO);
}

static void raise_flags(void)
{
    feraiseexcept(FE_ALL_EXCEPT);
}

static void test_changed_modes_are_named_and_restored(void **state)
{
    (void)state;
    assert_int_equal(modes_after(change_nothing), 0);
    assert_int_equal(modes_after(round_upward), PL_MODE_ROUNDING);
    assert_int_equal(modes_after(trap_division), PL_MODE_TRAPS);
}

static void test_raised_flags_are_restored_and_no_mode(void **state)
{
    (void)state;
    feclearexcept(FE_ALL_EXCEPT);
    assert_int_equal(modes_after(raise_flags), 0);
    assert_int_equal(fetestexcept(FE_ALL_EXCEPT), 0);
}

#ifdef __SSE__
static void flush_to_zero(void)
{
    _mm_setcsr(_mm_getcsr() | 0x8000);
}

static void round_vectors_downward(void)
{
    _mm_setcsr(_mm_getcsr() | 0x2000);
}
#endif

static void test_modes_of_mxcsr_are_seen_and_restored(void **state)
{
    (void)state;
#ifdef __SSE__
    assert_int_equal(modes_after(flush_to_zero), PL_MODE_FLUSH);
    assert_int_equal(modes_after(round_vectors_downward), PL_MODE_ROUNDING);
#else
    skip();
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_changed_modes_are_named_and_restored),
        cmocka_unit_test(test_raised_flags_are_restored_and_no_mode),
        cmocka_unit_test(test_modes_of_mxcsr_are_seen_and_restored),
    };
    return cmocka_run_group_tests_name("floating-point environment", tests, NULL, NULL);
}
