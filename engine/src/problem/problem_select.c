#include "problem_select.h"

#include <string.h>

pe_status pe_problem_select(const pe_problem *problem, const bool *selected, pe_workspace work,
                            pe_problem *part, int **point_of, pe_error *error)
{
    size_t patches = (size_t)problem->patch_count, points = (size_t)problem->point_count;
    pe_solver_manifold *patch = pe_take(work, patches + 1, sizeof *patch);
    pe_solver_point *point = pe_take(work, points + 1, sizeof *point);
    double(*impulse)[3] = pe_take(work, points + 1, sizeof *impulse);
    int *origin = pe_take(work, points + 1, sizeof *origin);
    if (patch == NULL || point == NULL || impulse == NULL || origin == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points", points);
    }
    *part = *problem;
    part->patch_count = part->point_count = 0;
    for (int i = 0; i < problem->patch_count; ++i) {
        const pe_solver_manifold *from = &problem->patch[i];
        if (selected != NULL && !selected[i]) {
            continue;
        }
        patch[part->patch_count] = *from;
        patch[part->patch_count++].first = part->point_count;
        for (int j = from->first; j < from->first + from->count; ++j) {
            point[part->point_count] = problem->point[j];
            memcpy(impulse[part->point_count], problem->impulse[j], sizeof *impulse);
            origin[part->point_count++] = j;
        }
    }
    part->patch = patch;
    part->point = point;
    part->impulse = impulse;
    *point_of = origin;
    return PE_OK;
}
