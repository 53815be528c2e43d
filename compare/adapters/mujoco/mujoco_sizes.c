/* The sums are upper bounds of those of mujoco/mjxmacro.h (MJDATA_POINTERS) and of the calls of
 * mj_stackAlloc in MuJoCo 2.2. */
#include "mjcf.h"

#include <limits.h>

/* MuJoCo lists contacts of depth 0 too: flush boxes at the start have many. */
enum { LISTED_A_CONTACT = 3, ROWS_A_CONTACT = 4, DEGREES_A_BODY = 6 };

static double moving_bodies(const pl_scene *scene)
{
    double count = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        count += !scene->bodies[i].is_static;
    }
    return count;
}

/* Bytes of the main buffer: the dense square of the rows and the Jacobian with its transpose, each
 * with column indices, besides what is linear. */
static double buffer_bytes(double bodies, double moving, double contacts)
{
    double rows = ROWS_A_CONTACT * contacts, degrees = DEGREES_A_BODY * moving;
    return 12 * rows * rows + 24 * rows * degrees + 256 * rows +
           1024 * LISTED_A_CONTACT * contacts + 4096 * bodies + 65536;
}

/* Numbers on the stack: the dual solvers' factors, Newton's dense Hessian with a copy and indices,
 * and the pairs of the broad phase. */
static double stack_numbers(double bodies, double moving, double contacts)
{
    double rows = ROWS_A_CONTACT * contacts, degrees = DEGREES_A_BODY * moving;
    return 4 * rows * degrees + 3 * degrees * degrees + bodies * bodies / 2 +
           64 * (rows + degrees + bodies) + 10000;
}

pl_mujoco_sizes pl_mujoco_sizes_for(const pl_scene *scene, int contacts)
{
    double bodies = scene->body_count + 1.0, moving = moving_bodies(scene);
    int low = 0, high = contacts;
    while (low < high) { /* the largest number of contacts that fits */
        int middle = low + (high - low + 1) / 2;
        bool fits = buffer_bytes(bodies, moving, middle) < INT_MAX &&
                    stack_numbers(bodies, moving, middle) < INT_MAX;
        low = fits ? middle : low;
        high = fits ? high : middle - 1;
    }
    if (low == 0) {
        return (pl_mujoco_sizes){.contacts = 0};
    }
    double stack = stack_numbers(bodies, moving, low);
    return (pl_mujoco_sizes){.contacts = low,
                             .nconmax = LISTED_A_CONTACT * low,
                             .njmax = ROWS_A_CONTACT * low,
                             .nstack = (int)stack,
                             .bytes = buffer_bytes(bodies, moving, low) + 8 * stack};
}

int pl_mujoco_first_contacts(const pl_scene *scene)
{
    return 100 + 10 * (int)moving_bodies(scene);
}
