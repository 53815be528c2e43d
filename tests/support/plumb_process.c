#include "plumb_process.h"

#include "check.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

const char falling_scene[] =
    "{ \"plumb_scene\": 1, \"name\": \"falling\", \"gravity\": [0, 0, -9.81], \"dt\": 0.01,\n"
    "  \"duration\": 0.2,\n"
    "  \"materials\": { \"wood\": { \"friction\": 0.5, \"restitution\": 0 } },\n"
    "  \"bodies\": [\n"
    "    { \"name\": \"floor\", \"static\": true, \"material\": \"wood\",\n"
    "      \"shape\": { \"type\": \"plane\", \"normal\": [0, 0, 1], \"offset\": 0 } },\n"
    "    { \"name\": \"a\", \"mass\": 1, \"material\": \"wood\",\n"
    "      \"shape\": { \"type\": \"sphere\", \"radius\": 0.5 }, \"position\": [0, 0, 5] },\n"
    "    { \"name\": \"b\", \"mass\": 2, \"inertia\": [0.3, 0.2, 0.25], \"material\": \"wood\",\n"
    "      \"shape\": { \"type\": \"sphere\", \"radius\": 0.5 }, \"position\": [3, 0, 5] } ] }\n";

char *path_in(const char *directory, const char *name)
{
    size_t size = strlen(directory) + strlen(name) + 2;
    char *path = malloc(size);
    assert_non_null(path);
    snprintf(path, size, "%s/%s", directory, name);
    return path;
}

char *make_directory(void)
{
    const char *parent = getenv("TMPDIR");
    char *path = path_in(parent == NULL ? "/tmp" : parent, "plumb-test-XXXXXX");
    assert_non_null(mkdtemp(path));
    return path;
}

static void remove_tree(const char *path)
{
    struct stat found;
    DIR *directory = lstat(path, &found) == 0 && S_ISDIR(found.st_mode) ? opendir(path) : NULL;
    if (directory != NULL) {
        for (struct dirent *entry = readdir(directory); entry != NULL; entry = readdir(directory)) {
            if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) {
                char *inside = path_in(path, entry->d_name);
                remove_tree(inside);
                free(inside);
            }
        }
        closedir(directory);
    }
    remove(path);
}

void remove_directory(char *path)
{
    remove_tree(path);
    free(path);
}

void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

char *read_text(const char *path)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        return NULL;
    }
    if (getdelim(&text, &size, '\0', file) < 0) {
        free(text);
        text = strdup("");
    }
    fclose(file);
    return text;
}

workspace make_workspace(void)
{
    workspace w = {.directory = make_directory()};
    w.scene = path_in(w.directory, "scene.json");
    w.out = path_in(w.directory, "report");
    w.results = path_in(w.out, "results.jsonl");
    write_text(w.scene, falling_scene);
    return w;
}

void remove_workspace(workspace *w)
{
    free(w->scene);
    free(w->out);
    free(w->results);
    remove_directory(w->directory);
}

int setup_workspace(void **state)
{
    workspace *w = malloc(sizeof *w);
    assert_non_null(w);
    *w = make_workspace();
    *state = w;
    return 0;
}

int teardown_workspace(void **state)
{
    remove_workspace(*state);
    free(*state);
    return 0;
}

static void redirect(const char *directory, const char *name, int descriptor)
{
    char *path = path_in(directory, name);
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file < 0 || dup2(file, descriptor) < 0) {
        _exit(127);
    }
    close(file);
    free(path);
}

pid_t start_plumb(const char *directory, const char *const *arguments)
{
    enum { MOST_WORDS = 256 };
    char *call[MOST_WORDS] = {(char[]){"plumb"}};
    int count = 1;
    for (; arguments[count - 1] != NULL; ++count) {
        assert_true(count < MOST_WORDS - 1);
        call[count] = strdup(arguments[count - 1]);
        assert_non_null(call[count]);
    }
    fflush(NULL);
    pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        /* A process that runs in the background may ignore these, and its children inherit that. */
        signal(SIGINT, SIG_DFL);
        signal(SIGHUP, SIG_DFL);
        /* An engine's fault is to be seen as it is, also under a sanitizer. */
        setenv("ASAN_OPTIONS", "handle_segv=0:handle_abort=0", 1);
        redirect(directory, "out", STDOUT_FILENO);
        redirect(directory, "err", STDERR_FILENO);
        execv(PLUMB_BINARY_DIR "/plumb", call);
        _exit(127);
    }
    for (int i = 1; i < count; ++i) {
        free(call[i]);
    }
    return pid;
}

plumb_output wait_plumb(const char *directory, pid_t pid)
{
    int status = 0;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    char *out = path_in(directory, "out");
    char *err = path_in(directory, "err");
    plumb_output output = {.code =
                               WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status),
                           .out = read_text(out),
                           .err = read_text(err)};
    free(out);
    free(err);
    /* One killed at once may not have opened them. */
    output.out = output.out == NULL ? strdup("") : output.out;
    output.err = output.err == NULL ? strdup("") : output.err;
    return output;
}

void free_output(plumb_output *output)
{
    free(output->out);
    free(output->err);
}

plumb_output run_plumb(const char *directory, const char *const *arguments)
{
    return wait_plumb(directory, start_plumb(directory, arguments));
}

pid_t start_plumb_words(const workspace *w, const char *text)
{
    enum { MOST_WORDS = 40 };
    char *words = strdup(text);
    char *made[MOST_WORDS] = {NULL};
    const char *arguments[MOST_WORDS + 1] = {NULL};
    int count = 0;
    char *rest = NULL;
    for (char *word = strtok_r(words, " ", &rest); word != NULL;
         word = strtok_r(NULL, " ", &rest)) {
        size_t before = strcspn(word, "@#%");
        const char *stands = word[before] == '@'   ? w->scene
                             : word[before] == '#' ? w->out
                             : word[before] == '%' ? FAULTY
                                                   : "";
        const char *after = word[before] == '\0' ? "" : word + before + 1;
        assert_true(count < MOST_WORDS);
        assert_true(asprintf(&made[count], "%.*s%s%s", (int)before, word, stands, after) >= 0);
        arguments[count] = made[count];
        ++count;
    }
    pid_t pid = start_plumb(w->directory, arguments);
    for (int i = 0; i < count; ++i) {
        free(made[i]);
    }
    free(words);
    return pid;
}

const char *result_text(const json_t *result, const char *key)
{
    const char *text = json_string_value(json_object_get(result, key));
    return text == NULL ? "" : text;
}

const json_t *result_of(const json_t *results, const char *label)
{
    const json_t *found = NULL;
    size_t index;
    const json_t *result;
    json_array_foreach(results, index, result)
    {
        if (strcmp(result_text(result, "label"), label) == 0) {
            assert_null(found);
            found = result;
        }
    }
    if (found == NULL) {
        print_error("there is no result of %s\n", label);
    }
    assert_non_null(found);
    return found;
}
