#include "name_index.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The name of an item. */
static const char *name_of(const pl_name_index *index, int item)
{
    return index->first_name + (size_t)item * index->stride;
}

pl_status pl_name_index_create(const char *first_name, size_t stride, int count,
                               pl_name_index *index)
{
    *index = (pl_name_index){first_name, stride, count, -1, json_object()};
    bool made = index->numbers != NULL;
    /* The first item of a name is set last, and stays. */
    for (int i = count - 1; i >= 0 && made; --i) {
        made = json_object_set_new_nocheck(index->numbers, name_of(index, i), json_integer(i)) == 0;
    }
    if (!made) {
        pl_name_index_free(index);
        return PL_NO_MEMORY;
    }
    const bool is_unique = json_object_size(index->numbers) == (size_t)count;
    for (int i = 0; i < count && !is_unique && index->duplicate < 0; ++i) {
        index->duplicate = pl_name_index_find(index, name_of(index, i)) == i ? -1 : i;
    }
    return PL_OK;
}

void pl_name_index_free(pl_name_index *index)
{
    json_decref(index->numbers);
    *index = (pl_name_index){.duplicate = -1};
}

int pl_name_index_find(const pl_name_index *index, const char *name)
{
    const json_t *number = json_object_get(index->numbers, name);
    return number == NULL ? -1 : (int)json_integer_value(number);
}

int pl_name_index_duplicate(const pl_name_index *index)
{
    return index->duplicate;
}

enum { LONGEST_WORD = 255 };

/* Levenshtein's distance by Wagner and Fischer 1974, one row at a time; both words at most
 * LONGEST_WORD. */
static size_t edit_distance(const char *a, size_t a_length, const char *b, size_t b_length)
{
    size_t row[LONGEST_WORD + 1];
    for (size_t j = 0; j <= b_length; ++j) {
        row[j] = j;
    }
    for (size_t i = 1; i <= a_length; ++i) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b_length; ++j) {
            size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            size_t inserted = (row[j - 1] < row[j] ? row[j - 1] : row[j]) + 1;
            diagonal = row[j];
            row[j] = replaced < inserted ? replaced : inserted;
        }
    }
    return row[b_length];
}

const char *pl_nearest_name(const char *word, const char *const *candidates, int count)
{
    size_t length = strlen(word);
    if (length > LONGEST_WORD) {
        return NULL;
    }
    size_t limit = 1 + length / 3;
    const char *nearest = NULL;
    for (int i = 0; i < count; ++i) {
        size_t other = strlen(candidates[i]);
        size_t at_least = other > length ? other - length : length - other;
        if (other > LONGEST_WORD || at_least > limit) {
            continue;
        }
        size_t distance = edit_distance(word, length, candidates[i], other);
        if (distance <= limit && (nearest == NULL || distance < limit)) {
            nearest = candidates[i];
            if (distance == 0) {
                break;
            }
            limit = distance;
        }
    }
    return nearest;
}

const char *pl_did_you_mean(const char *word, const char *const *candidates, int count,
                            char text[PL_SUGGESTION_SIZE])
{
    const char *nearest = pl_nearest_name(word, candidates, count);
    text[0] = '\0';
    if (nearest != NULL) {
        snprintf(text, PL_SUGGESTION_SIZE, "; did you mean %.120s?", nearest);
    }
    return text;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

const char *pl_name_index_nearest(const pl_name_index *index, const char *word)
{
    const char **names = malloc((size_t)index->count * sizeof *names + 1);
    if (names == NULL) {
        return NULL;
    }
    for (int i = 0; i < index->count; ++i) {
        names[i] = name_of(index, i);
    }
    qsort(names, (size_t)index->count, sizeof *names, compare_names);
    const char *nearest = pl_nearest_name(word, names, index->count);
    free(names);
    return nearest;
}
