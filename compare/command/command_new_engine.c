/* plumb new-engine DIR: a toy engine that works, to start an engine from: an adapter to be loaded, or
 * with --process a program. */
#include "request.h"

#include "adapters/built_in.h"
#include "base/heap.h"
#include "base/text_buffer.h"
#include "results/store.h"

#include <errno.h>
#include <ftw.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct options {
    pl_request request; /* names: the folder to make */
    const char *name;   /* NULL: after the folder */
    bool process;       /* a program, in place of an adapter */
} options;

/* What is written, from files that compare/CMakeLists.txt builds into the program. */
extern const char pl_engine_c[], pl_sphere_world_h[], pl_sphere_world_c[];
extern const char pl_Makefile[], pl_README_md[], pl__gitignore[];
extern const char pl_engine_py[], pl_engine_mjs[], pl_process_README_md[];
extern const char pl_engine_abi_h[], pl_adapter_helpers_h[], pl_scene_data_h[], pl_status_h[];

typedef struct file {
    const char *path;
    const char *text;
} file;

static const file FILES[] = {
    {"engine.c", pl_engine_c},
    {"sphere_world.h", pl_sphere_world_h},
    {"sphere_world.c", pl_sphere_world_c},
    {"Makefile", pl_Makefile},
    {"README.md", pl_README_md},
    {".gitignore", pl__gitignore},
    {"include/plumb/engine_abi.h", pl_engine_abi_h},
    {"include/plumb/adapter_helpers.h", pl_adapter_helpers_h},
    {"include/plumb/scene_data.h", pl_scene_data_h},
    {"include/plumb/status.h", pl_status_h},
};

static const file PROCESS_FILES[] = {
    {"engine.py", pl_engine_py},
    {"engine.mjs", pl_engine_mjs},
    {"README.md", pl_process_README_md},
};

/* The files of a folder, and the text that is printed before and after its path. */
typedef struct engine_template {
    const file *files; /* (file_count) */
    int file_count;
    const char *before, *after;
} engine_template;

static const engine_template ADAPTER = {
    FILES, sizeof FILES / sizeof *FILES,
    "my_engine: engine.c is the adapter to change, and sphere_world.c a toy engine in the place of "
    "yours. Next:\n\n  cd ",
    " && make\n"
    "  plumb check-engine ./my_engine.so\n"
    "  plumb compare roll-slope bounce --engine ./my_engine.so --engine plumb\n"};
static const engine_template PROCESS = {
    PROCESS_FILES, sizeof PROCESS_FILES / sizeof *PROCESS_FILES,
    "my_engine: engine.py and engine.mjs are the same toy engine in two languages. Keep one, and "
    "put yours in its place. Next:\n\n  cd ",
    "\n  plumb check-engine 'exec:python3 engine.py'\n"
    "  plumb compare cradle collision-train --engine 'exec:python3 engine.py' --engine plumb\n"};

/* What stands for the engine's name in those texts. */
static const char PLACEHOLDER[] = "my_engine";

static const char NAME_CHARACTERS[] =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";

/* A name also names the shared object: it does not begin as an option or a hidden file does. */
static bool is_name(const char *name)
{
    const size_t length = strlen(name);
    return length > 0 && length < PL_NAME_SIZE && strspn(name, NAME_CHARACTERS) == length &&
           name[0] != '-' && name[0] != '.';
}

/* Makes a name of a folder's: other characters become '_'. */
static void name_after(const char *folder, char name[PL_NAME_SIZE])
{
    const char *slash = strrchr(folder, '/');
    snprintf(name, PL_NAME_SIZE, "%s", slash == NULL ? folder : slash + 1);
    for (char *c = name; *c != '\0'; ++c) {
        const bool first = c == name && (*c == '-' || *c == '.');
        *c = first || strchr(NAME_CHARACTERS, *c) == NULL ? '_' : *c;
    }
}

/* Reports call an engine by its name: that of a built-in one would stand for two. */
static pl_status check_not_built_in(const char *name, pl_error *error)
{
    return pl_built_in_find(name) == NULL
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT,
                         "%s is the name of a built-in engine: take another with --name", name);
}

static pl_status check(void *user, pl_error *error)
{
    const options *o = user;
    if (o->request.names.count != 1) {
        return pl_fail(error, PL_BAD_INPUT, "expected one folder to make, found %d",
                       o->request.names.count);
    }
    if (o->name != NULL && !is_name(o->name)) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--name takes up to %d letters, digits, '_', '-' and '.', not beginning "
                       "with '-' or '.'; found \"%s\"",
                       PL_NAME_SIZE - 1, o->name);
    }
    return PL_OK;
}

static pl_status check_target(const char *path, pl_error *error)
{
    const char *slash = strrchr(path, '/');
    const char *base = slash == NULL ? path : slash + 1;
    return strcmp(base, "") == 0 || strcmp(base, ".") == 0 || strcmp(base, "..") == 0
               ? pl_fail(error, PL_BAD_INPUT, "expected the name of a new folder, found \"%s\"",
                         path)
               : PL_OK;
}

/* Adds text with the engine's name in the place of the placeholder. */
static void add_named(pl_text_buffer *out, const char *text, const char *name)
{
    const char *rest = text;
    for (const char *at = strstr(rest, PLACEHOLDER); at != NULL; at = strstr(rest, PLACEHOLDER)) {
        pl_text_add_bytes(out, rest, (size_t)(at - rest));
        pl_text_add(out, name);
        rest = at + strlen(PLACEHOLDER);
    }
    pl_text_add(out, rest);
}

static pl_status write_file(const char *folder, const file *from, const char *name, pl_error *error)
{
    pl_text_buffer out = {0};
    char *path = pl_heap_format("%s/%s", folder, from->path);
    char *end = strrchr(path, '/');
    *end = '\0';
    pl_status status = pl_make_directories(path, error);
    *end = '/';
    if (status == PL_OK) {
        add_named(&out, from->text, name);
        status = pl_write_buffer(path, &out, error);
    }
    free(path);
    return status;
}

static int remove_one(const char *path, const struct stat *found, int kind, struct FTW *place)
{
    (void)found;
    (void)kind;
    (void)place;
    return remove(path);
}

/* Gives the folder its name, which can be that of an empty one. */
static pl_status put_in_place(const char *temporary, const char *path, pl_error *error)
{
    if (rename(temporary, path) == 0) {
        return PL_OK;
    }
    const bool is_full = errno == ENOTEMPTY || errno == EEXIST;
    return is_full || errno == ENOTDIR
               ? pl_fail(error, PL_BAD_INPUT, "%s exists, and is not %s", path,
                         is_full ? "empty" : "a folder")
               : pl_fail(error, PL_IO, "cannot make %s: %s", path, strerror(errno));
}

/* Makes the folder under another name first, so that it is there whole or not at all. */
static pl_status make(const engine_template *of, const char *path, const char *name,
                      pl_error *error)
{
    char *temporary = pl_heap_format("%s.%ld.tmp", path, (long)getpid());
    const bool is_made = mkdir(temporary, 0777) == 0;
    pl_status status =
        is_made ? PL_OK : pl_fail(error, PL_IO, "cannot make %s: %s", path, strerror(errno));
    for (int i = 0; i < of->file_count && status == PL_OK; ++i) {
        status = write_file(temporary, &of->files[i], name, error);
    }
    if (status == PL_OK) {
        status = put_in_place(temporary, path, error);
    }
    if (is_made && status != PL_OK) {
        nftw(temporary, remove_one, 8, FTW_DEPTH | FTW_PHYS);
    }
    free(temporary);
    return status;
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    pl_call_parse(call, &o);
    char folder_name[PL_NAME_SIZE];
    const char *name = o.name != NULL ? o.name : folder_name;
    const engine_template *of = o.process ? &PROCESS : &ADAPTER;
    char *path = pl_heap_copy(o.request.names.items[0]);
    for (size_t n = strlen(path); n > 1 && path[n - 1] == '/'; --n) {
        path[n - 1] = '\0';
    }
    pl_call_need(call, check_target(path, call->error));
    name_after(path, folder_name);
    pl_call_need(call, check_not_built_in(name, call->error));
    pl_call_need(call, make(of, path, name, call->error));
    pl_text_buffer next = {0};
    add_named(&next, of->before, name);
    pl_text_add_shell(&next, path);
    add_named(&next, of->after, name);
    pl_text_print(&next, stdout);
    free(path);
    pl_request_free(&o.request);
    return PL_EXIT_OK;
}

static const pl_option OPTIONS[] = {
    {"name", "NAME", "Of the engine; by default that of the folder", PL_OPTION_TEXT,
     .field = offsetof(options, name), .letter = 'n'},
    {"process", NULL,
     "Write an engine in Python and in JavaScript, which Plumb runs "
     "as a program, in place of an adapter in C",
     PL_OPTION_FLAG, .field = offsetof(options, process), .letter = 'p'},
    {0}};

const pl_command pl_command_new_engine = {
    .name = "new-engine",
    .summary = "write an adapter and a toy engine, to start a plug-in from",
    .arguments = "DIR",
    .description =
        "Makes a folder with an adapter, through which plumb drives an engine, a toy engine of "
        "spheres and planes in C, a Makefile, a README and the headers: to be compiled, checked "
        "and compared as it is. Then calls to an engine of your own replace those to the toy. With "
        "--process, the toy engine is a program that speaks plumb.engine/1.",
    .notes = "Examples:\n"
             "  plumb new-engine --process my-engine\n"
             "  plumb check-engine 'exec:python3 my-engine/engine.py'\n"
             "  plumb new-engine my-engine\n"
             "  make -C my-engine\n"
             "  plumb check-engine my-engine/my-engine.so",
    .options = OPTIONS,
    .check = check,
    .run = run};
