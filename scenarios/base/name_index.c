#include "name_index.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int by_name_then_index(const void *left, const void *right)
{
    const pl_named *a = left;
    const pl_named *b = right;
    int order = strcmp(a->name, b->name);
    return order != 0 ? order : (a->index > b->index) - (a->index < b->index);
}

pl_status pl_name_index_create(const char *first_name, size_t stride, int count,
                               pl_name_index *index)
{
    *index = (pl_name_index){.items = NULL};
    if (count == 0) {
        return PL_OK;
    }
    index->items = malloc((size_t)count * sizeof *index->items);
    if (index->items == NULL) {
        return PL_NO_MEMORY;
    }
    index->count = count;
    for (int i = 0; i < count; ++i) {
        index->items[i] = (pl_named){.name = first_name + (size_t)i * stride, .index = i};
    }
    qsort(index->items, (size_t)count, sizeof *index->items, by_name_then_index);
    return PL_OK;
}

void pl_name_index_free(pl_name_index *index)
{
    free(index->items);
    *index = (pl_name_index){.items = NULL};
}

int pl_name_index_find(const pl_name_index *index, const char *name)
{
    int low = 0, high = index->count;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (strcmp(index->items[middle].name, name) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    bool found = low < index->count && strcmp(index->items[low].name, name) == 0;
    return found ? index->items[low].index : -1;
}

int pl_name_index_duplicate(const pl_name_index *index)
{
    int lowest = -1;
    for (int i = 1; i < index->count; ++i) {
        const pl_named *item = &index->items[i];
        if (strcmp(item->name, item[-1].name) == 0 && (lowest < 0 || item->index < lowest)) {
            lowest = item->index;
        }
    }
    return lowest;
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

const char *pl_name_index_nearest(const pl_name_index *index, const char *word)
{
    const char **names = malloc((size_t)index->count * sizeof *names + 1);
    if (names == NULL) {
        return NULL;
    }
    for (int i = 0; i < index->count; ++i) {
        names[i] = index->items[i].name;
    }
    const char *nearest = pl_nearest_name(word, names, index->count);
    free(names);
    return nearest;
}
