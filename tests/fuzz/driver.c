/* Runs a fuzz target without libFuzzer.
 *     test_fuzz_NAME FOLDER...                        replays every file of the folders
 *     test_fuzz_NAME --seconds N --seed S FOLDER...   then tries changed copies of them for N seconds
 * The second form searches blindly, but any compiler builds it. Where the target fails or takes longer
 * than 20 s, the input is written to ./crash-SEED. */
#define _GNU_SOURCE

#include "fuzz.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { LARGEST_INPUT = 1 << 16, LONGEST_INPUT_SECONDS = 20 };

typedef struct bytes {
    uint8_t *data;
    size_t size;
} bytes;

static struct corpus {
    bytes *inputs;
    size_t count, capacity;
} corpus;

/* The input that is being tried, for the handler of fatal signals. */
static bytes tried;
static char crash_path[64];

static void *checked(void *memory)
{
    if (memory == NULL) {
        fputs("out of memory\n", stderr);
        exit(1);
    }
    return memory;
}

/* Each input gets memory of exactly its size, so that a sanitizer detects reads past the end. */
static void try_input(const uint8_t *data, size_t size)
{
    tried.data = checked(malloc(size == 0 ? 1 : size));
    tried.size = size;
    if (size > 0) {
        memcpy(tried.data, data, size);
    }
    alarm(LONGEST_INPUT_SECONDS);
    LLVMFuzzerTestOneInput(tried.data, tried.size);
    alarm(0);
    free(tried.data);
    tried = (bytes){.data = NULL};
}

static void save_tried(int number)
{
    const int file = open(crash_path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (file >= 0 && write(file, tried.data, tried.size) == (ssize_t)tried.size) {
        static const char said[] = "the input is in ./";
        ssize_t ignored = write(STDERR_FILENO, said, sizeof said - 1);
        ignored = write(STDERR_FILENO, crash_path, strlen(crash_path));
        ignored = write(STDERR_FILENO, "\n", 1);
        (void)ignored;
    }
    signal(number, SIG_DFL);
    raise(number);
}

static bool add_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    bytes input = {.data = NULL};
    bool done = false;
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
        goto cleanup;
    }
    const long size = ftell(file);
    if (size < 0) {
        goto cleanup;
    }
    rewind(file);
    input.size = (size_t)size;
    input.data = checked(malloc(input.size + 1));
    if (fread(input.data, 1, input.size, file) != input.size) {
        goto cleanup;
    }
    if (corpus.count == corpus.capacity) {
        corpus.capacity = 2 * corpus.capacity + 16;
        corpus.inputs = checked(realloc(corpus.inputs, corpus.capacity * sizeof *corpus.inputs));
    }
    corpus.inputs[corpus.count++] = input;
    done = true;
cleanup:
    if (!done) {
        perror(path);
        free(input.data);
    }
    if (file != NULL) {
        fclose(file);
    }
    return done;
}

/* In the order of names, so that a seed stands for the same search on every file system. */
static bool add_folder(const char *folder)
{
    struct dirent **entries = NULL;
    const int listed = scandir(folder, &entries, NULL, alphasort);
    if (listed < 0) {
        perror(folder);
        return false;
    }
    const size_t before = corpus.count;
    bool done = true;
    for (int i = 0; i < listed; ++i) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.') {
            done = add_file(path) && done;
        }
        free(entries[i]);
    }
    free(entries);
    printf("%s: %zu inputs\n", folder, corpus.count - before);
    return done && corpus.count > before;
}

/* Marsaglia's xorshift64*. */
static uint64_t random_state;

static size_t below(size_t bound)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return bound == 0 ? 0 : (size_t)((random_state * 0x2545F4914F6CDD1DULL >> 11) % bound);
}

/* Puts `length` bytes at `at`, where `removed` bytes are taken out. Nothing happens where they do not fit. */
static void replace_part(bytes *input, size_t at, size_t removed, const uint8_t *added,
                         size_t length)
{
    if (input->size - removed + length > LARGEST_INPUT) {
        return;
    }
    memmove(input->data + at + length, input->data + at + removed, input->size - at - removed);
    memcpy(input->data + at, added, length);
    input->size += length - removed;
}

static void put_word(bytes *input, size_t at)
{
    static const char *const words[] = {"0",
                                        "-1",
                                        "1e308",
                                        "1e-320",
                                        "-0.0",
                                        "2147483648",
                                        "18446744073709551616",
                                        "0.1",
                                        "null",
                                        "\"\\u0000",
                                        "[",
                                        "]",
                                        "{",
                                        "}",
                                        "\xef\xbb\xbf",
                                        "\n",
                                        "\xc2\x9b",
                                        ",",
                                        "NaN",
                                        "\"",
                                        "9007199254740993"};
    const char *word = words[below(sizeof words / sizeof *words)];
    replace_part(input, at, below(input->size - at + 1) % 8, (const uint8_t *)word, strlen(word));
}

static void change(bytes *input)
{
    static uint8_t copy[LARGEST_INPUT];
    const size_t at = below(input->size + 1);
    const size_t rest = input->size - at;
    const size_t length = 1 + below(below(8) == 0 ? 256 : 12);
    switch (below(6)) {
    case 0: /* a bit */
        if (rest > 0) {
            input->data[at] ^= (uint8_t)(1U << below(8));
        }
        break;
    case 1: /* a byte */
        if (rest > 0) {
            input->data[at] = (uint8_t)below(256);
        }
        break;
    case 2: /* a part is removed */
        replace_part(input, at, rest < length ? rest : length, copy, 0);
        break;
    case 3: /* a part is repeated elsewhere */
        if (rest >= length) {
            memcpy(copy, input->data + at, length);
            replace_part(input, below(input->size + 1), 0, copy, length);
        }
        break;
    case 4: { /* a part of another input */
        const bytes *other = &corpus.inputs[below(corpus.count)];
        const size_t from = below(other->size + 1);
        const size_t most = other->size - from;
        replace_part(input, at, rest < length ? rest : length, other->data + from,
                     most < length ? most : length);
        break;
    }
    default:
        put_word(input, at);
    }
}

static void search(double seconds)
{
    bytes input = {.data = checked(malloc(LARGEST_INPUT))};
    const clock_t end = clock() + (clock_t)(seconds * CLOCKS_PER_SEC);
    long tries = 0;
    for (; clock() < end; ++tries) {
        const bytes *start = &corpus.inputs[below(corpus.count)];
        input.size = start->size < LARGEST_INPUT ? start->size : LARGEST_INPUT;
        memcpy(input.data, start->data, input.size);
        for (size_t changes = 1 + below(8); changes > 0; --changes) {
            change(&input);
        }
        try_input(input.data, input.size);
    }
    free(input.data);
    printf("%ld changed inputs\n", tries);
}

int main(int argc, char **argv)
{
    double seconds = 0;
    unsigned long long seed = 1;
    int first = 1;
    for (; first + 1 < argc && argv[first][0] == '-'; first += 2) {
        if (strcmp(argv[first], "--seconds") == 0) {
            seconds = strtod(argv[first + 1], NULL);
        } else if (strcmp(argv[first], "--seed") == 0) {
            seed = strtoull(argv[first + 1], NULL, 10);
        } else {
            fprintf(stderr, "unknown option %s\n", argv[first]);
            return 2;
        }
    }
    snprintf(crash_path, sizeof crash_path, "crash-%llu", seed);
    random_state = seed * 0x9E3779B97F4A7C15ULL + 1;
    static const int fatal[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM};
    for (size_t i = 0; i < sizeof fatal / sizeof *fatal; ++i) {
        signal(fatal[i], save_tried);
    }
    bool done = first < argc;
    for (int i = first; i < argc; ++i) {
        done = add_folder(argv[i]) && done;
    }
    for (size_t i = 0; i < corpus.count; ++i) {
        try_input(corpus.inputs[i].data, corpus.inputs[i].size);
    }
    if (done && seconds > 0) {
        search(seconds);
    }
    for (size_t i = 0; i < corpus.count; ++i) {
        free(corpus.inputs[i].data);
    }
    free(corpus.inputs);
    return done ? 0 : 1;
}
