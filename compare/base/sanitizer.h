/* Whether this build has the address, thread or memory sanitizer, which gcc and clang say in different
 * ways. Each keeps a shadow of the memory, larger than any limit, and replaces malloc. */
#ifndef PLUMB_SANITIZER_H
#define PLUMB_SANITIZER_H

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PL_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) ||                         \
    __has_feature(memory_sanitizer)
#define PL_SANITIZER 1
#endif
#endif
#ifndef PL_SANITIZER
#define PL_SANITIZER 0
#endif

#endif
