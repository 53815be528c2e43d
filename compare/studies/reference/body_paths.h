/* The paths of all dynamic bodies of a run in memory, read from its positions file
 * (runner/positions.h). All runs of a scene start alike, so that the distance of two bodies is that
 * of their displacements. */
#ifndef PLUMB_BODY_PATHS_H
#define PLUMB_BODY_PATHS_H

#include "plumb/scene.h"

/* The paths of one run. Starts as {0}, which is a run without a path. */
typedef struct pl_body_paths {
    int bodies;     /* dynamic ones, in scene order */
    long samples;   /* the first is the start; 0: there is no path */
    double *moved;  /* (samples x bodies x 3): displacement of the centre of mass, m, world */
    bool completed; /* the last sample is the last that a whole run has */
} pl_body_paths;

/* Reads the positions of the run with the hash `run` in `folder`: a run of `scene`, with a sample
 * every `stride` steps (> 0). No file, or one that does not fit, gives no path. Samples from the
 * first number that is not finite on are left out. The caller frees the paths. */
pl_body_paths pl_body_paths_read(const char *folder, const char *run, const pl_scene *scene,
                                 long stride);

/* Frees the paths and makes them {0}. */
void pl_body_paths_free(pl_body_paths *paths);

/* How far apart a body is in two runs at a sample that both have, m. */
double pl_body_paths_distance(const pl_body_paths *a, const pl_body_paths *b, int body,
                              long sample);

/* The lesser number of samples of two runs. */
long pl_body_paths_common(const pl_body_paths *a, const pl_body_paths *b);

#endif
