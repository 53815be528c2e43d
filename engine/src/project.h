/* Penetration removed by moving bodies, velocities untouched. */
#ifndef PE_PROJECT_H
#define PE_PROJECT_H

#include "problem.h"

typedef struct pe_project_report {
    int iterations;     /* sweeps, largest over islands */
    double penetration; /* m, deepest before */
} pe_project_report;

/* For each island with a contact deeper than the slop: the least displacement d in the metric of
 * mass, min |d|_M subject to J_n d + phi >= -slop/3 at every contact, open ones too, with phi as it
 * is at the poses now. By projected Gauss-Seidel; the best iterate found is applied, and nothing if
 * none is better than standing still. The rows are those of the velocity problem, whose bias,
 * impulses and velocities it overwrites: store them first. No allocation. */
void pe_project_positions(pe_world *world, const pe_islands *islands, pe_problems *problems,
                          pe_project_report *report);

#endif
