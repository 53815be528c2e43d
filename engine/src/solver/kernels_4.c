/* The kernels for four manifolds at a time, by AVX2. */
#define PE_WIDTH 4
#include "soft_kernel.h"
#include "sweep_kernel.h"

const pe_kernels pe_kernels_4 = {4, &SOFT_KERNEL, &SWEEP_KERNEL};
