#include "name_index.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

/* The name of an item. */
static const char *name_of(const pl_name_index *index, int item)
{
    return index->first_name + (size_t)item * index->stride;
}

/* The slot of the name, or the free one where it would be. The index has free slots. */
static pl_name_slot *find_slot(const pl_name_index *index, const char *name, uint32_t hash)
{
    uint32_t place = hash & index->mask;
    while (index->slots[place].number > 0 &&
           (index->slots[place].hash != hash ||
            strcmp(name_of(index, index->slots[place].number - 1), name) != 0)) {
        place = (place + 1) & index->mask;
    }
    return &index->slots[place];
}

static uint64_t rotate(uint64_t x, int places)
{
    return x << places | x >> (64 - places);
}

static void sip_round(uint64_t v[4])
{
    v[0] += v[1];
    v[2] += v[3];
    v[1] = rotate(v[1], 13) ^ v[0];
    v[3] = rotate(v[3], 16) ^ v[2];
    v[0] = rotate(v[0], 32);
    v[2] += v[1];
    v[0] += v[3];
    v[1] = rotate(v[1], 17) ^ v[2];
    v[3] = rotate(v[3], 21) ^ v[0];
    v[2] = rotate(v[2], 32);
}

/* SipHash-1-3: Aumasson and Bernstein, SipHash: a fast short-input PRF, 2012. */
static uint32_t hash_of(const pl_name_index *index, const char *name)
{
    const size_t length = strlen(name);
    uint64_t v[4] = {
        index->key[0] ^ UINT64_C(0x736f6d6570736575), index->key[1] ^ UINT64_C(0x646f72616e646f6d),
        index->key[0] ^ UINT64_C(0x6c7967656e657261), index->key[1] ^ UINT64_C(0x7465646279746573)};
    for (size_t at = 0; at <= length; at += 8) {
        uint64_t word = at + 8 > length ? (uint64_t)length << 56 : 0;
        memcpy(&word, name + at, length - at < 8 ? length - at : 8);
        v[3] ^= word;
        sip_round(v);
        v[0] ^= word;
    }
    v[2] ^= 0xff;
    for (int i = 0; i < 3; ++i) {
        sip_round(v);
    }
    const uint64_t hash = v[0] ^ v[1] ^ v[2] ^ v[3];
    return (uint32_t)(hash ^ hash >> 32);
}

/* Where the system has no random numbers, addresses serve, which it draws for each process. */
static void draw_key(pl_name_index *index, const void *address)
{
    if (getrandom(index->key, sizeof index->key, GRND_NONBLOCK) != sizeof index->key) {
        index->key[0] = (uint64_t)(uintptr_t)address;
        index->key[1] = (uint64_t)(uintptr_t)&index;
    }
}

pl_status pl_name_index_create(const char *first_name, size_t stride, int count,
                               pl_name_index *index)
{
    uint32_t size = 2;
    *index = (pl_name_index){.duplicate = -1};
    if (count == 0) {
        return PL_OK;
    }
    while (size / 2 < (uint32_t)count) {
        size *= 2;
    }
    pl_name_slot *slots = calloc(size, sizeof *slots);
    if (slots == NULL) {
        return PL_NO_MEMORY;
    }
    *index = (pl_name_index){first_name, stride, count, -1, slots, size - 1, {0, 0}};
    draw_key(index, slots);
    for (int i = 0; i < count; ++i) {
        const uint32_t hash = hash_of(index, name_of(index, i));
        pl_name_slot *slot = find_slot(index, name_of(index, i), hash);
        if (slot->number == 0) {
            *slot = (pl_name_slot){hash, i + 1};
        } else if (index->duplicate < 0) {
            index->duplicate = i;
        }
    }
    return PL_OK;
}

void pl_name_index_free(pl_name_index *index)
{
    free(index->slots);
    *index = (pl_name_index){.duplicate = -1};
}

int pl_name_index_find(const pl_name_index *index, const char *name)
{
    return index->slots == NULL ? -1 : find_slot(index, name, hash_of(index, name))->number - 1;
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
