/* The work on blocks of manifolds, for a number of lanes: one table of functions each, compiled
 * from one source. */
#ifndef PE_SOFT_KERNEL_H
#define PE_SOFT_KERNEL_H

#include "soft_plan.h"

/* The coefficients of the implicit spring, for one substep. */
typedef struct pe_soft_spring {
    double rate;          /* a_b, 1/s: speed by which a penetration is left, per its depth */
    double mass_scale;    /* a_m */
    double impulse_scale; /* a_p */
} pe_soft_spring;

/* All that the kernels read and write. The arrays hold items of the kernel's own sizes. */
typedef struct pe_soft_task {
    const pe_manifold *manifolds;
    pe_manifold_point *points; /* impulses are written by `store` */
    const pe_soft_plan *plan;
    const pe_solver_bodies *lines;

    int substeps;
    double substep;                     /* h, s */
    double push_speed;                  /* m/s */
    double threshold;                   /* m/s: slower approach does not bounce */
    pe_soft_spring spring, hard_spring; /* between two bodies; against a static one */

    /* Of `prepare`: */
    double penetration; /* m, of the deepest point; 0 when none is deep */
    int block_count;
    void *blocks, *rows; /* normals: one block a group of manifolds, one row a point */
    void *friction_blocks, *friction_rows; /* friction, likewise, of the rough blocks */
    void *bounces;                         /* one a row; NULL when nothing bounces */
} pe_soft_task;

typedef struct pe_soft_kernel {
    int lanes;
    size_t block_size, row_size, friction_block_size, friction_row_size, bounce_size;

    /* Fills blocks, rows, friction blocks and bounces from the contacts; impulses are those of the
     * points, divided by the substeps. */
    void (*prepare)(pe_soft_task *task);
    /* Applies the impulses of the rows as they stand. */
    void (*warm)(const pe_soft_task *task);
    /* The sweeps; `relax` adds each impulse to the step's. */
    void (*bias)(const pe_soft_task *task);
    void (*relax)(const pe_soft_task *task);
    /* Newton's law at what approached at the step's start and has been hit since. */
    void (*bounce)(const pe_soft_task *task);
    /* Writes the step's impulses into the points. */
    void (*store)(const pe_soft_task *task);
    /* Changes the velocities by what they changed in the last substep. */
    void (*advance)(const pe_soft_task *task);
    /* Moves the displacements by the velocities. */
    void (*drift)(const pe_soft_task *task);
} pe_soft_kernel;

extern const pe_soft_kernel pe_soft_kernel_1;
#ifdef PE_SOFT_X86
extern const pe_soft_kernel pe_soft_kernel_4, pe_soft_kernel_8;
#endif

#endif
