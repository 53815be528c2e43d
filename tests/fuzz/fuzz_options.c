/* Parses any bytes as the command line of every command: words end at a zero or a newline, and the first
 * names the command. Nothing is run. The line is accepted, or answered with help, or refused with exit
 * code 2 and a message on standard error that begins with the command's name.
 *
 * pl_call_parse ends the program where it refuses: a handler of exit(3) jumps back. What is then not
 * freed is no leak. */
#define _GNU_SOURCE

#include "command/request.h"
#include "fuzz.h"

#include <argp.h>
#include <setjmp.h>
#include <stdalign.h>
#include <string.h>

#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define FUZZ_HAS_LSAN 1
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
#define FUZZ_HAS_LSAN 1
#endif
#ifdef FUZZ_HAS_LSAN
#include <sanitizer/lsan_interface.h>
#endif

enum { MOST_WORDS = 64, OPTIONS_SIZE = 1 << 16 };

static const pl_command *const commands[] = {
    &pl_command_compare,     &pl_command_run,   &pl_command_threshold,
    &pl_command_list,        &pl_command_scene, &pl_command_ensemble,
    &pl_command_sweep,       &pl_command_tune,  &pl_command_report,
    &pl_command_metamorphic, &pl_command_gate,  &pl_command_check_engine,
    &pl_command_new_engine,  &pl_command_view,  &pl_command_doctor};

static jmp_buf back;
static int exit_code;
static bool is_parsing;

static void leave(int code, void *unused)
{
    (void)unused;
    if (is_parsing) {
        is_parsing = false;
        exit_code = code;
        longjmp(back, 1);
    }
}

/* Parses the words; -1: they were accepted, else the exit code. */
static int parse(const pl_command *command, int argc, char **argv)
{
    static alignas(max_align_t) unsigned char options[OPTIONS_SIZE];
    const pl_request request = pl_request_default();
    const pl_call call = {
        .command = command, .argc = argc, .argv = argv, .program_argc = argc, .program_argv = argv};
    memset(options, 0, sizeof options);
    memcpy(options, &request, sizeof request);
    unsetenv("PLUMB_PROFILES");
    exit_code = -1;
    argp_err_exit_status = PL_EXIT_USAGE;
    if (setjmp(back) == 0) {
        on_exit(leave, NULL);
        is_parsing = true;
        pl_call_parse(&call, options);
    }
    is_parsing = false;
    return exit_code;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    FILE *const out = stdout, *const err = stderr;
    char *words[MOST_WORDS + 1] = {NULL}, name[64], *message = NULL, *help = NULL;
    char *text = malloc(size + 1);
    size_t length = 0, help_length = 0;
    int count = 0;
    fuzz_check(text != NULL, "there is memory");
    memcpy(text, data, size);
    text[size] = '\0';
    for (size_t i = 0, begin = 0; i <= size && count < MOST_WORDS; ++i) {
        if (text[i] == '\0' || text[i] == '\n') {
            text[i] = '\0';
            words[count++] = text + begin;
            begin = i + 1;
        }
    }
    const pl_command *command =
        commands[(unsigned char)words[0][0] % (sizeof commands / sizeof *commands)];
    for (size_t i = 0; i < sizeof commands / sizeof *commands; ++i) {
        command = strcmp(words[0], commands[i]->name) == 0 ? commands[i] : command;
    }
    snprintf(name, sizeof name, "plumb %s", command->name);
    words[0] = name;
    stderr = open_memstream(&message, &length);
    stdout = open_memstream(&help, &help_length);
#ifdef FUZZ_HAS_LSAN
    __lsan_disable();
#endif
    const int code = parse(command, count, words);
#ifdef FUZZ_HAS_LSAN
    __lsan_enable();
#endif
    fclose(stderr);
    fclose(stdout);
    stderr = err;
    stdout = out;
    fuzz_check(code == -1 || code == PL_EXIT_OK || code == PL_EXIT_USAGE,
               "a line is accepted, answered, or refused with exit code 2");
    fuzz_check(code != PL_EXIT_OK || help_length > 0, "help is on standard output");
    fuzz_check(code != PL_EXIT_USAGE || strncmp(message, name, strlen(name)) == 0,
               "a refusal begins with the command's name");
    free(message);
    free(help);
    free(text);
    return 0;
}
