/* Where bodies with a reference are beside it: above the plane that bears them, and off their line.
 */
#ifndef PLUMB_PATH_H
#define PLUMB_PATH_H

#include "plumb/engine_abi.h"

typedef struct pl_path pl_path;

/* Follows the bodies of scene.rests and scene.travels. NULL when out of memory. Freed by
 * pl_path_destroy (NULL allowed). */
pl_path *pl_path_create(const pl_scene *scene);
void pl_path_destroy(pl_path *path);

/* Whether any body has a plane that bears it; whether any travels. */
bool pl_path_has_lift(const pl_path *path);
bool pl_path_has_line(const pl_path *path);

/* Max over bodies of the height of the centre over its reference (of a travelling body: over its
 * start) along the normal of the plane that bears it; 0 when none is above. m. The plane that bears
 * a body is the static plane whose normal points most against gravity, and along which the body's
 * travel runs. */
double pl_path_lift(const pl_path *path, const pl_body_state *bodies);

/* Max over travelling bodies of the distance of the centre from the line of the travel through its
 * start, without the part along that plane's normal (where there is one). m. */
double pl_path_deviation(const pl_path *path, const pl_body_state *bodies);

#endif
