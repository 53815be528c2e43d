/* Eight manifolds at a time, by AVX-512. */
#define PE_WIDTH 8
#define PE_KERNEL pe_soft_kernel_8
#include "soft_sweep.h"
