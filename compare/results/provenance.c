/* Where a result was made: the processor, the operating system, the compiler and its flags, the
 * version of plumb, and the command. */
#include "result.h"

#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>

/* The text after `key` and any of " \t:=\"" in the first line of `path` that begins with `key`,
 * without the closing quote; empty when there is none. */
static void read_field(const char *path, const char *key, char *text, size_t size)
{
    char line[512];
    text[0] = '\0';
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        return;
    }
    while (text[0] == '\0' && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, key, strlen(key)) == 0) {
            const char *value = line + strlen(key);
            value += strspn(value, " \t:=\"");
            snprintf(text, size, "%.*s", (int)strcspn(value, "\"\n"), value);
        }
    }
    fclose(file);
}

static json_t *host_json(void)
{
    char cpu[256];
    char os[256];
    char kernel_and_os[768];
    struct utsname kernel;
    if (uname(&kernel) != 0) {
        kernel = (struct utsname){.sysname = "unknown", .release = "", .machine = "unknown"};
    }
    read_field("/proc/cpuinfo", "model name", cpu, sizeof cpu);
    read_field("/etc/os-release", "PRETTY_NAME", os, sizeof os);
    snprintf(kernel_and_os, sizeof kernel_and_os, "%s%s%s %s", os, os[0] == '\0' ? "" : ", ",
             kernel.sysname, kernel.release);
    const char *processor = cpu[0] != '\0' ? cpu : kernel.machine;
    return json_pack("{s:o, s:o, s:s, s:s}", "cpu", pl_json_text(processor, strlen(processor)),
                     "os", pl_json_text(kernel_and_os, strlen(kernel_and_os)), "compiler",
                     PLUMB_COMPILER, "flags", PLUMB_FLAGS);
}

json_t *pl_provenance(int argc, char *const *argv)
{
    json_t *command = json_array();
    for (int i = 0; i < argc; ++i) {
        if (json_array_append_new(command, pl_json_text(argv[i], strlen(argv[i]))) != 0) {
            json_decref(command);
            return NULL;
        }
    }
    return json_pack("{s:o, s:{s:s, s:s}, s:o}", "host", host_json(), "plumb", "version",
                     PLUMB_VERSION, "git", PLUMB_GIT, "command", command);
}
