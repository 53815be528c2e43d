/* Scenes in DART: functions of pl_engine. */
#ifndef PLUMB_DART_WORLD_H
#define PLUMB_DART_WORLD_H

#include "plumb/engine_abi.h"

/* As create of pl_engine. The settings of contacts are DART's global variables: the world that was made last
 * has them. */
pl_status pl_dart_create(const pl_engine_setup *setup, pl_engine_instance **out, pl_error *error);

/* As destroy of pl_engine. */
void pl_dart_destroy(pl_engine_instance *instance);

/* As step of pl_engine. PL_UNSUPPORTED, before solving, when the dense matrices of a group take more than
 * 4 GiB. */
pl_status pl_dart_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                       pl_error *error);

/* As read_frame of pl_engine. */
void pl_dart_read_frame(const pl_engine_instance *instance, pl_frame *frame);

/* As read_settings of pl_engine. */
void pl_dart_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings);

/* As read_pair of pl_engine: DART's rule of mixing on what its shapes store; NAN where no shapes of
 * the two bodies are meant to touch. */
void pl_dart_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                       pl_pair_coefficients *found);

/* As read_contacts of pl_engine. */
int pl_dart_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity);

#endif
