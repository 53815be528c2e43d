/* Variants of a working engine: the project's own engine behind another adapter, which passes every
 * call on and changes one thing. The profiles of broken_setup.c, broken_step.c and
 * broken_read.c are wrong and must fail `plumb check-engine`; float_engine.c and substep_engine.c are
 * unusual and must pass.
 *
 * What an instance reads back of its settings is the scene as it was given, whatever it simulates:
 * a variant is recognised by what it does. */
#ifndef VARIANT_H
#define VARIANT_H

#include "plumb/engine_abi.h"

/* A scene in a variant. */
typedef struct variant_instance {
    const struct variant *variant;
    const pl_engine_setup *given; /* by the harness */
    pl_engine_setup setup;        /* for the inner engine; its scene and pairs are those below */
    pl_scene scene;               /* its materials, pairs, bodies and forces are copies */
    pl_pair_coefficients *pairs;  /* (material_count x material_count) */
    pl_engine_instance *inner;
    pl_body_state *states; /* (body_count) after the last step */
    pl_body_state *before; /* (body_count) before it */
    pl_contact *contacts;  /* (contact_count) of the last step */
    int contact_count, contact_capacity;
    long steps;
    double time;      /* s, by the harness's steps */
    double simulated; /* s, by the inner engine's; both differ within a step */
} variant_instance;

/* What is changed. NULL: nothing in that place. */
typedef struct variant {
    const char *name, *help;
    /* Changes v->setup, v->scene and v->pairs before the inner engine reads them. */
    void (*change_setup)(variant_instance *v);
    /* Makes the step, in place of variant_step. */
    pl_status (*step)(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error);
    /* Changes what read_frame gives. */
    void (*change_frame)(const variant_instance *v, pl_frame *frame);
    /* Changes what read_contacts gives; returns the number that it returns. */
    int (*change_contacts)(const variant_instance *v, pl_contact *contacts, int count);
    /* Changes what read_settings and read_pair give. */
    void (*change_settings)(const variant_instance *v, pl_engine_settings *settings);
    void (*change_pair)(const variant_instance *v, pl_pair_coefficients *pair);
} variant;

/* An engine whose profiles are `count` variants, at most PL_ENGINE_MAX_PROFILES. Both live as long
 * as the engine. There is one of them in a shared object. */
pl_engine variant_engine(const char *name, const variant *variants, int count);

/* A step of the inner engine: reads the states and the contacts after it. */
pl_status variant_step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error);

/* Creates the inner engine again with v->states and v->pairs as they are now. Its contacts, read
 * before, stay. */
pl_status variant_restart(variant_instance *v, pl_error *error);

/* Gives v->scene `count` new materials, and v->pairs room for their pairs, all zero. */
void variant_set_materials(variant_instance *v, int count);

/* Sets the friction and restitution of every two materials in the scene to those of v->pairs. */
void variant_use_pairs(variant_instance *v);

#endif
