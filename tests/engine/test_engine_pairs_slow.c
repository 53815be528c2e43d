/* Narrow phase: the laws of contact of all pairs without a mesh, over many poses of each. */
#include "shape_pairs_laws.h"

int main(void)
{
    const law_budget budget = {.truth_poses = 5000, .poses = 50000};
    return run_pair_laws("engine_pairs_slow", budget);
}
