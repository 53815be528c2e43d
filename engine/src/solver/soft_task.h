/* The input of the kernels of soft contact (soft.h): the order in which contacts are solved, the
 * coefficients of a sub-step, and the arrays that a kernel fills. */
#ifndef PE_SOFT_TASK_H
#define PE_SOFT_TASK_H

#include "solver_body.h"
#include "stages.h"

/* ---- The plan ----
 *
 * Contacts get colours greedily, so that no two of one colour share a dynamic body. Within a colour
 * they are sorted by their number of points, so that all lanes have the same work. The order does
 * not depend on the number of lanes. */

enum { PE_SOFT_POINTS = 4 };

/* Up to four points of a manifold. A manifold of more points is solved as two contacts. */
typedef struct pe_soft_contact {
    int manifold;
    int a, b; /* solver bodies */
    int count;
    int point[PE_SOFT_POINTS]; /* indices into the world's manifold points */
} pe_soft_contact;

/* Contacts with the same number of points. They share no body; those of a serial batch may, and are
 * solved one after the other. */
typedef struct pe_soft_batch {
    int first, count; /* contacts */
    int points;       /* of each */
    bool hard;        /* against a static body */
    bool rough;       /* with friction */
    bool serial;
    int colour;
} pe_soft_batch;

/* The contacts of a step in batches that share no body. The arrays are in the arena of the step. */
typedef struct pe_soft_plan {
    int count;
    pe_soft_contact *contacts; /* (count), batch after batch */
    int batch_count;
    pe_soft_batch *batches;
    int colours;
    int points;
} pe_soft_plan;

/* Plans the manifolds of the chosen islands, in the step's arena. Each contact gets the lowest
 * colour that neither of its bodies has yet; when all are taken, the last one, whose batches are
 * serial. */
pe_status pe_soft_plan_make(pe_world *world, const pe_chosen_islands *chosen,
                            const pe_solver_bodies *bodies, pe_soft_plan *plan, pe_error *error);

/* ---- The kernels ---- */

/* Coefficients of the implicit spring, for one sub-step. */
typedef struct pe_soft_spring {
    double rate;          /* a_b, 1/s: speed by which a penetration is pushed out, per its depth */
    double mass_scale;    /* a_m */
    double impulse_scale; /* a_p */
} pe_soft_spring;

/* All that the kernels read and write. The arrays hold items of the kernel's own sizes. */
typedef struct pe_soft_task {
    const pe_manifold *manifolds;
    pe_manifold_point *points; /* impulses are written by `store` */
    const pe_soft_plan *plan;
    const pe_solver_bodies *bodies;

    int substeps;
    double substep;                     /* h, s */
    double push_speed;                  /* m/s */
    pe_soft_spring spring, hard_spring; /* between two bodies; against a static one */

    pe_pool *pool;    /* NULL: one thread */
    pe_stages stages; /* of the blocks */

    /* Filled by `lay_out` and `prepare`: */
    double *depth; /* (one for each piece of PE_SOFT_GRAIN blocks) m, of the deepest point; 0 where
                      nothing overlaps */
    int block_count;
    void *blocks, *rows; /* normals: a block per group of contacts, a row per point */
    void *friction_blocks, *friction_rows; /* the same of the friction of rough blocks */
} pe_soft_task;

/* Blocks of a piece. */
enum { PE_SOFT_GRAIN = 8 };

/* Work on blocks, or bodies, begin .. end - 1. Blocks of one colour can be worked on in any order. */
typedef void pe_soft_work(const pe_soft_task *task, int begin, int end);

/* The sweeps of the soft contact solver for one vector width. */
typedef struct pe_soft_kernel {
    size_t block_size, row_size, friction_block_size, friction_row_size; /* bytes */

    /* Divides the batches into blocks, and sets their places in the arrays. */
    void (*lay_out)(pe_soft_task *task);
    /* Fills blocks from the contacts. Starting impulses are those of the points, divided by the number
     * of sub-steps. */
    pe_soft_work *prepare;
    /* Applies the starting impulses. */
    pe_soft_work *warm_start;
    /* The two sweeps. `relax` adds each impulse to the sum over the step. */
    pe_soft_work *bias, *relax;
    /* Writes the impulses of the step into the manifold points. */
    pe_soft_work *store;
    /* Changes the velocities of bodies by as much as they changed in the last sub-step. */
    pe_soft_work *integrate_velocities;
    /* Changes the displacements of bodies by the velocities. */
    pe_soft_work *integrate_positions;
} pe_soft_kernel;

#endif
