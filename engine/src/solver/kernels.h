/* The kernels of soft contact and of Gauss-Seidel sweeps for each width of vectors. All widths give
 * the same bits: every lane does the same IEEE operations. */
#ifndef PE_KERNELS_H
#define PE_KERNELS_H

#include "soft_task.h"
#include "sweep.h"

/* The kernels for one width of vectors. */
typedef struct pe_kernels {
    int lanes; /* manifolds solved at once: 1, 4 (AVX2) or 8 (AVX-512) */
    const pe_soft_kernel *soft;
    const pe_sweep_kernel *sweep;
} pe_kernels;

/* The widest kernels that this build and this processor have, of at most `lanes` lanes; 0: any. */
const pe_kernels *pe_kernels_for(int lanes);

extern const pe_kernels pe_kernels_1;
#ifdef PE_KERNELS_X86
extern const pe_kernels pe_kernels_4, pe_kernels_8;
#endif

#endif
