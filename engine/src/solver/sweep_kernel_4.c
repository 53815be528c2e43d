/* Four manifolds at a time, by AVX2. */
#define PE_WIDTH 4
#define PE_KERNEL pe_sweep_kernel_4
#include "sweep_kernel.h"
