/* The engines that this program can have built in. */
#ifndef PLUMB_BUILT_IN_H
#define PLUMB_BUILT_IN_H

#include "plumb/engine_abi.h"

/* A built-in engine: one that is linked to the program, a shared object that comes with it, or a script
 * that node runs. The build makes the table of them from adapters/NAME/engine.json. */
typedef struct pl_built_in {
    const char *name;
    const char
        *family; /* engines that share code with it have the same; NULL: see pl_engine_family */
    const char *package;   /* the Debian packages or the npm package that provide it; "": none */
    const char *libraries; /* base names of its shared libraries begin with one of these, separated
                              by blanks; "": it has none */
    pl_engine_entry entry; /* NULL: absent from this build, or not linked */
    bool is_module;        /* it is the shared object of pl_built_in_path */
    const char *script;    /* with arguments, which node runs; NULL: it is none */
} pl_built_in;

/* The table that the build makes, in the order of reports. */
extern const pl_built_in pl_built_in_table[];
extern const int pl_built_in_count;

/* The spec of the engine that makes converged references. */
extern const char pl_reference_engine[];

/* Whether the engine can be run here: it is linked, its shared object was built, or node and its npm
 * package are installed. */
bool pl_built_in_is_present(const pl_built_in *built_in);

enum { PL_BUILT_IN_PATH = 4096 };

/* The path of an engine that is a shared object, in `path` of that size; it may be absent. False: the
 * engine is none. */
bool pl_built_in_path(const pl_built_in *built_in, char *path, size_t size);

/* Whether a shell finds the program of that name or path. */
bool pl_has_program(const char *name);

/* The command that runs an engine that is a program, in `command` of that size; false: it is linked, or
 * memory is out. */
bool pl_built_in_command(const pl_built_in *built_in, char *command, size_t size);

enum { PL_HOW_TO_GET = 4200 };

/* Writes what gets an absent engine: for the installed program, or for the one in its build. */
void pl_built_in_how_to_get(const pl_built_in *built_in, char *text, size_t size);

enum { PL_FAMILY_SIZE = 16 };

/* Writes the family of the engine of that name. Engines of two families share no code, so that one confirms
 * the other. It is that of the table, or else the letters that the name begins with: two builds of one
 * engine are one family. */
void pl_engine_family(const char *name, char family[PL_FAMILY_SIZE]);

/* More than there are. */
enum { PL_MOST_BUILT_IN = 24 };

/* All of them in the order of reports, absent ones too. Static storage. */
const pl_built_in *pl_built_in_engines(int *count);

/* The one of that name; NULL: there is none. */
const pl_built_in *pl_built_in_find(const char *name);

#endif
