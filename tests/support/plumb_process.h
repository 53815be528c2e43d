/* Runs the plumb command as a user does, and keeps what it printed. */
#ifndef PLUMB_TEST_PLUMB_PROCESS_H
#define PLUMB_TEST_PLUMB_PROCESS_H

#include <jansson.h>
#include <sys/types.h>

/* A new empty directory under the system's temporary one; the test fails when there is none to be
 * had. The caller frees the path and the directory with remove_directory. */
char *make_directory(void);
void remove_directory(char *path);

/* directory + "/" + name; malloc'd. */
char *path_in(const char *directory, const char *name);

void write_text(const char *path, const char *text);

/* The whole file, malloc'd and zero-terminated; NULL when there is none. */
char *read_text(const char *path);

typedef struct plumb_output {
    int code;        /* exit code; 128 + N when ended by signal N */
    char *out, *err; /* malloc'd */
} plumb_output;

/* Starts `plumb ARGUMENT...` (NULL-terminated) with its output in DIRECTORY/out and /err. */
pid_t start_plumb(const char *directory, const char *const *arguments);

/* Waits for it. The caller frees the output by free_output. */
plumb_output wait_plumb(const char *directory, pid_t pid);
void free_output(plumb_output *output);

/* Both in one. */
plumb_output run_plumb(const char *directory, const char *const *arguments);

/* Two spheres in free fall over a plane, 20 steps of 0.01 s: a scene for faulty_engine.c. */
extern const char falling_scene[];

/* The engine of faulty_engine.c. */
#define FAULTY PLUMB_BINARY_DIR "/faulty_engine.so"

/* A new directory with falling_scene in it. */
typedef struct workspace {
    char *directory, *scene; /* the scene's path */
    char *out, *results;     /* for --out, not made yet, and results.jsonl in it */
} workspace;

workspace make_workspace(void);
void remove_workspace(workspace *w);

/* A cmocka setup and teardown: *state is a workspace. */
int setup_workspace(void **state);
int teardown_workspace(void **state);

/* Starts "plumb A B C" given as one text of at most 40 words, where @ stands for the scene file, #
 * for the directory of results and % for the faulty engine. */
pid_t start_plumb_words(const workspace *w, const char *text);

/* The result of the engine called `label` in an array of results; the test fails when there is not
 * exactly one. */
const json_t *result_of(const json_t *results, const char *label);

/* The text of a key, or "". */
const char *result_text(const json_t *result, const char *key);

#endif
