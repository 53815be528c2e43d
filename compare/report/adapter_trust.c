#include "adapter_trust.h"

#include "base/heap.h"
#include "base/program_name.h"

#include "results/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- What the results of a configuration say ---- */

typedef enum trust_state { NOT_VERIFIED, PASSED, FAILED } trust_state;

/* Of a configuration. Texts are borrowed from its results. */
typedef struct trust {
    trust_state state;
    int checks, failed;
    const char *plumb;  /* the version that made the checks */
    char profile[160];  /* "engine:profile" */
    const char *spec;   /* of that, as check-engine takes it */
    unsigned read_back; /* 1 << pl_read_back, of all runs together */
} trust;

static unsigned read_back_of(const json_t *result)
{
    unsigned bits = 0;
    size_t index;
    const json_t *item;
    json_array_foreach(json_object_get(result, "read_back"), index, item)
    {
        for (int i = 0; i < PL_READ_BACK_COUNT && json_is_string(item); ++i) {
            const bool is_it =
                strcmp(json_string_value(item), pl_read_back_name((pl_read_back)i)) == 0;
            bits |= is_it ? 1u << i : 0;
        }
    }
    return bits;
}

/* Takes a result's record into account: one that failed outweighs the others, and one run without a
 * record outweighs those that passed, because it may be of another binary. */
static void add_record(const json_t *record, trust *t, bool is_first)
{
    const char *outcome = pl_json_get_text(record, "outcome");
    const trust_state state = strcmp(outcome, "passed") == 0   ? PASSED
                              : strcmp(outcome, "failed") == 0 ? FAILED
                                                               : NOT_VERIFIED;
    if (is_first || state == FAILED || (state == NOT_VERIFIED && t->state == PASSED)) {
        t->state = state;
        t->checks = (int)json_integer_value(json_object_get(record, "checks"));
        t->failed = (int)json_integer_value(json_object_get(record, "failed"));
        t->plumb = pl_json_get_text(record, PL_PROGRAM);
    }
}

static trust trust_of(const pl_result_table *results, int configuration)
{
    trust t = {.plumb = "", .spec = ""};
    bool is_first = true;
    for (int i = 0; i < results->case_count; ++i) {
        const pl_result_cell *cell = pl_result_case_cell(&results->cases[i], configuration);
        if (cell == NULL) {
            continue;
        }
        const json_t *result = cell->worst->result;
        add_record(json_object_get(result, "conformance"), &t, is_first);
        t.read_back |= read_back_of(result);
        if (is_first) {
            t.spec = pl_json_get_text(result, "engine_spec");
            snprintf(t.profile, sizeof t.profile, "%.70s:%.70s",
                     results->configurations[configuration].engine,
                     pl_json_get_text(result, "profile"));
        }
        is_first = false;
    }
    return t;
}

/* Adds the SPEC as a shell takes it; results of an older version have none. */
static void add_spec(const trust *t, pl_text_buffer *out)
{
    pl_text_add_shell(out, t->spec[0] != '\0' ? t->spec : t->profile);
}

void pl_conformance_text(const pl_result_table *results, int configuration, pl_text_buffer *out)
{
    const trust t = trust_of(results, configuration);
    const bool is_profile = strcmp(results->configurations[configuration].label, t.profile) == 0;
    if (t.state == NOT_VERIFIED) {
        pl_text_add(out, "not verified: run plumb check-engine ");
        add_spec(&t, out);
        return;
    }
    pl_text_format(out, "conformance%s%s ", is_profile ? "" : " of ", is_profile ? "" : t.profile);
    if (t.state == PASSED) {
        pl_text_format(out, "passed (%d checks, plumb %.40s)", t.checks, t.plumb);
    } else {
        pl_text_format(out, "FAILED: %d of %d checks", t.failed, t.checks);
    }
}

/* ---- In words ---- */

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

static void say_read_back(const trust *t, pl_text_buffer *out)
{
    const unsigned left_out = ((1u << PL_READ_BACK_COUNT) - 1) & ~t->read_back;
    if (t->read_back == 0) {
        pl_text_add(out, "nothing was read back");
        return;
    }
    add_kinds(t->read_back, out);
    pl_text_add(out, left_out == 0 ? " agreed" : " agreed; not read back: ");
    add_kinds(left_out, out);
}

static void say_verified(const trust *t, pl_text_buffer *out)
{
    if (t->state == PASSED) {
        pl_text_format(out, "conformance passed with plumb %.40s (%d checks)", t->plumb, t->checks);
        return;
    }
    if (t->state == FAILED) {
        pl_text_format(out, "conformance FAILED: %d of %d checks", t->failed, t->checks);
    } else {
        pl_text_add(out, "not verified");
    }
    pl_text_add(out, "; a deviation may be the adapter's: run plumb check-engine");
}

/* Adds what is said of a configuration and of all later ones of which the same is said, and frees it; with the SPECs of
 * those that did not pass if asked. */
static void add_group(const pl_result_table *results, char **said, int first, bool has_specs,
                      pl_text_buffer *out)
{
    char *words = said[first];
    pl_text_buffer specs = {0};
    for (int i = first; i < results->configuration_count; ++i) {
        if (said[i] == NULL || strcmp(said[i], words) != 0) {
            continue;
        }
        const trust t = trust_of(results, i);
        pl_text_format(out, "%s%s %s",
                       i > first         ? ", "
                       : out->length > 0 ? " "
                                         : "",
                       results->configurations[i].name, results->configurations[i].version);
        if (has_specs && t.state != PASSED) {
            pl_text_add(&specs, " ");
            add_spec(&t, &specs);
        }
        free(i > first ? said[i] : NULL);
        said[i] = NULL;
    }
    pl_text_format(out, ": %s%s.", words, specs.length > 0 ? specs.data : "");
    pl_text_free(&specs);
    free(words);
}

/* Adds a sentence for each group of listed configurations that are alike. */
static void add_sentences(const pl_result_table *results, const bool *listed,
                          void (*say)(const trust *t, pl_text_buffer *out), bool has_specs,
                          pl_text_buffer *out)
{
    char **said = pl_heap_new((size_t)results->configuration_count, sizeof *said);
    for (int i = 0; i < results->configuration_count; ++i) {
        if (listed[i]) {
            pl_text_buffer words = {0};
            const trust t = trust_of(results, i);
            say(&t, &words);
            said[i] = pl_text_take(&words);
        }
    }
    for (int i = 0; i < results->configuration_count; ++i) {
        if (said[i] != NULL) {
            add_group(results, said, i, has_specs, out);
        }
    }
    free(said);
}

void pl_describe_adapters(const pl_result_table *results, const bool *listed, pl_document *document)
{
    pl_text_buffer words = {0};
    add_sentences(results, listed, say_verified, true, &words);
    pl_document_words(document, &words);
    pl_text_add(&words, "Before the first step of a run, what the engine reads back was compared "
                        "with the scene.");
    add_sentences(results, listed, say_read_back, false, &words);
    pl_document_words(document, &words);
}
