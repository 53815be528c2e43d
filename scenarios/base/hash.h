/* FNV-1a, 64 bits: Fowler, Noll and Vo, with their offset and prime. It is a fast hash for
 * identities and tables, not a cryptographic one. A hash starts as PL_HASH_START and is continued
 * by each call; no call keeps state elsewhere. */
#ifndef PLUMB_HASH_H
#define PLUMB_HASH_H

#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define PL_HASH_START UINT64_C(0xcbf29ce484222325)

/* Size of a hash as hexadecimal text, with its terminating zero. */
enum { PL_HASH_TEXT_SIZE = 17 };

/* `hash` continued by one byte. */
static inline uint64_t pl_hash_byte(uint64_t hash, unsigned char byte)
{
    return (hash ^ byte) * UINT64_C(0x100000001b3);
}

/* `hash` continued by the bytes of `text`, without its terminating zero. */
static inline uint64_t pl_hash_text(uint64_t hash, const char *text)
{
    for (; *text != '\0'; ++text) {
        hash = pl_hash_byte(hash, (unsigned char)*text);
    }
    return hash;
}

/* `hash` continued by the bits of `count` numbers, each from its least significant byte, so that
 * machines of either byte order agree. */
static inline uint64_t pl_hash_numbers(uint64_t hash, const double *numbers, int count)
{
    for (int i = 0; i < count; ++i) {
        uint64_t bits;
        memcpy(&bits, &numbers[i], sizeof bits);
        for (int shift = 0; shift < 64; shift += 8) {
            hash = pl_hash_byte(hash, (unsigned char)(bits >> shift));
        }
    }
    return hash;
}

/* Writes the hash as 16 hexadecimal digits and a zero. Returns `text`. */
static inline const char *pl_hash_hex(uint64_t hash, char text[PL_HASH_TEXT_SIZE])
{
    (void)snprintf(text, PL_HASH_TEXT_SIZE, "%016" PRIx64, hash);
    return text;
}

#endif
