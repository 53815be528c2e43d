#include "built_in.h"

#include "base/text_buffer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_ROOM = PL_BUILT_IN_PATH };

/* Finds the folder of the files that come with the program: that of the installation, or else that of
 * the build, which is next to the program. Returns whether the program is installed. */
static bool find_own_folder(char folder[PATH_ROOM])
{
    static const char *const places[] = {PLUMB_LIBRARY_FOLDER, "lib/plumb"};
    char program[PATH_ROOM / 2] = "", probe[PATH_ROOM + 32];
    (void)!readlink("/proc/self/exe", program, sizeof program - 1);
    char *slash = strrchr(program, '/');
    if (slash != NULL) {
        *slash = '\0';
    }
    bool is_installed = true;
    for (size_t i = 0; i < sizeof places / sizeof *places; ++i) {
        is_installed = i == 0;
        snprintf(folder, PATH_ROOM, "%s/%s", program, places[i]);
        snprintf(probe, sizeof probe, "%s/web/package.json", folder);
        if (access(probe, R_OK) == 0) {
            break;
        }
    }
    return is_installed;
}

static bool has_module(const char *folder, const char *module)
{
    char path[PATH_ROOM + 256];
    snprintf(path, sizeof path, "%s/node_modules/%s/package.json", folder, module);
    return access(path, R_OK) == 0;
}

/* Finds the folder of the scripts that has the npm package of the engine next to them: the program's own, or
 * the user's, where the script get-engines puts them. Returns whether one has it; else it is the program's. */
static bool find_web_folder(const pl_built_in *built_in, char folder[PATH_ROOM])
{
    char own[PATH_ROOM];
    find_own_folder(own);
    const char *data = getenv("XDG_DATA_HOME"), *home = getenv("HOME");
    if (data != NULL && data[0] != '\0') {
        snprintf(folder, PATH_ROOM, "%s/plumb/web", data);
    } else {
        snprintf(folder, PATH_ROOM, "%s/.local/share/plumb/web", home == NULL ? "" : home);
    }
    const bool users = has_module(folder, built_in->package);
    snprintf(own + strlen(own), sizeof own - strlen(own), "/web");
    const bool owns = has_module(own, built_in->package);
    if (owns || !users) {
        snprintf(folder, PATH_ROOM, "%s", own);
    }
    return owns || users;
}

const pl_built_in *pl_built_in_engines(int *count)
{
    *count = pl_built_in_count;
    return pl_built_in_table;
}

const pl_built_in *pl_built_in_find(const char *name)
{
    for (int i = 0; i < pl_built_in_count; ++i) {
        if (strcmp(pl_built_in_table[i].name, name) == 0) {
            return &pl_built_in_table[i];
        }
    }
    return NULL;
}

bool pl_built_in_path(const pl_built_in *built_in, char *path, size_t size)
{
    char folder[PATH_ROOM];
    if (!built_in->is_module) {
        return false;
    }
    find_own_folder(folder);
    snprintf(path, size, "%s/%s.so", folder, built_in->name);
    return true;
}

void pl_engine_family(const char *name, char family[PL_FAMILY_SIZE])
{
    const pl_built_in *known = pl_built_in_find(name);
    if (known != NULL && known->family != NULL) {
        name = known->family;
    }
    const size_t letters = strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
    snprintf(family, PL_FAMILY_SIZE, "%.*s", (int)letters, name);
}

bool pl_has_program(const char *name)
{
    char file[4096];
    const char *folders = getenv("PATH");
    if (strchr(name, '/') != NULL) {
        return access(name, X_OK) == 0;
    }
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
    char path[PATH_ROOM];
    if (pl_built_in_path(built_in, path, sizeof path)) {
        return access(path, R_OK) == 0;
    }
    if (built_in->script == NULL) {
        return built_in->entry != NULL;
    }
    return find_web_folder(built_in, path) && pl_has_program("node");
}

bool pl_built_in_command(const pl_built_in *built_in, char *command, size_t size)
{
    if (built_in->script == NULL) {
        return false;
    }
    char path[PATH_ROOM];
    pl_text_buffer text = {0};
    const int length = (int)strcspn(built_in->script, " ");
    find_web_folder(built_in, path);
    snprintf(path + strlen(path), sizeof path - strlen(path), "/%.*s", length, built_in->script);
    pl_text_add(&text, "node ");
    pl_text_add_shell(&text, path);
    pl_text_add(&text, built_in->script + length);
    const bool is_written = !text.failed;
    snprintf(command, size, "%s", is_written ? text.data : "");
    pl_text_free(&text);
    return is_written;
}

void pl_built_in_how_to_get(const pl_built_in *built_in, char *text, size_t size)
{
    char folder[PATH_ROOM];
    if (!find_own_folder(folder)) {
        snprintf(text, size, "./compare/run --with %s", built_in->name);
    } else if (built_in->script != NULL) {
        snprintf(text, size, "%s/web/get-engines", folder);
    } else if (built_in->is_module) {
        snprintf(text, size, "apt-get install plumb-%s", built_in->name);
    } else {
        snprintf(text, size, "a build with %s", built_in->package);
    }
}
