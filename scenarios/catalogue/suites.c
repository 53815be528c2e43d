/* The suites: which scenarios are run together. */
#include "catalogue.h"

#include <string.h>

static const pl_suite_entry canonical[] = {{"tower", NULL, 0},
                                           {"multi-tower", "k=2,n=10", 0},
                                           {"slope-stick", NULL, 0},
                                           {"slope-slide", NULL, 0},
                                           {"slope-tip", NULL, 0},
                                           {"wall", NULL, 0},
                                           {"wall-collapse", "rows=10,columns=10", 0},
                                           {"falling-cubes", NULL, 0},
                                           {"rocket", NULL, 0}};

/* Every scenario that has a right answer in numbers. */
static const pl_suite_entry analytic[] = {{"free-fall", NULL, 0},
                                          {"projectile", NULL, 0},
                                          {"rocket", NULL, 0},
                                          {"torque-free", NULL, 0},
                                          {"top", NULL, 0},
                                          {"slope-stick", NULL, 0},
                                          {"slope-slide", NULL, 0},
                                          {"slope-threshold", NULL, 0},
                                          {"slope-tip", NULL, 0},
                                          {"slide-to-stop", NULL, 0},
                                          {"isotropy", NULL, 0},
                                          {"reaction-split", NULL, 0},
                                          {"spin-stop", NULL, 0},
                                          {"slide-and-spin", NULL, 0},
                                          {"roll-slope", NULL, 0},
                                          {"bowling", NULL, 0},
                                          {"carried-balls", NULL, 0},
                                          {"ladder", NULL, 0},
                                          {"bounce", NULL, 0},
                                          {"bounce-row", NULL, 0},
                                          {"oblique-impact", NULL, 0},
                                          {"collision-train", NULL, 0},
                                          {"cradle", NULL, 0},
                                          {"cradle", "gap=0.01,n=4", 0},
                                          {"rocking-block", NULL, 0},
                                          {"thin-wall", NULL, 0},
                                          {"tower", NULL, 0},
                                          {"multi-tower", NULL, 0},
                                          {"mass-ratio", NULL, 0},
                                          {"wall", NULL, 0},
                                          {"city", NULL, 0},
                                          {"pyramid", NULL, 0},
                                          {"blocks", NULL, 0},
                                          {"rest-shape", NULL, 0},
                                          {"linked-rings", NULL, 0},
                                          {"overhang", NULL, 0},
                                          {"arch", NULL, 0},
                                          {"cylinder-pyramid", NULL, 0},
                                          {"sphere-pyramid", NULL, 0},
                                          {"thin-rod", NULL, 0},
                                          {"far-from-origin", NULL, 0},
                                          {"large-step", NULL, 0},
                                          {"initial-overlap", NULL, 0},
                                          {"dropped-load", NULL, 0},
                                          {"lid", NULL, 0},
                                          {"raft", NULL, 0},
                                          {"overlapping-start", NULL, 0},
                                          {"rain", NULL, 0},
                                          {"spinning-coin", NULL, 0},
                                          {"spinning-coin", "tilt=1,path=0.2", 0}};

/* Table 2 of the source. */
static const pl_suite_entry paper[] = {
    {"tower", "n=5", 1.65}, {"tower", "n=10", 36}, {"tower", "n=25", 47}};

/* Table 1 of the source: collision detection and processing together, s. */
static const pl_suite_entry paper_blocks[] = {{"blocks", "n=5", 0.6e-3 + 1.5e-3},
                                              {"blocks", "n=10", 0.9e-3 + 1.8e-3},
                                              {"blocks", "n=100", 20e-3 + 60e-3},
                                              {"blocks", "n=200", 44e-3 + 140e-3}};

/* Those whose converged end statistics are known (converged.c). */
static const pl_suite_entry chaotic[] = {{"wall-collapse", NULL, 0},
                                         {"pile", NULL, 0},
                                         {"falling-cubes", NULL, 0},
                                         {"dominoes", NULL, 0},
                                         {"domino-into-pile", NULL, 0}};

/* Heaps and other scenes of many contacts at any angle, moving and at rest. */
static const pl_suite_entry heaps[] = {{"wall-collapse", NULL, 0},
                                       {"wall-collapse", "rows=25,columns=40", 0},
                                       {"falling-cubes", NULL, 0},
                                       {"pile", NULL, 0},
                                       {"pile", "n=1000", 0},
                                       {"container", NULL, 0},
                                       {"rubble", NULL, 0},
                                       {"avalanche", NULL, 0},
                                       {"medley", NULL, 0},
                                       {"domino-spiral", NULL, 0},
                                       {"tower", "n=20,yaw=0.1", 0},
                                       {"dropped-load", "ratio=1000", 0},
                                       {"lid", "height=0.1", 0},
                                       {"raft", "k=9,height=1", 0},
                                       {"wall-collapse", "rows=60,columns=100", 0}};

/* Cases that break engines; each names what it provokes. */
static const pl_suite_entry hard[] = {{"tower", "n=100", 0},
                                      {"mass-ratio", "k=6", 0},
                                      {"arch", NULL, 0},
                                      {"card-house", NULL, 0},
                                      {"overhang", NULL, 0},
                                      {"cylinder-pyramid", NULL, 0},
                                      {"sphere-pyramid", NULL, 0},
                                      {"cradle", NULL, 0},
                                      {"painleve", NULL, 0},
                                      {"rocking-block", NULL, 0},
                                      {"thin-rod", NULL, 0},
                                      {"far-from-origin", NULL, 0},
                                      {"large-step", NULL, 0},
                                      {"initial-overlap", NULL, 0},
                                      {"pile", "shape=3", 0},
                                      {"needle-in-gap", NULL, 0},
                                      {"bounce-row", NULL, 0},
                                      {"dropped-load", NULL, 0},
                                      {"lid", NULL, 0},
                                      {"overlapping-start", NULL, 0},
                                      {"spinning-coin", NULL, 0}};

/* Symptoms that users of engines report, each with its right answer. */
static const pl_suite_entry reported[] = {{"seams", NULL, 0},
                                          {"seams", "speed=8,friction=0.3", 0},
                                          {"seams", "yaw=20,gap=0.001", 0},
                                          {"pedestal", NULL, 0},
                                          {"bounce", "restitution=0.3,bounces=1", 0},
                                          {"bounce", "restitution=0.95,bounces=1", 0},
                                          {"bounce-row", NULL, 0},
                                          {"slide-to-stop", NULL, 0},
                                          {"isotropy", NULL, 0},
                                          {"slope-threshold", NULL, 0},
                                          {"roll-slope", NULL, 0},
                                          {"bowling", NULL, 0},
                                          {"torque-free", NULL, 0},
                                          {"mass-ratio", NULL, 0},
                                          {"initial-overlap", NULL, 0}};

#define ENTRIES(table) .entries = (table), .entry_count = sizeof(table) / sizeof(table)[0]

static const pl_suite suites[] = {
    {.name = "canonical",
     .description =
         "stacks, friction slopes, wall, wall collapse, falling cubes, rocket: the default",
     ENTRIES(canonical)},
    {.name = "analytic",
     .description =
         "all that have a right answer in numbers: bodies that move, slide, bounce and rest",
     ENTRIES(analytic)},
    {.name = "chaotic",
     .description = "collapses, piles and dominoes, of which the end statistics are known: plumb "
                    "ensemble's default",
     ENTRIES(chaotic)},
    {.name = "heaps",
     .description = "collapses, piles, rubble, a spiral of dominoes, a yawed tower, heavy loads: "
                    "many contacts "
                    "at any angle",
     ENTRIES(heaps)},
    {.name = "hard",
     .description = "cases that break engines: weights, edges, friction at its limit, sizes, steps",
     ENTRIES(hard)},
    {.name = "reported",
     .description =
         "symptoms that users of engines report: seams, rebounds, friction by direction, "
         "rolling, rotation",
     ENTRIES(reported)},
    {.name = "paper",
     .description = "the towers of the source paper, next to its own iteration counts",
     ENTRIES(paper),
     .published_metric = "iterations_mean",
     .source = PL_SOURCE_PAPER
     ", Table 2 "
     "(average number of iterations for stacked cubes), projected Gauss-Seidel. By its "
     "text no tower of more than 25 cubes stood, and the solver often failed to converge "
     "in 500 iterations. It names neither its time step, nor its duration or tolerance"},
    {.name = "paper-blocks",
     .description = "the blocks of the source paper at rest on the floor, next to its own times",
     ENTRIES(paper_blocks),
     .published_metric = "time_per_step",
     .source = "the same paper, Table 1 (average execution times for blocks resting on floor): "
               "collision detection 0.6, 0.9, 20, 44 ms and collision processing 1.5, 1.8, 60, "
               "140 ms, of meshes, on a machine that it does not name, of 2013 or before"}};
enum { SUITE_COUNT = sizeof suites / sizeof suites[0] };

const pl_suite *pl_suites(int *count)
{
    *count = SUITE_COUNT;
    return suites;
}

const pl_suite *pl_suite_find(const char *name, pl_error *error)
{
    const char *names[SUITE_COUNT];
    for (int i = 0; i < SUITE_COUNT; ++i) {
        names[i] = suites[i].name;
        if (strcmp(name, names[i]) == 0) {
            return &suites[i];
        }
    }
    const char *nearest = pl_nearest_name(name, names, SUITE_COUNT);
    pl_fail(error, PL_BAD_INPUT, "unknown suite \"%s\"; did you mean \"%s\"?", name,
            nearest != NULL ? nearest : names[0]);
    return NULL;
}
