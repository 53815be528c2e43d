/* Helpers of the adapters of native engines, for C and C++. */
#ifndef PLUMB_NATIVE_H
#define PLUMB_NATIVE_H

#include "plumb/adapter_helpers.h"
#include "plumb/base.h"

#include <string.h>
#include <time.h>

#ifdef __cplusplus
#define PL_EXTERN_C extern "C"
#else
#define PL_EXTERN_C extern
#endif

/* Declares the functions of an engine: pl_NAME_create is `create` of pl_engine, and so on. */
#define PL_ENGINE_FUNCTIONS(name)                                                                  \
    PL_EXTERN_C void pl_##name##_defaults(int profile, double *values);                            \
    PL_EXTERN_C pl_status pl_##name##_create(const pl_engine_setup *setup,                         \
                                             pl_engine_instance **out, pl_error *error);           \
    PL_EXTERN_C void pl_##name##_destroy(pl_engine_instance *instance);                            \
    PL_EXTERN_C pl_status pl_##name##_step(pl_engine_instance *instance, double dt,                \
                                           pl_step_stats *stats, pl_error *error);                 \
    PL_EXTERN_C void pl_##name##_read_frame(const pl_engine_instance *instance, pl_frame *frame);  \
    PL_EXTERN_C void pl_##name##_read_settings(const pl_engine_instance *instance,                 \
                                               pl_engine_settings *settings);                      \
    PL_EXTERN_C void pl_##name##_read_pair(const pl_engine_instance *instance, int body_a,         \
                                           int body_b, pl_pair_coefficients *found);               \
    PL_EXTERN_C int pl_##name##_read_contacts(const pl_engine_instance *instance,                  \
                                              pl_contact *contacts, int capacity);

/* Defines the function that returns the table of an engine: these functions, and what the header that is
 * made of its engine.json has. */
#define PL_ENGINE(entry, name_)                                                                    \
    const pl_engine *entry(void);                                                                  \
    const pl_engine *entry(void)                                                                   \
    {                                                                                              \
        static const pl_engine engine = {                                                          \
            ENGINE_DESCRIPTION,                                                                    \
            .profile_defaults = pl_##name_##_defaults,                                             \
            .create = pl_##name_##_create,                                                         \
            .destroy = pl_##name_##_destroy,                                                       \
            .step = pl_##name_##_step,                                                             \
            .read_frame = pl_##name_##_read_frame,                                                 \
            .read_settings = pl_##name_##_read_settings,                                           \
            .read_pair = pl_##name_##_read_pair,                                                   \
            .read_contacts = pl_##name_##_read_contacts,                                           \
        };                                                                                         \
        return &engine;                                                                            \
    }

/* The index of a hull or a mesh among those of the scene; -1: it is none of them. */
static inline int pl_polyhedron_index(const pl_scene *scene, const pl_polyhedron *polyhedron)
{
    int i = polyhedron == NULL ? -1 : scene->polyhedron_count - 1;
    while (i >= 0 && scene->polyhedra[i] != polyhedron) {
        --i;
    }
    return i;
}

/* Seconds since some time. */
static inline double pl_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Bytes that the dense matrices of a solver may take. */
static const double pl_dense_limit = 4 * 1024.0 * 1024.0 * 1024.0;

/* PL_UNSUPPORTED: the dense matrices of that many contact rows take more than the limit. */
static inline pl_status pl_refuse_dense(pl_error *error, const char *engine, const char *profile,
                                        double rows, double bytes)
{
    const double gibibyte = 1024.0 * 1024.0 * 1024.0;
    return pl_fail(error, PL_UNSUPPORTED,
                   "%s:%s needs %.1f GiB for the dense matrices of %.0f contact rows; the limit is "
                   "%.0f GiB",
                   engine, profile, bytes / gibibyte, rows, pl_dense_limit / gibibyte);
}

/* Sets a contact of two bodies as engines have it: the normal points from the second to the first, and
 * the impulse (N s) acts on the first. Of the contact, A is the body with the lesser index. */
static inline void pl_set_contact(pl_contact *contact, int first, int second, const double point[3],
                                  const double normal[3], double separation,
                                  const double impulse[3])
{
    const bool in_order = first < second;
    memset(contact, 0, sizeof *contact);
    contact->body_a = in_order ? first : second;
    contact->body_b = in_order ? second : first;
    contact->separation = separation;
    for (int k = 0; k < 3; ++k) {
        contact->point[k] = point[k];
        contact->normal[k] = in_order ? -normal[k] : normal[k];
        contact->impulse[k] = in_order ? -impulse[k] : impulse[k];
    }
}

#endif
