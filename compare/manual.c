/* Prints the manual page plumb(1) in man(7)'s macros, from the tables of the commands:
 * plumb_manual > plumb.1. The environment variable SOURCE_DATE_EPOCH gives its date; without it the
 * page has none. */
#include "command/command.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* A term and what it means. */
typedef struct entry {
    const char *term, *text;
} entry;

static const char NAME[] =
    "measure how accurate rigid-body physics engines are, and what that accuracy costs";

static const char DESCRIPTION[] =
    "plumb runs canonical scenarios on rigid-body physics engines, and reports how far each engine "
    "is from the right answer and at what cost. The right answer is a closed form, a conservation "
    "law, a known resting place or a converged reference. Each run is a process of its own: a "
    "crash, a hang or a number that is not finite becomes a row of the results.\n"
    "\n"
    "Data goes to standard output; messages and progress go to standard error. No command replaces "
    "a file or results that exist unless --force is given.\n"
    "\n"
    "An engine is given as a SPEC: NAME[:PROFILE][,OPTION=VALUE...][,label=TEXT], where NAME is a "
    "built-in engine, the path of a shared object, or exec: and the command of a program. plumb "
    "list engines prints names, profiles and options. A scenario is a name that plumb list "
    "scenarios prints; a scene file is a name with a slash, or one that ends in .json, or - for "
    "standard input. --set NAME=VALUE sets a parameter of a scenario, or of a scene file that "
    "defines it.";

static const entry ENVIRONMENT[] = {
    {"PLUMB_PROFILES",
     "Files of profiles that plumb tune saved, separated by colons; as --profiles"},
    {"PLUMB_ALLOW_FILES",
     "Folders in which scenes may name files, separated by colons; as --allow-files"},
    {"PLUMB_CACHE", "The folder of what plumb check-engine found, which reports and plumb doctor "
                    "show"},
    {"XDG_CACHE_HOME, HOME",
     "Where PLUMB_CACHE is not set: the folder is plumb in XDG_CACHE_HOME, or else .cache/plumb in "
     "HOME"},
    {"XDG_DATA_HOME, HOME", "Engines from npm may be in plumb/web of XDG_DATA_HOME, or else of "
                            ".local/share in HOME, where "
                            "the script get-engines puts them"},
    {"BROWSER", "The program that opens pages; by default xdg-open"},
    {"CHROMIUM", "The Chromium that draws plumb report --figure; by default chromium"},
    {"PATH", "Where node is looked up, which runs engines from npm"},
    {"COLUMNS", "The width of what is printed, where standard output is no terminal"},
    {"NO_COLOR", "If it is not empty, nothing is printed in colour"},
    {"ARGP_HELP_FMT", "The format of --help; see argp in the manual of the GNU C library"},
    {"GITHUB_STEP_SUMMARY", "The file to which plumb gate --format github appends its page"},
    {"SLURM_ARRAY_TASK_ID, SLURM_ARRAY_TASK_COUNT, SLURM_ARRAY_TASK_MIN, SLURM_ARRAY_TASK_STEP",
     "The shard of plumb sweep in a job array of Slurm; as --shard"},
    {"OMPI_COMM_WORLD_RANK, OMPI_COMM_WORLD_SIZE, PMIX_RANK, PMIX_SIZE, PMI_RANK, PMI_SIZE",
     "The shard of plumb sweep under an MPI launcher; as --shard"}};

static const entry FILES[] = {
    {"report/index.html", "The page of a comparison, in the default folder of --out"},
    {"report/summary.md, report/runs.csv, report/results.csv",
     "Its tables: in Markdown, with a row for each run, and with a row for each run and metric"},
    {"report/results.jsonl", "Its results, a line each, which plumb report and plumb gate read"},
    {"report/recordings/", "Poses, contacts and curves of its runs"},
    {"STUDY/results.jsonl, STUDY/STUDY.json, STUDY/STUDY.md, STUDY/STUDY.html",
     "The runs of a study, such as threshold, its conclusion, and its document"},
    {"ENGINE.profile.json", "The settings that plumb tune found"},
    {"~/.cache/plumb/", "What plumb check-engine found, for each binary and profile"}};

static const entry EXAMPLES[] = {
    {"plumb compare tower --engine plumb --engine ode --engine bullet",
     "Compare three engines on a tower of cubes, and write a report"},
    {"plumb view", "Open its page"},
    {"plumb scene tower --set n=3 > mine.json", "Begin a scene of your own"},
    {"plumb run ./mine.json --engine ode:quick,iterations=50", "Run it on one engine"},
    {"plumb gate report --baseline baseline.json", "Fail where results are worse than a baseline"}};

enum {
    ENVIRONMENT_COUNT = sizeof ENVIRONMENT / sizeof ENVIRONMENT[0],
    FILE_COUNT = sizeof FILES / sizeof FILES[0],
    EXAMPLE_COUNT = sizeof EXAMPLES / sizeof EXAMPLES[0]
};

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

static void print_entries(const char *title, const entry *entries, int count)
{
    printf(".SH %s\n", title);
    for (int i = 0; i < count; ++i) {
        print_entry(entries[i].term, entries[i].text);
    }
}

/* ---- Commands ---- */

static void print_option(const pl_option *option, const char *help)
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
    print_text(help);
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
    pl_listed_option options[PL_MOST_OPTIONS];
    const int count = pl_command_options(command, options);
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
        print_option(options[i].option, options[i].help);
    }
    if (command->list != NULL) {
        print_list(command);
    }
    print_paragraphs(command->notes);
}

static void print_commands(void)
{
    int count;
    const pl_command *const *commands = pl_commands(&count);
    fputs(".SH COMMANDS\nAll commands have these options:\n", stdout);
    for (const pl_option *option = pl_common_options; option->name != NULL; ++option) {
        print_option(option, option->help);
    }
    for (int i = 0; i < count; ++i) {
        print_command(commands[i]);
    }
}

/* ---- The page ---- */

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
    printf(".TH PLUMB 1 \"%s\" \"Plumb %s\" \"User Commands\"\n.nh\n.ad l\n", date, PLUMB_VERSION);
}

static void print_description(void)
{
    int count;
    const pl_command *const *commands = pl_commands(&count);
    fputs(".SH DESCRIPTION\n", stdout);
    print_lines(DESCRIPTION);
    fputs(".PP\nThe commands are:\n", stdout);
    for (int i = 0; i < count; ++i) {
        print_entry(commands[i]->name, commands[i]->summary);
    }
}

static void print_exit_status(void)
{
    int count;
    const pl_exit_meaning *meanings = pl_exit_meanings(&count);
    fputs(".SH EXIT STATUS\n", stdout);
    for (int i = 0; i < count; ++i) {
        print_entry(meanings[i].code, meanings[i].meaning);
    }
}

static void print_examples(void)
{
    fputs(".SH EXAMPLES\n", stdout);
    for (int i = 0; i < EXAMPLE_COUNT; ++i) {
        fputs(i == 0 ? "" : ".PP\n", stdout);
        print_text(EXAMPLES[i].text);
        fputs(":\n.PP\n.RS 4\n.nf\n", stdout);
        print_text(EXAMPLES[i].term);
        fputs("\n.fi\n.RE\n", stdout);
    }
}

int main(void)
{
    print_title();
    fputs(".SH NAME\nplumb \\- ", stdout);
    print_text(NAME);
    fputs("\n.SH SYNOPSIS\n\\fBplumb\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR...]\n.br\n"
          "\\fBplumb help\\fR [\\fICOMMAND\\fR]\n",
          stdout);
    print_description();
    print_commands();
    print_exit_status();
    print_entries("ENVIRONMENT", ENVIRONMENT, ENVIRONMENT_COUNT);
    print_entries("FILES", FILES, FILE_COUNT);
    print_examples();
    fputs(".SH SEE ALSO\n.BR taskset (1),\n.BR parallel (1),\n.BR mpirun (1)\n", stdout);
    return fflush(stdout) == 0 ? PL_EXIT_OK : PL_EXIT_FAILED;
}
