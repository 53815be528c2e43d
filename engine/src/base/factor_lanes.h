/* Eight doubles that one instruction, or a few, work on together. Every lane is the IEEE operation
 * that scalar code would do, so that all machines give the same bits; PE_WIDE_CLONES makes a
 * function be compiled for several machines and chosen when the program is loaded. */
#ifndef PE_LANES_H
#define PE_LANES_H

typedef double pe_lanes __attribute__((vector_size(64)));

/* clang 14 links no function with clones that another file calls; the sanitizers run before the
 * choice can be made. */
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) &&       \
    !defined(__SANITIZE_ADDRESS__)
#define PE_WIDE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define PE_WIDE_CLONES
#endif

#define PE_INLINE static inline __attribute__((always_inline))

#endif
