/* Narrow phase: the laws of contact of all pairs of shapes with a mesh, over many poses of each. */
#include "shape_pairs_laws.h"

int main(void)
{
    const law_budget budget = {.mesh_truth_poses = 2000, .mesh_poses = 20000};
    return run_pair_laws("engine_pairs_mesh_slow", budget);
}
