/* The version of Plumb. It is stated here alone: the build, the packages and the program take it from
 * here. The three numbers are those of Semantic Versioning; until 1.0.0, a new MINOR may change the
 * interface of the engine, and a new PATCH does not. */
#ifndef PLUMB_VERSION_H
#define PLUMB_VERSION_H

#define PLUMB_VERSION "0.2.0"

/* For comparisons by the preprocessor: #if PLUMB_VERSION_NUMBER >= 200 */
#define PLUMB_VERSION_MAJOR 0
#define PLUMB_VERSION_MINOR 2
#define PLUMB_VERSION_PATCH 0
#define PLUMB_VERSION_NUMBER                                                                       \
    (10000 * PLUMB_VERSION_MAJOR + 100 * PLUMB_VERSION_MINOR + PLUMB_VERSION_PATCH)

#endif
