#include "file_beneath.h"

#include "text_buffer.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* No FIFO or device keeps the caller waiting. */
enum { READING = O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC };

static const char *folder_name(const char *folder)
{
    return folder[0] == '\0' ? "." : folder;
}

/* What is left of `path` behind the folder, which ends with no slash but for "/"; NULL when it is
 * not below it. */
static const char *behind(const char *folder, const char *path)
{
    size_t length = strlen(folder);
    length -= length > 0 && folder[length - 1] == '/';
    return strncmp(folder, path, length) == 0 && path[length] == '/' && path[length + 1] != '\0'
               ? path + length + 1
               : NULL;
}

int pl_open_by_real_name(const char *folder, const char *path)
{
    pl_text_buffer whole = {0};
    pl_text_add(&whole, folder_name(folder));
    pl_text_add(&whole, "/");
    pl_text_add(&whole, path);
    char *root = whole.failed ? NULL : realpath(folder_name(folder), NULL);
    char *real = root == NULL ? NULL : realpath(whole.data, NULL);
    int found = -1;
    if (real != NULL && behind(root, real) == NULL) {
        errno = EXDEV;
    } else if (real != NULL) {
        struct stat named, opened;
        found = open(real, READING | O_NOFOLLOW);
        if (found >= 0 && (lstat(real, &named) != 0 || fstat(found, &opened) != 0 ||
                           named.st_dev != opened.st_dev || named.st_ino != opened.st_ino)) {
            close(found);
            found = -1;
            errno = EXDEV; /* it was changed meanwhile */
        }
    }
    const int reason = errno;
    free(root);
    free(real);
    pl_text_free(&whole);
    errno = reason;
    return found;
}

static int open_relative(const char *folder, const char *path)
{
    struct open_how how = {.flags = READING, .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
    const int root = open(folder_name(folder), O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (root < 0) {
        return -1;
    }
    const int found = (int)syscall(SYS_openat2, root, path, &how, sizeof how);
    const int reason = errno;
    close(root);
    errno = reason;
    const bool is_unknown = found < 0 && (reason == ENOSYS || reason == EPERM || reason == E2BIG);
    return is_unknown ? pl_open_by_real_name(folder, path) : found;
}

/* Opens a path below the folder; -1 with errno, EXDEV where it is elsewhere. */
static int open_below(const char *folder, const char *path)
{
    if (path[0] != '/') {
        return open_relative(folder, path);
    }
    char *root = realpath(folder_name(folder), NULL);
    const char *rest = root == NULL ? NULL : behind(root, path);
    const int found = rest == NULL ? -1 : open_relative(root, rest);
    const int reason = rest == NULL ? EXDEV : errno;
    free(root);
    errno = reason;
    return found;
}

/* The same for the folders that are allowed, where the path may lead out of its own. */
static int open_allowed(const char *folder, const char *path)
{
    const char *allowed = getenv(PL_ALLOWED_VARIABLE);
    if (allowed == NULL || allowed[0] == '\0') {
        errno = EXDEV;
        return -1;
    }
    pl_text_buffer whole = {0}, one = {0};
    pl_text_add(&whole, path[0] == '/' ? "" : folder_name(folder));
    pl_text_add(&whole, path[0] == '/' ? "" : "/");
    pl_text_add(&whole, path);
    char *real = whole.failed ? NULL : realpath(whole.data, NULL);
    int found = -1, reason = errno;
    for (const char *at = allowed; real != NULL && found < 0 && *at != '\0';) {
        const size_t length = strcspn(at, ":");
        one.length = 0;
        pl_text_add_bytes(&one, at, length);
        found = length == 0 || one.failed ? -1 : open_below(one.data, real);
        reason = found >= 0 ? 0 : EXDEV;
        at += length + (at[length] == ':');
    }
    free(real);
    pl_text_free(&whole);
    pl_text_free(&one);
    errno = reason;
    return found;
}

static const char *kind_of(mode_t mode)
{
    return S_ISDIR(mode)    ? "a directory"
           : S_ISFIFO(mode) ? "a FIFO"
           : S_ISSOCK(mode) ? "a socket"
                            : "a device";
}

pl_status pl_file_open_beneath(const char *noun, const char *folder, const char *path,
                               const char *label, int *descriptor, pl_error *error)
{
    int found = open_below(folder, path);
    if (found < 0 && (errno == EXDEV || errno == ELOOP)) {
        found = open_allowed(folder, path);
    }
    if (found < 0 && (errno == EXDEV || errno == ELOOP)) {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s: expected a %s file below the scene's folder, found one elsewhere; "
                       "--allow-files DIR allows those below DIR",
                       label, noun);
    }
    if (found < 0) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected a %s file, found %s", label, noun,
                       errno == ENXIO    ? "a socket or a device"
                       : errno == ENOENT ? "none to read"
                                         : strerror(errno));
    }
    struct stat status = {.st_mode = 0};
    if (fstat(found, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(found);
        return pl_fail(error, PL_BAD_INPUT, "%s: expected a %s file, found %s", label, noun,
                       kind_of(status.st_mode));
    }
    *descriptor = found;
    return PL_OK;
}
