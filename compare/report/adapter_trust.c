/* Whether the conformance of engines was verified, and what was read back from them. */
#include "sections.h"

#include "base/heap.h"
#include "base/program_name.h"
#include "results/result.h"

#include <stdlib.h>
#include <string.h>

const pl_result_row *pl_first_run(const pl_result_table *results, int configuration)
{
    const pl_result_cell *cell = NULL;
    for (int i = 0; cell == NULL; ++i) {
        cell = pl_result_case_cell(&results->cases[i], configuration);
    }
    return cell->worst;
}

/* ---- Conformance ---- */

typedef enum trust { PASSED, NOT_VERIFIED, FAILED } trust;

static trust trust_of(const json_t *record)
{
    const char *outcome = pl_json_get_text(record, "outcome");
    return strcmp(outcome, "passed") == 0   ? PASSED
           : strcmp(outcome, "failed") == 0 ? FAILED
                                            : NOT_VERIFIED;
}

/* The record of a configuration that counts; NULL: none. One that failed outweighs the others, and one run without a
 * record outweighs those that passed, because it may be of another binary. */
static const json_t *record_of(const pl_result_table *results, int configuration)
{
    const json_t *found =
        json_object_get(pl_first_run(results, configuration)->result, "conformance");
    for (int i = 0; i < results->case_count; ++i) {
        const pl_result_cell *cell = pl_result_case_cell(&results->cases[i], configuration);
        const json_t *record =
            cell == NULL ? found : json_object_get(cell->worst->result, "conformance");
        found = trust_of(record) > trust_of(found) ? record : found;
    }
    return found;
}

char *pl_conformance_text(const pl_result_table *results, int configuration)
{
    const json_t *record = record_of(results, configuration);
    const json_t *run = pl_first_run(results, configuration)->result;
    const char *spec =
        pl_json_get_text(run, "engine_spec"); /* results of an older version have none */
    const int checks = (int)json_integer_value(json_object_get(record, "checks"));
    char *profile = pl_heap_format("%s:%s", results->configurations[configuration].engine,
                                   pl_json_get_text(run, "profile"));
    const bool is_profile = strcmp(results->configurations[configuration].label, profile) == 0;
    pl_text_buffer out = {0};
    if (trust_of(record) == NOT_VERIFIED) {
        pl_text_add(&out, "not verified: run plumb check-engine ");
        pl_text_add_shell(&out, spec[0] != '\0' ? spec : profile);
    } else {
        pl_text_format(&out, "conformance%s%s ", is_profile ? "" : " of ",
                       is_profile ? "" : profile);
    }
    if (trust_of(record) == PASSED) {
        pl_text_format(&out, "passed (%d checks, plumb %.40s)", checks,
                       pl_json_get_text(record, PL_PROGRAM));
    } else if (trust_of(record) == FAILED) {
        pl_text_format(&out, "FAILED: %d of %d checks",
                       (int)json_integer_value(json_object_get(record, "failed")), checks);
    }
    free(profile);
    return pl_text_take(&out);
}

/* ---- What was read back ---- */

/* 1 << pl_read_back for each kind, of all runs of a configuration together. */
static unsigned read_back_of(const pl_result_table *results, int configuration)
{
    unsigned bits = 0;
    for (int i = 0; i < results->case_count; ++i) {
        const pl_result_cell *cell = pl_result_case_cell(&results->cases[i], configuration);
        const json_t *result = cell == NULL ? NULL : cell->worst->result, *item;
        size_t index;
        json_array_foreach(json_object_get(result, "read_back"), index, item)
        {
            for (int k = 0; k < PL_READ_BACK_COUNT && json_is_string(item); ++k) {
                const char *name = pl_read_back_name((pl_read_back)k);
                bits |= strcmp(json_string_value(item), name) == 0 ? 1u << k : 0;
            }
        }
    }
    return bits;
}

/* Adds the names of the kinds in `bits`: "a, b and c". */
static void add_kinds(unsigned bits, pl_text_buffer *out)
{
    for (int i = 0, left = __builtin_popcount(bits); i < PL_READ_BACK_COUNT; ++i) {
        if ((bits >> i & 1u) != 0) {
            --left;
            pl_text_format(out, "%s%s", pl_read_back_name((pl_read_back)i),
                           left > 1    ? ", "
                           : left == 1 ? " and "
                                       : "");
        }
    }
}

static void add_read_back(unsigned bits, pl_text_buffer *out)
{
    const unsigned left_out = ((1u << PL_READ_BACK_COUNT) - 1) & ~bits;
    if (bits == 0) {
        pl_text_add(out, ": nothing was read back.");
        return;
    }
    pl_text_add(out, ": ");
    add_kinds(bits, out);
    pl_text_add(out, left_out == 0 ? " agreed" : " agreed; not read back: ");
    add_kinds(left_out, out);
    pl_text_add(out, ".");
}

void pl_describe_read_back(const pl_result_table *results, const bool *listed,
                           pl_document *document)
{
    const int count = results->configuration_count;
    bool *named = pl_heap_new((size_t)count, sizeof *named);
    pl_text_buffer words = {0};
    pl_text_add(&words, "Before the first step of a run, what the engine reads back was compared "
                        "with the scene.");
    for (int i = 0; i < count; ++i) {
        const unsigned bits = read_back_of(results, i);
        if (!listed[i] || named[i]) {
            continue;
        }
        for (int k = i; k < count; ++k) {
            if (listed[k] && read_back_of(results, k) == bits) {
                pl_text_format(&words, "%s%s %s", k > i ? ", " : " ",
                               results->configurations[k].name, results->configurations[k].version);
                named[k] = true;
            }
        }
        add_read_back(bits, &words);
    }
    pl_document_words(document, &words);
    free(named);
}
