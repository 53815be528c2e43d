/* One manifold at a time. */
#define PE_WIDTH 1
#define PE_KERNEL pe_sweep_kernel_1
#include "sweep_kernel.h"
