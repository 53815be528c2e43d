/* The ranges of the numbers that a world takes, in SI units: wide enough for any scene, and narrow
 * enough that products of eight of them are finite. */
#ifndef PE_RANGES_H
#define PE_RANGES_H

#include "base/memory.h"
#include "base/vec3.h"

#define PE_LEAST_LENGTH 1e-12
#define PE_MOST_LENGTH 1e12 /* also of places */
#define PE_MOST_MARGIN 1e16 /* m: all places of a step are nearer to each other */
#define PE_MOST_SPEED 1e12  /* m/s, rad/s, m/s^2 */
#define PE_LEAST_MASS 1e-30
#define PE_MOST_MASS 1e30 /* kg; also of forces, in N */
#define PE_LEAST_INERTIA 1e-60
#define PE_MOST_INERTIA 1e60
#define PE_LEAST_TIME 1e-12
#define PE_MOST_TIME 1e12

/* No component is NaN or larger than `most` in size. */
static inline bool pe_is_within(pe_vec3 v, double most)
{
    return fabs(v.x) <= most && fabs(v.y) <= most && fabs(v.z) <= most;
}

/* PE_BAD_ARGUMENT, naming the field, unless least <= found <= most; NaN never is. */
static inline pe_status pe_check_range(const char *field, double found, double least, double most,
                                       pe_error *error)
{
    return found >= least && found <= most
               ? PE_OK
               : pe_fail(error, PE_BAD_ARGUMENT, "%s: expected a number in %g .. %g, found %g",
                         field, least, most, found);
}

/* The same of every component, in -most .. most. */
static inline pe_status pe_check_vector(const char *field, pe_vec3 found, double most,
                                        pe_error *error)
{
    return pe_is_within(found, most)
               ? PE_OK
               : pe_fail(error, PE_BAD_ARGUMENT,
                         "%s: expected finite numbers of at most %g, found (%g, %g, %g)", field,
                         most, found.x, found.y, found.z);
}

#endif
