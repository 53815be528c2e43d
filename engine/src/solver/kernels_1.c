/* The kernels for one manifold at a time, and the choice between the widths. */
#define PE_WIDTH 1
#include "soft_kernel.h"
#include "sweep_kernel.h"

#include "plumb/engine.h"

const pe_kernels pe_kernels_1 = {1, &SOFT_KERNEL, &SWEEP_KERNEL};

const pe_kernels *pe_kernels_for(int lanes)
{
#ifdef PE_KERNELS_X86
    if ((lanes == 0 || lanes >= 8) && __builtin_cpu_supports("avx512f")) {
        return &pe_kernels_8;
    }
    if ((lanes == 0 || lanes >= 4) && __builtin_cpu_supports("avx2")) {
        return &pe_kernels_4;
    }
#else
    (void)lanes;
#endif
    return &pe_kernels_1;
}

int pe_kernel_lanes(void)
{
    return pe_kernels_for(0)->lanes;
}
