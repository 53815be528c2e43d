/* Reads any bytes as a baseline of the gate, as a profile that was tuned, and as a contact problem. Each
 * reader accepts them, or refuses them with the place of the fault: the line and column, and of a
 * profile at least the file. What is accepted, written and read again is the same. */
#define _GNU_SOURCE

#include "engines/tuned_profile.h"
#include "fuzz_rows.h"
#include "studies/solve/problem_file.h"

/* An engine with two options, for profiles. */
static const pl_engine_option options[] = {
    {.name = "iterations", .integer = true, .min = 1, .max = 1000},
    {.name = "tolerance", .min = 0, .max = 1}};
static const pl_engine_info engine = {.name = "small", .options = options, .option_count = 2};

static void read_profile(const char *path)
{
    pl_error error = {.message = ""};
    pl_tuned_profile profile;
    bool found = false;
    setenv(PL_PROFILES_VARIABLE, path, 1);
    const pl_status status = pl_tuned_profile_find(&engine, "tuned", &profile, &found, &error);
    fuzz_check(status == PL_OK || strncmp(error.message, path, strlen(path)) == 0,
               "a refusal has the file");
    for (int i = 0; i < engine.option_count && status == PL_OK && found; ++i) {
        fuzz_check(!profile.given[i] ||
                       (profile.values[i] >= options[i].min && profile.values[i] <= options[i].max),
                   "an accepted value is in its range");
    }
}

static void read_problem(const uint8_t *data, size_t size)
{
    pl_error error = {.message = ""};
    pe_contact_problem *problem = NULL, *again = NULL;
    json_t *source = NULL, *source_again = NULL;
    if (pl_problem_read_text((const char *)data, size, "input", &problem, &source, &error) !=
        PL_OK) {
        fuzz_check(fuzz_has_place(error.message, "input"), "a refusal has a line and a column");
        return;
    }
    char *text = pl_problem_to_text(problem, source);
    fuzz_check(text != NULL, "an accepted problem can be written");
    fuzz_check(pl_problem_read_text(text, strlen(text), "again", &again, &source_again, &error) ==
                   PL_OK,
               "a written problem can be read");
    char *second = pl_problem_to_text(again, source_again);
    fuzz_check(second != NULL && strcmp(text, second) == 0, "the second text equals the first");
    free(text);
    free(second);
    json_decref(source);
    json_decref(source_again);
    pe_contact_problem_destroy(problem);
    pe_contact_problem_destroy(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pl_error error = {.message = ""};
    pl_gate_rows rows;
    char path[FUZZ_PATH_SIZE];
    const int file = fuzz_file(data, size, path);
    if (pl_gate_baseline_read(path, &rows, &error) == PL_OK) {
        fuzz_rows_survive(&rows);
    } else {
        fuzz_check(fuzz_has_place(error.message, path), "a refusal has a line and a column");
    }
    pl_gate_rows_free(&rows);
    read_profile(path);
    read_problem(data, size);
    close(file);
    return 0;
}
