/* The kernels for eight manifolds at a time, by AVX-512. */
#define PE_WIDTH 8
#include "soft_kernel.h"
#include "sweep_kernel.h"

const pe_kernels pe_kernels_8 = {8, &SOFT_KERNEL, &SWEEP_KERNEL};
