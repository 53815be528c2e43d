/* The version of Plumb, by Semantic Versioning. It is stated here alone: the build, the packages and
 * the program take it from here. A program runs with the shared library of any later version that has
 * the same soname, libplumb.so.0. */
#ifndef PLUMB_VERSION_H
#define PLUMB_VERSION_H

/* MAJOR.MINOR.PATCH */
#define PLUMB_VERSION "0.2.0"
/* Grows when programs must be changed. */
#define PLUMB_VERSION_MAJOR 0
/* Grows when functions are added. */
#define PLUMB_VERSION_MINOR 2
/* Grows with corrections. */
#define PLUMB_VERSION_PATCH 0
/* For comparisons by the preprocessor, as in #if PLUMB_VERSION_NUMBER >= 200 */
#define PLUMB_VERSION_NUMBER                                                                       \
    (10000 * PLUMB_VERSION_MAJOR + 100 * PLUMB_VERSION_MINOR + PLUMB_VERSION_PATCH)

#endif
