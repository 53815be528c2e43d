/* The memory that MuJoCo 2.2 must reserve for a scene before it runs. Needs no MuJoCo. */
#ifndef PLUMB_MUJOCO_SIZES_H
#define PLUMB_MUJOCO_SIZES_H

#include "plumb/scene_data.h"

/* The sizes of a model, as its element `size` has them. */
typedef struct pl_mujoco_sizes {
    int contacts; /* with a force */
    int nconmax;  /* contacts, also those that only touch and have no rows */
    int njmax;    /* constraint rows: 4 of a contact, which a pyramidal cone takes */
    int nstack;   /* numbers of 8 bytes that the functions of a step allocate */
    double bytes; /* at most what MuJoCo allocates for them */
} pl_mujoco_sizes;

/* The sizes for `contacts` contacts, or for fewer where they would not fit: MuJoCo counts the bytes
 * of its main buffer, which is quadratic in the rows, in an int. contacts 0: the bodies alone are too
 * many. */
pl_mujoco_sizes pl_mujoco_sizes_for(const pl_scene *scene, int contacts);

/* The number of contacts to begin with. */
int pl_mujoco_first_contacts(const pl_scene *scene);

#endif
