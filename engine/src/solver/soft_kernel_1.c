/* One manifold at a time. */
#define PE_WIDTH 1
#define PE_KERNEL pe_soft_kernel_1
#include "soft_sweep.h"
