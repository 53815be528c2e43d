/* Four manifolds at a time, by AVX2. */
#define PE_WIDTH 4
#define PE_KERNEL pe_soft_kernel_4
#include "soft_sweep.h"
