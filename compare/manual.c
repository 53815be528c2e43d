/* Prints the manual page plumb(1) in man(7)'s macros, from plumb.1.in and the tables of the commands:
 * plumb_manual > plumb.1. The environment variable SOURCE_DATE_EPOCH gives its date; without it the
 * page has none. */
#include "command/command.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* The page without what the tables have. A line "@PART" stands for a part below. */
extern const char pl_plumb_1_in[];

/* ---- Text ---- */

/* Prints text (length) of one line as it is, whatever it has that is special in roff. */
static void print_part(const char *text, size_t length)
{
    static const struct {
        char character;
        const char *escape;
    } specials[] = {{'\\', "\\(rs"}, {'-', "\\-"},   {'\'', "\\(aq"}, {'`', "\\(ga"},
                    {'^', "\\(ha"},  {'~', "\\(ti"}, {'"', "\\(dq"}};
    if (length > 0 && text[0] == '.') {
        fputs("\\&", stdout);
    }
    for (size_t i = 0; i < length; ++i) {
        const char *escape = NULL;
        for (size_t k = 0; k < sizeof specials / sizeof specials[0]; ++k) {
            escape = specials[k].character == text[i] ? specials[k].escape : escape;
        }
        if (escape != NULL) {
            fputs(escape, stdout);
        } else {
            putchar(text[i]);
        }
    }
}

static void print_text(const char *text)
{
    print_part(text, strlen(text));
}

static void print_bold(const char *text)
{
    fputs("\\fB", stdout);
    print_text(text);
    fputs("\\fR", stdout);
}

/* Prints the lines of a text: an empty one ends a paragraph, and indented ones are examples, which
 * keep their lines. */
static void print_lines(const char *text)
{
    bool in_example = false;
    for (const char *line = text; *line != '\0';) {
        const size_t length = strcspn(line, "\n");
        const bool is_example = line[0] == ' ';
        if (is_example && !in_example) {
            fputs(".PP\n.RS 4\n.nf\n", stdout);
        } else if (in_example && !is_example) {
            fputs(".fi\n.RE\n.PP\n", stdout);
        }
        const size_t blanks = strspn(line, " ");
        if (length > 0) {
            print_part(line + blanks, length - blanks);
            putchar('\n');
        } else if (!in_example) {
            fputs(".PP\n", stdout);
        }
        in_example = is_example;
        line += length + (line[length] == '\n');
    }
    fputs(in_example ? ".fi\n.RE\n" : "", stdout);
}

static void print_paragraphs(const char *text)
{
    fputs(".PP\n", stdout);
    print_lines(text);
}

static void print_entry(const char *term, const char *text)
{
    fputs(".TP\n", stdout);
    print_bold(term);
    putchar('\n');
    print_text(text);
    putchar('\n');
}

/* ---- Commands ---- */

static void print_option(const pl_option *option)
{
    fputs(".TP\n", stdout);
    if (option->letter != 0) {
        const char letter[] = {'-', option->letter, '\0'};
        print_bold(letter);
        fputs(", ", stdout);
    }
    fputs("\\fB\\-\\-", stdout);
    print_text(option->name);
    fputs("\\fR", stdout);
    if (option->argument != NULL) {
        fputs("=\\fI", stdout);
        print_text(option->argument);
        fputs("\\fR", stdout);
    }
    putchar('\n');
    print_text(option->help);
    putchar('\n');
}

/* Prints a command's own list: a title, then lines of a name and what it is. */
static void print_list(const pl_command *command)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (stream == NULL) {
        exit(PL_EXIT_FAILED);
    }
    command->list(stream);
    if (fclose(stream) != 0) {
        exit(PL_EXIT_FAILED);
    }
    for (char *rest = text, *line; (line = strtok_r(NULL, "\n", &rest)) != NULL;) {
        char *name = line + strspn(line, " ");
        if (name == line) {
            print_paragraphs(line);
            continue;
        }
        char *end = name + strcspn(name, " ");
        char *meaning = end + strspn(end, " ");
        *end = '\0';
        print_entry(name, meaning);
    }
    free(text);
}

/* Prints a line for each way to call the command. */
static void print_usage(const pl_command *command, bool has_options)
{
    const char *way = command->arguments;
    do {
        const size_t length = strcspn(way, "\n");
        fputs(way == command->arguments ? "" : ".br\n", stdout);
        fputs("\\fBplumb ", stdout);
        print_text(command->name);
        fputs(has_options ? "\\fR [\\fIOPTION\\fR...]" : "\\fR", stdout);
        if (length > 0) {
            putchar(' ');
            print_part(way, length);
        }
        putchar('\n');
        way += length + (way[length] == '\n');
    } while (*way != '\0');
}

static void print_command(const pl_command *command)
{
    pl_option options[PL_MOST_OPTIONS];
    const int count = pl_command_options(command, options) - PL_COMMON_OPTIONS;
    fputs(".SS ", stdout);
    print_text(command->name);
    putchar('\n');
    print_usage(command, count > 0);
    if (command->description == NULL) {
        print_paragraphs(command->summary);
        return;
    }
    print_paragraphs(command->description);
    for (int i = 0; i < count; ++i) {
        print_option(&options[i]);
    }
    if (command->list != NULL) {
        print_list(command);
    }
    print_paragraphs(command->notes);
}

/* ---- The page ---- */

static void print_commands(void)
{
    int count;
    const pl_command *const *commands = pl_commands(&count);
    for (int i = 0; i < count; ++i) {
        print_command(commands[i]);
    }
}

static void print_common_options(void)
{
    for (const pl_option *option = pl_common_options; option->name != NULL; ++option) {
        print_option(option);
    }
}

static void print_title(void)
{
    char date[32] = "";
    const char *epoch = getenv("SOURCE_DATE_EPOCH");
    if (epoch != NULL) {
        const time_t seconds = (time_t)strtoll(epoch, NULL, 10);
        struct tm broken;
        if (gmtime_r(&seconds, &broken) != NULL) {
            strftime(date, sizeof date, "%Y-%m-%d", &broken);
        }
    }
    printf(".TH PLUMB 1 \"%s\" \"Plumb %s\" \"User Commands\"\n", date, PLUMB_VERSION);
}

static void print_command_list(void)
{
    int count;
    const pl_command *const *commands = pl_commands(&count);
    for (int i = 0; i < count; ++i) {
        print_entry(commands[i]->name, commands[i]->summary);
    }
}

static void print_exit_status(void)
{
    int count;
    const pl_exit_meaning *meanings = pl_exit_meanings(&count);
    for (int i = 0; i < count; ++i) {
        print_entry(meanings[i].code, meanings[i].meaning);
    }
}

static void print_line(const char *line, int length)
{
    static const struct {
        const char *name;
        void (*print)(void);
    } parts[] = {{"@title", print_title},
                 {"@list", print_command_list},
                 {"@common", print_common_options},
                 {"@commands", print_commands},
                 {"@exit", print_exit_status}};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; ++i) {
        if (strlen(parts[i].name) == (size_t)length &&
            strncmp(parts[i].name, line, (size_t)length) == 0) {
            parts[i].print();
            return;
        }
    }
    printf("%.*s\n", length, line);
}

int main(void)
{
    for (const char *line = pl_plumb_1_in; *line != '\0';) {
        const size_t length = strcspn(line, "\n");
        print_line(line, (int)length);
        line += length + (line[length] == '\n');
    }
    return fflush(stdout) == 0 ? PL_EXIT_OK : PL_EXIT_FAILED;
}
