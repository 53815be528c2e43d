/* The command line: options by their tables, with argp(3) underneath; and the ends of commands. */
#include "command.h"

#include "base/diagnostic.h"
#include "base/folding.h"
#include "base/hash.h"
#include "base/heap.h"
#include "request.h"
#include "results/result.h"

#include <argp.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FIRST_KEY = 0x100, HELP_OPTION = 0, USAGE_OPTION = 1 };

/* Options that argp itself understands, with its help. */
const pl_option pl_common_options[PL_COMMON_OPTIONS + 1] = {
    {.name = "help", .help = "Give this help list", .letter = '?'},
    {.name = "usage", .help = "Give a short usage message"},
    {.name = "version", .help = "Print program version", .letter = 'V'},
    {0}};

/* A command line that is being parsed. */
typedef struct parsing {
    const pl_call *call;
    void *options;
    pl_option table[PL_MOST_OPTIONS]; /* (count) all options of the command */
    int count;
    struct argp_option argp[PL_MOST_OPTIONS + 1]; /* (count) the same for argp, and a zero */
    const char *explains; /* "--help" or "--usage", which the command line asks for; NULL: none */
    FILE *explanation;    /* where argp writes that */
} parsing;

void pl_texts_add(pl_texts *texts, const char *item)
{
    pl_push(&texts->items, &texts->count, &item, sizeof item);
}

/* ---- Tables of options ---- */

/* Adds the options of a table (NULL: none). */
static void collect(const pl_option *table, pl_option options[PL_MOST_OPTIONS], int *count)
{
    for (const pl_option *option = table; option != NULL && option->name != NULL; ++option) {
        if (option->kind != PL_OPTION_HELP && *count < PL_MOST_OPTIONS) {
            options[(*count)++] = *option;
        }
    }
}

int pl_command_options(const pl_command *command, pl_option options[PL_MOST_OPTIONS])
{
    int count = 0;
    collect(command->options, options, &count);
    for (int i = 0; i < PL_SHARED_OPTIONS; ++i) {
        collect(command->shared[i], options, &count);
    }
    collect(pl_common_options, options, &count);
    for (const pl_option *own = command->options; own != NULL && own->name != NULL; ++own) {
        if (own->kind == PL_OPTION_HELP) {
            const int found = pl_option_find(options, count, own->name, strlen(own->name));
            if (found >= 0) {
                options[found].help = own->help;
            }
        }
    }
    return count;
}

int pl_option_find(const pl_option *options, int count, const char *name, size_t length)
{
    int found = -1;
    for (int i = 0; i < count; ++i) {
        const char *other = options[i].name;
        if (strncmp(other, name, length) == 0) {
            if (strlen(other) == length) {
                return i;
            }
            found = found == -1 ? i : -2;
        }
    }
    return found;
}

/* Lists the options, for argp too. */
static void list_options(parsing *p)
{
    p->count = pl_command_options(p->call->command, p->table);
    for (int i = 0; i < p->count - PL_COMMON_OPTIONS; ++i) {
        const pl_option *option = &p->table[i];
        p->argp[i] =
            (struct argp_option){.name = option->name,
                                 .key = option->letter != 0 ? option->letter : FIRST_KEY + i,
                                 .arg = option->argument,
                                 .doc = option->help};
    }
}

static void reject_unknown(const parsing *p, const char *option, size_t length)
{
    char word[PL_NAME_SIZE];
    const char *names[PL_MOST_OPTIONS];
    for (int i = 0; i < p->count; ++i) {
        names[i] = p->table[i].name;
    }
    snprintf(word, sizeof word, "%.*s", (int)length, option);
    const char *nearest = pl_nearest_name(word, names, p->count);
    const char *self = p->call->argv[0];
    pl_print_line(stderr,
                  nearest == NULL ? "%s: there is no option --%s; see %s --help"
                                  : "%s: there is no option --%s; did you mean --%s?",
                  self, word, nearest == NULL ? self : nearest);
    exit(PL_EXIT_USAGE);
}

/* Ends the program at the first unknown option, with a suggestion, which argp does not make. Notes
 * whether help is asked for. */
static void check_options(parsing *p)
{
    const pl_call *call = p->call;
    for (int i = 1; i < call->argc && strcmp(call->argv[i], "--") != 0; ++i) {
        const char *argument = call->argv[i];
        if (strncmp(argument, "--", 2) == 0) {
            size_t length = strcspn(argument + 2, "=");
            const int found = pl_option_find(p->table, p->count, argument + 2, length);
            if (found == -1) {
                reject_unknown(p, argument + 2, length);
            }
            const int common = found - (p->count - PL_COMMON_OPTIONS);
            if (common == HELP_OPTION || common == USAGE_OPTION) {
                p->explains = common == HELP_OPTION ? "--help" : "--usage";
            }
            const bool takes_argument = found >= 0 && p->table[found].argument != NULL;
            i += takes_argument && argument[2 + length] != '=';
        }
    }
}

/* ---- Parsing ---- */

static double parse_number(const pl_option *option, const char *text, struct argp_state *state)
{
    double value = 0;
    char quoted[PL_QUOTED_SIZE];
    if (!pl_parse_number(text, &value) || !(value >= option->min && value <= option->max)) {
        argp_error(state, "--%s takes %s, %.4g to %.4g; found %s", option->name, option->takes,
                   option->min, option->max, pl_quoted(text, quoted));
    }
    return option->scale != 0 ? value * option->scale : value;
}

static long parse_integer(const pl_option *option, const char *text, struct argp_state *state)
{
    char *end, quoted[PL_QUOTED_SIZE];
    long value = strtol(text, &end, 10), min = (long)option->min, max = (long)option->max;
    if (end == text || *end != '\0' || value < min || value > max) {
        argp_error(state, "--%s takes an integer, %ld to %ld; found %s", option->name, min, max,
                   pl_quoted(text, quoted));
    }
    return value;
}

/* The place of the word among the values of an option. */
static int parse_choice(const pl_option *option, const char *text, struct argp_state *state)
{
    char words[256] = "", quoted[PL_QUOTED_SIZE];
    size_t length = 0;
    int index = 0;
    for (const char *word = option->values; *word != '\0'; ++index) {
        const size_t size = strcspn(word, "|");
        if (strlen(text) == size && strncmp(text, word, size) == 0) {
            return index;
        }
        const char *next = word + size + (word[size] == '|');
        const char *between = index == 0 ? "" : *next == '\0' ? " or " : ", ";
        length += (size_t)snprintf(words + length, sizeof words - length, "%s%.*s", between,
                                   (int)size, word);
        word = next;
    }
    argp_error(state, "--%s takes %s; found %s", option->name, words, pl_quoted(text, quoted));
    return 0;
}

static void set_option(const pl_option *option, void *options, const char *text,
                       struct argp_state *state)
{
    void *field = (char *)options + option->field;
    pl_error error = {.message = ""};
    switch (option->kind) {
    case PL_OPTION_FLAG:
        *(bool *)field = true;
        break;
    case PL_OPTION_TEXT:
        *(const char **)field = text;
        break;
    case PL_OPTION_TEXTS:
        pl_texts_add(field, text);
        break;
    case PL_OPTION_NUMBER:
        *(double *)field = parse_number(option, text, state);
        break;
    case PL_OPTION_INTEGER:
        *(int *)field = (int)parse_integer(option, text, state);
        break;
    case PL_OPTION_LARGE:
        *(uint64_t *)field = (uint64_t)parse_integer(option, text, state);
        break;
    case PL_OPTION_CHOICE:
        *(int *)field = parse_choice(option, text, state);
        break;
    case PL_OPTION_PARSED:
        if (option->parse(options, text, &error) != PL_OK) {
            argp_error(state, "%s", error.message);
        }
        break;
    case PL_OPTION_HELP:
        break;
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    const parsing *p = state->input;
    pl_request *request = p->options;
    pl_error error = {.message = ""};
    if (p->explains != NULL) {
        state->out_stream = p->explanation;
        state->flags |= ARGP_NO_EXIT;
        return key == ARGP_KEY_INIT || key == ARGP_KEY_END ? 0 : ARGP_ERR_UNKNOWN;
    }
    for (int i = 0; i < p->count - PL_COMMON_OPTIONS; ++i) {
        if (p->argp[i].key == key) {
            set_option(&p->table[i], p->options, text, state);
            return 0;
        }
    }
    if (key == ARGP_KEY_ARG) {
        pl_texts_add(&request->names, text);
        return 0;
    }
    if (key == ARGP_KEY_END && request->resume && request->force) {
        argp_error(state, "--resume keeps what is there, and --force replaces it: give one");
    }
    if (key == ARGP_KEY_END && p->call->command->check != NULL &&
        p->call->command->check(p->options, &error) != PL_OK) {
        argp_error(state, "%s", error.message);
    }
    return key == ARGP_KEY_END ? 0 : ARGP_ERR_UNKNOWN;
}

/* Writes the command's own list before its notes. argp frees what is not the text itself. */
static char *filter_help(int key, const char *text, void *input)
{
    const parsing *p = input;
    char *made = NULL;
    size_t length = 0;
    bool is_notes = key == ARGP_KEY_HELP_POST_DOC && p->call->command->list != NULL;
    FILE *stream = is_notes ? open_memstream(&made, &length) : NULL;
    if (stream == NULL) {
        return (char *)text;
    }
    p->call->command->list(stream);
    fprintf(stream, "\n%s", text);
    return fclose(stream) == 0 ? made : (char *)text;
}

void pl_call_parse(const pl_call *call, void *options)
{
    const pl_command *command = call->command;
    parsing p = {.call = call, .options = options};
    list_options(&p);
    check_options(&p);
    char *doc = pl_heap_format("%s\v%s", command->description, command->notes);
    const struct argp argp = {.options = p.argp,
                              .parser = parse,
                              .args_doc = command->arguments,
                              .doc = doc,
                              .help_filter = filter_help};
    pl_folding folding;
    char *alone[] = {call->argv[0], (char *)p.explains, NULL};
    if (p.explains != NULL) {
        p.explanation = pl_folding_begin(&folding, stdout);
    }
    error_t failed = argp_parse(&argp, p.explains != NULL ? 2 : call->argc,
                                p.explains != NULL ? alone : call->argv, 0, NULL, &p);
    free(doc);
    if (p.explains != NULL) {
        pl_folding_end(&folding);
        exit(PL_EXIT_OK);
    }
    if (failed != 0) {
        pl_print_line(stderr, "%s: %s", call->argv[0], strerror(failed));
        exit(PL_EXIT_FAILED);
    }
}

/* ---- Ends of commands ---- */

int pl_call_nothing(const pl_call *call, const char *why)
{
    pl_print_line(stderr, "%s: %s", call->argv[0], why);
    return PL_EXIT_NOTHING;
}

int pl_call_end_store(const pl_call *call, pl_store *store, const char *folder, pl_status status,
                      int signal_number, int code)
{
    const size_t count = store == NULL ? 0 : json_array_size(pl_store_results(store));
    if (store != NULL && (signal_number != 0 || (status != PL_OK && count > 0))) {
        pl_print_line(
            stderr,
            "%s: not finished; %zu results are in %s/results.jsonl: the same command with "
            "--resume goes on from there",
            call->argv[0], count, folder);
    }
    pl_store_close(store);
    if (status != PL_OK) {
        pl_print_line(stderr, "%s: %s", call->argv[0], call->error->message);
        return call->error->status == PL_BAD_INPUT ? PL_EXIT_USAGE : PL_EXIT_FAILED;
    }
    return signal_number != 0 ? 128 + signal_number : code;
}

/* The results that are being made; NULL: none. */
static pl_store *open_store;
static const char *open_folder;

pl_store *pl_request_open_store(const pl_call *call, const pl_request *request,
                                const char *const *others)
{
    const pl_store_mode mode = pl_store_mode_of(request->resume, request->force);
    pl_call_need(call, pl_store_open(request->out, mode, others, &open_store, call->error));
    open_folder = request->out;
    return open_store;
}

void pl_call_check_end(const pl_call *call, pl_status status, int signal_number)
{
    if (status != PL_OK || signal_number != 0) {
        exit(pl_call_end_store(call, open_store, open_folder, status, signal_number, 0));
    }
}

void pl_call_need(const pl_call *call, pl_status status)
{
    pl_call_check_end(call, status, 0);
}

void pl_call_print_json(const json_t *value)
{
    json_dumpf(value, stdout, JSON_INDENT(1) | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
    putchar('\n');
}

json_t *pl_call_provenance(const pl_call *call)
{
    return pl_provenance(call->program_argc, call->program_argv);
}
