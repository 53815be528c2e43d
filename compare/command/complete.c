/* plumb __complete WORD...: what a shell may put in the place of the last word. */
#include "command.h"

#include "adapters/built_in.h"
#include "base/heap.h"
#include "conformance/conformance.h"
#include "engines/registry.h"
#include "plumb/scenario.h"
#include "referee/metrics/metrics.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* A command line at whose last word the cursor is. */
typedef struct completion {
    const pl_command *const *commands; /* (command_count) */
    int command_count;
    const char *word;          /* at the cursor */
    size_t lead;               /* bytes of the word before what is completed: "--engine=" */
    const pl_command *command; /* NULL: the word is the command */
    pl_option options[PL_MOST_OPTIONS]; /* (option_count) of the command */
    int option_count;
    pl_texts arguments; /* of the command, before the word */
    bool offers;        /* a candidate has been printed */
} completion;

/* ---- Candidates ---- */

/* Prints a text up to the end of its first clause. */
static void print_beginning(const char *text)
{
    size_t length = strcspn(text, ";:(\n");
    const char *sentence = strstr(text, ". ");
    if (sentence != NULL && (size_t)(sentence - text) < length) {
        length = (size_t)(sentence - text);
    }
    while (length > 0 && text[length - 1] == ' ') {
        --length;
    }
    printf("%.*s", (int)length, text);
}

/* Prints the candidate `name` and then `end`, if it begins with what was typed. */
static void offer(completion *c, const char *name, const char *end, const char *description)
{
    char candidate[PL_SPEC_SIZE];
    const char *typed = c->word + c->lead;
    snprintf(candidate, sizeof candidate, "%s%s", name, end);
    if (strncmp(candidate, typed, strlen(typed)) == 0) {
        printf("%.*s%s\t", (int)c->lead, c->word, candidate);
        print_beginning(description);
        putchar('\n');
        c->offers = true;
    }
}

static void offer_files(completion *c, const char *suffix)
{
    if (!c->offers) {
        printf(":files %s\n", suffix);
    }
}

/* Only what follows the last comma of the word is completed. */
static void pass_commas(completion *c)
{
    const char *comma = strrchr(c->word + c->lead, ',');
    c->lead = comma == NULL ? c->lead : (size_t)(comma + 1 - c->word);
}

static void offer_commands(completion *c)
{
    for (int i = 0; i < c->command_count; ++i) {
        offer(c, c->commands[i]->name, "", c->commands[i]->summary);
    }
}

static void offer_scenarios(completion *c)
{
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        offer(c, scenarios[i]->name, "", scenarios[i]->title);
    }
}

static void offer_suites(completion *c)
{
    int count;
    const pl_suite *suites = pl_suites(&count);
    for (int i = 0; i < count; ++i) {
        offer(c, suites[i].name, "", suites[i].description);
    }
}

/* The parameters of the scenarios and scene files that are named before, each once. */
static void offer_parameters(completion *c)
{
    json_t *offered = json_object();
    pass_commas(c);
    for (int i = 0; i < c->arguments.count; ++i) {
        const char *argument = c->arguments.items[i];
        pl_scenario *file = NULL;
        const pl_scenario *scenario = pl_scenario_find(argument, NULL);
        if (scenario == NULL && strcmp(argument, "-") != 0 &&
            pl_scenario_open_file(argument, &file, NULL) == PL_OK) {
            scenario = file;
        }
        for (int k = 0; scenario != NULL && k < scenario->param_count; ++k) {
            const pl_param *param = &scenario->params[k];
            if (json_object_get(offered, param->name) == NULL) {
                json_object_set_new(offered, param->name, json_true());
                offer(c, param->name, "=", param->help);
            }
        }
        pl_scenario_close_file(file);
    }
    json_decref(offered);
}

static void offer_metrics(completion *c)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        offer(c, pl_metric_table[i].name, "", pl_metric_table[i].definition);
    }
}

static void offer_checks(completion *c)
{
    const pl_check *check;
    for (int i = 0; (check = pl_conformance_check(i)) != NULL; ++i) {
        offer(c, check->name, "", check->title);
    }
}

/* ---- Engines ---- */

/* The table of an engine that is linked; others would have to be started to be asked: NULL. */
static const pl_engine *linked_engine(const pl_built_in *built_in)
{
    return built_in->entry == NULL ? NULL : built_in->entry();
}

static void offer_engine_names(completion *c)
{
    int count;
    const pl_built_in *known = pl_built_in_engines(&count);
    pass_commas(c);
    offer(c, "all", "", "");
    for (int i = 0; i < count; ++i) {
        offer(c, known[i].name, "", "");
    }
}

static void offer_engine(completion *c, const pl_built_in *built_in)
{
    char label[PL_LABEL_SIZE];
    const pl_engine *engine = linked_engine(built_in);
    offer(c, built_in->name, "", engine == NULL ? "" : engine->description);
    for (int i = 0; engine != NULL && i < engine->profile_count; ++i) {
        snprintf(label, sizeof label, "%s:%s", built_in->name, engine->profiles[i].name);
        offer(c, label, "", engine->profiles[i].help);
    }
}

/* Engines with their profiles, and after a comma the options of the engine. */
static void offer_specs(completion *c)
{
    int count;
    const pl_built_in *known = pl_built_in_engines(&count);
    const char *typed = c->word + c->lead;
    const size_t length = strcspn(typed, ":,");
    const bool has_options = strchr(typed, ',') != NULL;
    for (int i = 0; i < count; ++i) {
        if (!has_options && pl_built_in_is_present(&known[i])) {
            offer_engine(c, &known[i]);
        }
        const pl_engine *engine = linked_engine(&known[i]);
        if (has_options && engine != NULL && strlen(known[i].name) == length &&
            strncmp(known[i].name, typed, length) == 0) {
            pass_commas(c);
            for (int k = 0; k < engine->option_count; ++k) {
                offer(c, engine->options[k].name, "=", engine->options[k].help);
            }
            offer(c, "label", "=", "The name of this configuration in reports");
            return;
        }
    }
    offer_files(c, ".so");
}

/* ---- Values of options, and arguments ---- */

/* What a word in capitals of a usage line stands for. A word that begins so has the same meaning. */
static const struct {
    const char *word;
    void (*offer)(completion *c); /* NULL: files */
    const char *suffix;           /* of files */
} MEANINGS[] = {{"CHECK", offer_checks, NULL},
                {"COMMAND", offer_commands, NULL},
                {"DIR", NULL, "/"},
                {"ENGINE", offer_specs, NULL},
                {"EXPR", offer_metrics, NULL},
                {"FILE", NULL, ""},
                {"METRIC", offer_metrics, NULL},
                {"NAME=VALUE", offer_parameters, NULL},
                {"NAMES", offer_engine_names, NULL},
                {"RESULTS", NULL, ""},
                {"SCENARIO", offer_scenarios, NULL},
                {"SETTINGS", offer_parameters, NULL},
                {"SPEC", offer_specs, NULL},
                {"SUITE", offer_suites, NULL}};

/* Offers what a word of a usage line stands for: one that begins with a small letter stands for itself. */
static void offer_meaning(completion *c, const char *word)
{
    if (islower((unsigned char)word[0])) {
        offer(c, word, "", "");
    }
    for (size_t i = 0; i < sizeof MEANINGS / sizeof MEANINGS[0]; ++i) {
        if (strncmp(word, MEANINGS[i].word, strlen(MEANINGS[i].word)) != 0) {
            continue;
        }
        if (MEANINGS[i].offer != NULL) {
            MEANINGS[i].offer(c);
        } else {
            offer_files(c, MEANINGS[i].suffix);
        }
    }
    if (strchr(word, '.') != NULL) {
        offer_files(c, strchr(word, '.'));
    }
}

/* Offers what a part of a usage line stands for, such as "SCENARIO|SCENE.json...". */
static void offer_usage(completion *c, const char *usage, size_t size)
{
    char *words = pl_heap_format("%.*s", (int)size, usage), *rest = words;
    for (char *word; (word = strsep(&rest, " |[]")) != NULL;) {
        char *dots = strstr(word, "...");
        if (dots != NULL) {
            *dots = '\0';
        }
        offer_meaning(c, word);
    }
    free(words);
}

static void offer_value(completion *c, const pl_option *option)
{
    const char *usage = option->values != NULL ? option->values : option->argument;
    offer_usage(c, usage, strlen(usage));
}

/* Offers the next argument of the command: one that has small letters first is a word of a list, each
 * of which may have arguments of its own in brackets. */
static void offer_argument(completion *c)
{
    const char *usage = c->command->arguments;
    if (islower((unsigned char)usage[0])) {
        for (const char *at = usage; *at != '\0';) {
            const size_t length = strcspn(at, " |"), whole = strcspn(at, "|");
            const char *first = c->arguments.count == 0 ? NULL : c->arguments.items[0];
            if (first == NULL) {
                offer_usage(c, at, length);
            } else if (strlen(first) == length && strncmp(first, at, length) == 0) {
                offer_usage(c, at + length, whole - length);
            }
            at += whole + (at[whole] == '|');
        }
        return;
    }
    const char *option = strstr(usage, "--");
    if (c->arguments.count == 0 || strstr(usage, "...") != NULL) {
        offer_usage(c, usage, option == NULL ? strlen(usage) : (size_t)(option - usage));
    }
}

/* ---- The command line ---- */

/* The option of a word, "--NAME" (length) or "-L", that takes an argument; NULL: it is none. */
static const pl_option *option_of(const completion *c, const char *word, size_t length)
{
    int found = -1;
    if (strncmp(word, "--", 2) == 0) {
        found = pl_option_find(c->options, c->option_count, word + 2, length - 2);
    }
    for (int i = 0; i < c->option_count && length == 2; ++i) {
        found = c->options[i].letter == word[1] ? i : found;
    }
    return found < 0 || c->options[found].argument == NULL ? NULL : &c->options[found];
}

static void offer_options(completion *c)
{
    for (int i = 0; i < c->option_count; ++i) {
        offer(c, "--", c->options[i].name, c->options[i].help);
    }
}

/* Completes the word after `count` words, the first of which is the command. */
static void complete_word(completion *c, int count, char *const *words)
{
    const pl_option *taking = NULL; /* the option whose argument comes next */
    bool may_be_option = true;
    for (int i = 1; i < count; ++i) {
        const bool is_option = may_be_option && words[i][0] == '-' && words[i][1] != '\0';
        if (taking != NULL) {
            taking = NULL;
        } else if (is_option && strcmp(words[i], "--") == 0) {
            may_be_option = false;
        } else if (is_option) {
            taking = option_of(c, words[i], strlen(words[i]));
        } else {
            pl_texts_add(&c->arguments, words[i]);
        }
    }
    const size_t name = strcspn(c->word, "=");
    if (taking != NULL) {
        offer_value(c, taking);
    } else if (may_be_option && strncmp(c->word, "--", 2) == 0 && c->word[name] == '=') {
        const pl_option *option = option_of(c, c->word, name);
        c->lead = name + 1;
        if (option != NULL) {
            offer_value(c, option);
        }
    } else if (may_be_option && c->word[0] == '-') {
        offer_options(c);
    } else {
        offer_argument(c);
    }
}

int pl_complete(const pl_command *const *commands, int command_count, int word_count,
                char *const *words)
{
    completion c = {.commands = commands,
                    .command_count = command_count,
                    .word = word_count > 0 ? words[word_count - 1] : ""};
    for (int i = 0; i < command_count && word_count > 1; ++i) {
        c.command = strcmp(commands[i]->name, words[0]) == 0 ? commands[i] : c.command;
    }
    if (word_count <= 1) {
        offer_commands(&c);
        offer(&c, "--help", "", "Explain plumb");
        offer(&c, "--version", "", "Print program version");
    } else if (c.command != NULL) {
        c.option_count = pl_command_options(c.command, c.options);
        complete_word(&c, word_count - 1, words);
    }
    free(c.arguments.items);
    return PL_EXIT_OK;
}
