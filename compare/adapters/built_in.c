#include "built_in.h"

const pl_built_in *pl_built_in_engines(int *count)
{
    static const pl_built_in all[] = {
        {.name = "plumb", .package = "", .libraries = "", .entry = pl_engine_plumb},
        {.name = "ode",
         .package = "libode-dev",
         .libraries = "libode",
#ifdef PLUMB_HAVE_ODE
         .entry = pl_engine_ode
#endif
        },
        {.name = "bullet",
         .package = "libbullet-dev libbullet-extras-dev",
         .libraries = "libBullet libLinearMath",
#ifdef PLUMB_HAVE_BULLET
         .entry = pl_engine_bullet
#endif
        },
        {.name = "mujoco",
         .package = "libmujoco-dev",
         .libraries = "libmujoco",
#ifdef PLUMB_HAVE_MUJOCO
         .entry = pl_engine_mujoco
#endif
        },
        {.name = "dart",
         .package = "libdart-dev",
         .libraries = "libdart",
#ifdef PLUMB_HAVE_DART
         .entry = pl_engine_dart
#endif
        },
    };
    *count = (int)(sizeof all / sizeof *all);
    return all;
}
