#include "built_in.h"

#include "base/text_buffer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Where the build puts the scripts and, next to them, node_modules. */
static const char FOLDER[] = PLUMB_WEB_FOLDER;

#define WEB(engine, script_with_arguments, npm_package)                                            \
    {                                                                                              \
        .name = (engine), .package = (npm_package), .libraries = "",                               \
        .script = (script_with_arguments), .module = (npm_package)                                 \
    }

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
        {.name = "dart", .package = "libdart-dev", .libraries = "", .path = PLUMB_DART_MODULE},
        WEB("mujoco3", "mujoco3.mjs", "@mujoco/mujoco"),
        WEB("rapier", "rapier.mjs", "@dimforge/rapier3d-compat"),
        WEB("rapier-deterministic", "rapier.mjs deterministic",
            "@dimforge/rapier3d-deterministic-compat"),
        WEB("jolt", "jolt.mjs", "jolt-physics"),
        WEB("physx", "physx.mjs", "physx-js-webidl"),
        WEB("havok", "havok.mjs", "@babylonjs/havok"),
        WEB("cannon", "cannon.mjs", "cannon-es"),
    };
    _Static_assert(sizeof all / sizeof *all <= PL_MOST_BUILT_IN, "PL_MOST_BUILT_IN is too small");
    *count = (int)(sizeof all / sizeof *all);
    return all;
}

/* Whether a shell finds the program. */
static bool has_program(const char *name)
{
    char file[4096];
    const char *folders = getenv("PATH");
    while (folders != NULL && *folders != '\0') {
        const size_t length = strcspn(folders, ":");
        snprintf(file, sizeof file, "%.*s/%s", (int)length, folders, name);
        if (access(file, X_OK) == 0) {
            return true;
        }
        folders += length + (folders[length] == ':');
    }
    return false;
}

bool pl_built_in_is_present(const pl_built_in *built_in)
{
    char path[4096];
    if (built_in->path != NULL) {
        return access(built_in->path, R_OK) == 0;
    }
    if (built_in->script == NULL) {
        return built_in->entry != NULL;
    }
    snprintf(path, sizeof path, "%s/node_modules/%s/package.json", FOLDER, built_in->module);
    return access(path, R_OK) == 0 && has_program("node");
}

bool pl_built_in_command(const pl_built_in *built_in, char *command, size_t size)
{
    if (built_in->script == NULL) {
        return false;
    }
    char path[4096];
    pl_text_buffer text = {0};
    const int length = (int)strcspn(built_in->script, " ");
    snprintf(path, sizeof path, "%s/%.*s", FOLDER, length, built_in->script);
    pl_text_add(&text, "node ");
    pl_text_add_shell(&text, path);
    pl_text_add(&text, built_in->script + length);
    const bool is_written = !text.failed;
    snprintf(command, size, "%s", is_written ? text.data : "");
    pl_text_free(&text);
    return is_written;
}
