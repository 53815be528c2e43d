/* Runs a fuzz target, without libFuzzer, on every file of the folders given as arguments. Prints
 * the number of files; fails when a folder has none. */
#define _POSIX_C_SOURCE 200809L

#include "fuzz.h"

#include <dirent.h>

/* Each input gets memory of exactly its size, so that a sanitizer detects reads past the end. */
static bool replay_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = NULL;
    bool done = false;
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
        goto cleanup;
    }
    const long size = ftell(file);
    rewind(file);
    bytes = size < 0 ? NULL : malloc(size == 0 ? 1 : (size_t)size);
    if (bytes == NULL || fread(bytes, 1, (size_t)size, file) != (size_t)size) {
        goto cleanup;
    }
    LLVMFuzzerTestOneInput(bytes, (size_t)size);
    done = true;
cleanup:
    if (!done) {
        perror(path);
    }
    free(bytes);
    if (file != NULL) {
        fclose(file);
    }
    return done;
}

/* Returns the number of files replayed, -1 after a failure. */
static int replay_folder(const char *folder)
{
    DIR *listing = opendir(folder);
    if (listing == NULL) {
        perror(folder);
        return -1;
    }
    int count = 0;
    const struct dirent *entry;
    while (count >= 0 && (entry = readdir(listing)) != NULL) {
        char path[4096];
        if (entry->d_name[0] == '.') {
            continue;
        }
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        count = replay_file(path) ? count + 1 : -1;
    }
    closedir(listing);
    return count;
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; ++i) {
        const int count = replay_folder(argv[i]);
        printf("%s: %d inputs\n", argv[i], count);
        if (count <= 0) {
            return 1;
        }
    }
    return argc > 1 ? 0 : 1;
}
