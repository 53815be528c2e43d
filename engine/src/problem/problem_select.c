#include "problem_select.h"

#include <string.h>

pe_status pe_problem_select(const pe_problem *problem, const bool *selected, pe_workspace work,
                            pe_problem *part, int **point_of, pe_error *error)
{
    size_t manifolds = (size_t)problem->manifold_count, points = (size_t)problem->point_count;
    pe_solver_manifold *manifold = pe_take(work, manifolds + 1, sizeof *manifold);
    pe_solver_point *point = pe_take(work, points + 1, sizeof *point);
    double(*impulse)[3] = pe_take(work, points + 1, sizeof *impulse);
    int *origin = pe_take(work, points + 1, sizeof *origin);
    if (manifold == NULL || point == NULL || impulse == NULL || origin == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points", points);
    }
    *part = *problem;
    part->manifold_count = part->point_count = 0;
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *from = &problem->manifold[i];
        if (selected != NULL && !selected[i]) {
            continue;
        }
        manifold[part->manifold_count] = *from;
        manifold[part->manifold_count++].first = part->point_count;
        for (int j = from->first; j < from->first + from->count; ++j) {
            point[part->point_count] = problem->point[j];
            memcpy(impulse[part->point_count], problem->impulse[j], sizeof *impulse);
            origin[part->point_count++] = j;
        }
    }
    part->manifold = manifold;
    part->point = point;
    part->impulse = impulse;
    *point_of = origin;
    return PE_OK;
}
