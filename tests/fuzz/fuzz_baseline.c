/* Reads any bytes as a baseline of the gate, as a profile that was tuned, and as a contact problem.
 * Each reader accepts them, or refuses them with the place of the fault: the line and column of a
 * baseline, at least the file of the others. What is accepted, written and read again is the
 * same. */
#define _GNU_SOURCE

#include "command/capture_file.h"
#include "engines/registry.h"
#include "fuzz_rows.h"
#include "problem_file.h"

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
    char message[PROBLEM_MESSAGE_SIZE] = "";
    pe_contact_problem *problem = problem_read_text((const char *)data, size, "input", message);
    if (problem == NULL) {
        fuzz_check(strncmp(message, "input:", 6) == 0, "a refusal has the file");
        return;
    }
    char *text = pl_capture_text(problem, NULL);
    pe_contact_problem *again = problem_read_text(text, strlen(text), "again", message);
    fuzz_check(again != NULL, "a written problem can be read");
    char *second = pl_capture_text(again, NULL);
    fuzz_check(strcmp(text, second) == 0, "the second text equals the first");
    free(text);
    free(second);
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
