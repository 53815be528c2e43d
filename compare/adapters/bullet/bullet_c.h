/* A C interface over Bullet's public C++ classes: the functions of pl_engine for a world of Bullet's. It
 * converts conventions to those of plumb/engine_abi.h: quaternions (w, x, y, z), normals from A to B,
 * impulses on B. No C++ exception passes through it. */
#ifndef PLUMB_BULLET_C_H
#define PLUMB_BULLET_C_H

#include "plumb/engine_abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As profile_defaults: the settings that Bullet's own constructors make, also those of a library that was
 * built with others; for `recommended`, those of its sources. */
void pl_bullet_defaults(int profile, double *values);

/* As create. PL_UNSUPPORTED for a shape that Bullet has not, PL_NO_MEMORY. */
pl_status pl_bullet_create(const pl_engine_setup *setup, pl_engine_instance **out, pl_error *error);

/* As destroy. Says on standard error how often a dense solver left islands to sequential impulse. */
void pl_bullet_destroy(pl_engine_instance *instance);

/* As step. PL_UNSUPPORTED, before solving, when a dense solver needs more memory than the limit.
 * PL_FAILED when Bullet threw. */
pl_status pl_bullet_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                         pl_error *error);

/* As read_frame. */
void pl_bullet_read_frame(const pl_engine_instance *instance, pl_frame *frame);

/* As read_settings: gravity, masses and principal inertia. */
void pl_bullet_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings);

/* As read_pair. */
void pl_bullet_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                         pl_pair_coefficients *found);

/* As read_contacts. */
int pl_bullet_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity);

#ifdef __cplusplus
}
#endif
#endif
