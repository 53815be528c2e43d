/* Eight manifolds at a time, by AVX-512. */
#define PE_WIDTH 8
#define PE_KERNEL pe_sweep_kernel_8
#include "sweep_kernel.h"
