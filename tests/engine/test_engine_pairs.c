/* Narrow phase: the laws of contact of all pairs of shapes, over a few poses of each. */
#include "shape_pairs_laws.h"

int main(void)
{
    const law_budget budget = {
        .truth_poses = 120, .mesh_truth_poses = 120, .poses = 1000, .mesh_poses = 300};
    return run_pair_laws("engine_pairs", budget);
}
