#include "command.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_OPTIONS = 64 };

/* What argp itself understands. */
static const struct argp_option common_options[] = {{.name = "help", .key = '?'},
                                                    {.name = "usage", .key = 1},
                                                    {.name = "version", .key = 'V'},
                                                    {0}};

static int collect(const struct argp_option *from, const struct argp_option **options, int count)
{
    for (; from != NULL && (from->name != NULL || from->key != 0 || from->doc != NULL); ++from) {
        if (from->name != NULL && count < MAX_OPTIONS) {
            options[count++] = from;
        }
    }
    return count;
}

/* Those of an argp and of its children, and of theirs. */
static int collect_all(const struct argp *argp, const struct argp_option **options, int count)
{
    count = collect(argp->options, options, count);
    for (const struct argp_child *child = argp->children; child != NULL && child->argp != NULL;
         ++child) {
        count = collect_all(child->argp, options, count);
    }
    return count;
}

/* The only option that begins with the first `length` characters of `name`, or is `name`; as getopt
 * has it. *ambiguous when there are several. */
static const struct argp_option *find(const struct argp_option *const *options, int count,
                                      const char *name, size_t length, bool *ambiguous)
{
    const struct argp_option *found = NULL;
    *ambiguous = false;
    for (int i = 0; i < count; ++i) {
        if (strncmp(options[i]->name, name, length) == 0) {
            if (strlen(options[i]->name) == length) {
                *ambiguous = false;
                return options[i];
            }
            *ambiguous = found != NULL;
            found = options[i];
        }
    }
    return found;
}

static void reject_unknown(const pl_call *call, const char *option, size_t length,
                           const struct argp_option *const *options, int count)
{
    char word[PL_NAME_SIZE];
    const char *names[MAX_OPTIONS];
    for (int i = 0; i < count; ++i) {
        names[i] = options[i]->name;
    }
    snprintf(word, sizeof word, "%.*s", (int)length, option);
    const char *nearest = pl_nearest_name(word, names, count);
    fprintf(stderr, "%s: there is no option --%s", call->argv[0], word);
    fprintf(stderr, nearest == NULL ? "; see %s --help\n" : "; did you mean --%s?\n",
            nearest == NULL ? call->argv[0] : nearest);
    exit(PL_EXIT_USAGE);
}

static void check_options(const pl_call *call, const struct argp *argp)
{
    const struct argp_option *options[MAX_OPTIONS];
    int count = collect(common_options, options, 0);
    count = collect_all(argp, options, count);
    for (int i = 1; i < call->argc && strcmp(call->argv[i], "--") != 0; ++i) {
        const char *argument = call->argv[i];
        if (strncmp(argument, "--", 2) == 0) {
            size_t length = strcspn(argument + 2, "=");
            bool ambiguous;
            const struct argp_option *option =
                find(options, count, argument + 2, length, &ambiguous);
            if (option == NULL) {
                reject_unknown(call, argument + 2, length, options, count);
            }
            bool value_follows = !ambiguous && option->arg != NULL && argument[2 + length] != '=';
            i += value_follows;
        }
    }
}

void pl_call_parse(const pl_call *call, const struct argp *argp, void *input)
{
    check_options(call, argp);
    error_t failed = argp_parse(argp, call->argc, call->argv, 0, NULL, input);
    if (failed != 0) {
        fprintf(stderr, "%s: %s\n", call->argv[0], strerror(failed));
        exit(PL_EXIT_FAILED);
    }
}

double pl_option_number(struct argp_state *state, const char *what, const char *text, double min,
                        double max)
{
    double value = 0;
    if (!pl_parse_number(text, &value) || !(value >= min && value <= max)) {
        argp_error(state, "%s, %.4g to %.4g; found \"%s\"", what, min, max, text);
    }
    return value;
}

long pl_option_integer(struct argp_state *state, const char *what, const char *text, long min,
                       long max)
{
    char *end;
    long value = strtol(text, &end, 10);
    if (end == text || *end != '\0' || value < min || value > max) {
        argp_error(state, "%s, %ld to %ld; found \"%s\"", what, min, max, text);
    }
    return value;
}

int pl_call_fail(const pl_call *call, const pl_error *error)
{
    fflush(stdout);
    fprintf(stderr, "%s: %s\n", call->argv[0], error->message);
    return error->status == PL_BAD_INPUT ? PL_EXIT_USAGE : PL_EXIT_FAILED;
}
