/* Whether this build has the address sanitizer, which gcc and clang say in different ways. */
#ifndef PLUMB_SANITIZER_H
#define PLUMB_SANITIZER_H

#if defined(__SANITIZE_ADDRESS__)
#define PL_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PL_ADDRESS_SANITIZER 1
#endif
#endif
#ifndef PL_ADDRESS_SANITIZER
#define PL_ADDRESS_SANITIZER 0
#endif

#endif
