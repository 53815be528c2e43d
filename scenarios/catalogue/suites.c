/* The suites: which scenarios are run together. */
#include "catalogue.h"

#include <string.h>

static const pl_suite_entry canonical[] = {
    {.scenario = "tower"},         {.scenario = "multi-tower", .setting = "k=2,n=10"},
    {.scenario = "slope-stick"},   {.scenario = "slope-slide"},
    {.scenario = "slope-tip"},     {.scenario = "wall"},
    {.scenario = "wall-collapse"}, {.scenario = "falling-cubes"},
    {.scenario = "rocket"}};

/* Every scenario that has a right answer in numbers. */
static const pl_suite_entry analytic[] = {{.scenario = "free-fall"},
                                          {.scenario = "projectile"},
                                          {.scenario = "rocket"},
                                          {.scenario = "torque-free"},
                                          {.scenario = "top"},
                                          {.scenario = "slope-stick"},
                                          {.scenario = "slope-slide"},
                                          {.scenario = "slope-threshold"},
                                          {.scenario = "slope-tip"},
                                          {.scenario = "slide-to-stop"},
                                          {.scenario = "isotropy"},
                                          {.scenario = "reaction-split"},
                                          {.scenario = "spin-stop"},
                                          {.scenario = "slide-and-spin"},
                                          {.scenario = "roll-slope"},
                                          {.scenario = "bowling"},
                                          {.scenario = "carried-balls"},
                                          {.scenario = "ladder"},
                                          {.scenario = "bounce"},
                                          {.scenario = "oblique-impact"},
                                          {.scenario = "collision-train"},
                                          {.scenario = "cradle"},
                                          {.scenario = "rocking-block"},
                                          {.scenario = "thin-wall"},
                                          {.scenario = "tower"},
                                          {.scenario = "multi-tower"},
                                          {.scenario = "mass-ratio"},
                                          {.scenario = "wall"},
                                          {.scenario = "pyramid"},
                                          {.scenario = "blocks"},
                                          {.scenario = "rest-shape"},
                                          {.scenario = "linked-rings"},
                                          {.scenario = "overhang"},
                                          {.scenario = "arch"},
                                          {.scenario = "cylinder-pyramid"},
                                          {.scenario = "sphere-pyramid"},
                                          {.scenario = "thin-rod"},
                                          {.scenario = "far-from-origin"},
                                          {.scenario = "large-step"},
                                          {.scenario = "initial-overlap"}};

/* Table 2 of the source. */
static const pl_suite_entry paper[] = {
    {"tower", "n=5", 1.65}, {"tower", "n=10", 36}, {"tower", "n=25", 47}};

/* Table 1 of the source: collision detection and processing together, s. */
static const pl_suite_entry paper_blocks[] = {{"blocks", "n=5", 0.6e-3 + 1.5e-3},
                                              {"blocks", "n=10", 0.9e-3 + 1.8e-3},
                                              {"blocks", "n=100", 20e-3 + 60e-3},
                                              {"blocks", "n=200", 44e-3 + 140e-3}};

/* Small enough for a hundred members on two cores in minutes. */
static const pl_suite_entry chaotic[] = {
    {.scenario = "wall-collapse", .setting = "rows=8,columns=12"},
    {.scenario = "pile", .setting = "n=60,duration=6"}};

/* What breaks engines; each says what it provokes. */
static const pl_suite_entry hard[] = {{.scenario = "tower", .setting = "n=100"},
                                      {.scenario = "mass-ratio", .setting = "k=6"},
                                      {.scenario = "arch"},
                                      {.scenario = "card-house"},
                                      {.scenario = "overhang"},
                                      {.scenario = "cylinder-pyramid"},
                                      {.scenario = "sphere-pyramid"},
                                      {.scenario = "cradle"},
                                      {.scenario = "painleve"},
                                      {.scenario = "rocking-block"},
                                      {.scenario = "thin-rod"},
                                      {.scenario = "far-from-origin"},
                                      {.scenario = "large-step"},
                                      {.scenario = "initial-overlap"},
                                      {.scenario = "pile", .setting = "shape=3"},
                                      {.scenario = "needle-in-gap"}};

enum {
    ANALYTIC_COUNT = sizeof analytic / sizeof analytic[0],
    CHAOTIC_COUNT = sizeof chaotic / sizeof chaotic[0],
    CANONICAL_COUNT = sizeof canonical / sizeof canonical[0],
    HARD_COUNT = sizeof hard / sizeof hard[0],
    PAPER_COUNT = sizeof paper / sizeof paper[0],
    PAPER_BLOCKS_COUNT = sizeof paper_blocks / sizeof paper_blocks[0]
};

static const pl_suite suites[] = {
    {.name = "canonical",
     .description =
         "stacks, friction slopes, wall, wall collapse, falling cubes, rocket: the default",
     .entries = canonical,
     .entry_count = CANONICAL_COUNT},
    {.name = "analytic",
     .description =
         "all that have a right answer in numbers: what moves, slides, bounces and rests",
     .entries = analytic,
     .entry_count = ANALYTIC_COUNT},
    {.name = "chaotic",
     .description = "collapses and piles, to be compared as ensembles: plumb ensemble's default",
     .entries = chaotic,
     .entry_count = CHAOTIC_COUNT},
    {.name = "hard",
     .description = "what breaks engines: weights, edges, friction at its limit, sizes, steps",
     .entries = hard,
     .entry_count = HARD_COUNT},
    {.name = "paper",
     .description = "the towers of the source paper, beside its own iteration counts",
     .entries = paper,
     .entry_count = PAPER_COUNT,
     .published_metric = "iterations_mean",
     .source = PL_SOURCE_PAPER
     ", Table 2 "
     "(average number of iterations for stacked cubes), projected Gauss-Seidel. By its "
     "text no tower of more than 25 cubes stood, and the solver often failed to converge "
     "in 500 iterations. It names neither its time step, nor its duration or tolerance"},
    {.name = "paper-blocks",
     .description = "the blocks of the source paper at rest on the floor, beside its own times",
     .entries = paper_blocks,
     .entry_count = PAPER_BLOCKS_COUNT,
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
    for (int i = 0; i < SUITE_COUNT; i++) {
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
