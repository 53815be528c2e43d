/* Passes every call on to the inner engine. */
#include "fault_variant.h"

#include "adapters/plumb/adapter_plumb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const variant *all;
static pl_engine_profile profiles[PL_ENGINE_MAX_PROFILES];

static variant_instance *own(const pl_engine_instance *instance)
{
    return (variant_instance *)instance;
}

/* Zeros for `count` items, with room for one more at least. Ends the process without memory. */
static void *zeros(size_t count, size_t size)
{
    void *made = calloc(count + 1, size);
    if (made == NULL) {
        abort();
    }
    return made;
}

/* A copy of `count` items. */
static void *copy_of(const void *items, size_t count, size_t size)
{
    void *copy = zeros(count, size);
    if (count > 0) {
        memcpy(copy, items, count * size);
    }
    return copy;
}

void variant_set_materials(variant_instance *v, int count)
{
    free(v->scene.materials);
    free(v->pairs);
    v->scene.materials = zeros((size_t)count, sizeof *v->scene.materials);
    v->scene.material_count = count;
    v->pairs = zeros((size_t)count * (size_t)count, sizeof *v->pairs);
    v->setup.pairs = v->pairs;
}

void variant_use_pairs(variant_instance *v)
{
    const int count = v->scene.material_count;
    free(v->scene.pairs);
    v->scene.pairs = zeros((size_t)(count * count), sizeof *v->scene.pairs);
    v->scene.pair_count = 0;
    for (int i = 0; i < count; ++i) {
        for (int k = i; k < count; ++k) {
            const pl_pair_coefficients pair = v->pairs[i * count + k];
            v->scene.pairs[v->scene.pair_count++] =
                (pl_material_pair){i, k, pair.friction, pair.restitution};
        }
    }
}

static void read_states(variant_instance *v)
{
    pl_frame frame = {.body_count = v->scene.body_count, .bodies = v->states};
    pl_engine_plumb()->read_frame(v->inner, &frame);
}

static void read_inner_contacts(variant_instance *v)
{
    const pl_engine *engine = pl_engine_plumb();
    int count = engine->read_contacts(v->inner, v->contacts, v->contact_capacity);
    if (count > v->contact_capacity) {
        free(v->contacts);
        v->contacts = zeros((size_t)count, sizeof *v->contacts);
        v->contact_capacity = count;
        count = engine->read_contacts(v->inner, v->contacts, v->contact_capacity);
    }
    v->contact_count = count;
}

static void destroy(pl_engine_instance *instance)
{
    variant_instance *v = own(instance);
    if (v != NULL) {
        pl_engine_plumb()->destroy(v->inner);
        free(v->scene.materials);
        free(v->scene.pairs);
        free(v->scene.bodies);
        free(v->scene.forces);
        free(v->pairs);
        free(v->states);
        free(v->before);
        free(v->contacts);
        free(v);
    }
}

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const size_t materials = (size_t)scene->material_count, bodies = (size_t)scene->body_count;
    variant_instance *v = zeros(1, sizeof *v);
    v->variant = &all[setup->profile];
    v->given = setup;
    v->setup = *setup;
    v->scene = *scene;
    v->scene.materials = copy_of(scene->materials, materials, sizeof *scene->materials);
    v->scene.pairs = copy_of(scene->pairs, (size_t)scene->pair_count, sizeof *scene->pairs);
    v->scene.bodies = copy_of(scene->bodies, bodies, sizeof *scene->bodies);
    v->scene.forces = copy_of(scene->forces, (size_t)scene->force_count, sizeof *scene->forces);
    v->pairs = copy_of(setup->pairs, materials * materials, sizeof *v->pairs);
    v->states = zeros(bodies, sizeof *v->states);
    v->before = zeros(bodies, sizeof *v->before);
    v->setup.scene = &v->scene;
    v->setup.pairs = v->pairs;
    v->setup.profile = 0;
    if (v->variant->change_setup != NULL) {
        v->variant->change_setup(v);
    }
    const pl_status status = pl_engine_plumb()->create(&v->setup, &v->inner, error);
    if (status != PL_OK) {
        destroy((pl_engine_instance *)v);
        return status;
    }
    read_states(v);
    *instance = (pl_engine_instance *)v;
    return PL_OK;
}

pl_status variant_restart(variant_instance *v, pl_error *error)
{
    pl_engine_plumb()->destroy(v->inner);
    v->inner = NULL;
    for (int i = 0; i < v->scene.body_count; ++i) {
        const pl_body_state *state = &v->states[i];
        pl_body *body = &v->scene.bodies[i];
        double norm = 0;
        for (int k = 0; k < 4; ++k) {
            norm += state->orientation[k] * state->orientation[k];
        }
        for (int k = 0; k < 4; ++k) {
            body->orientation[k] = state->orientation[k] / sqrt(norm);
        }
        memcpy(body->position, state->position, sizeof body->position);
        memcpy(body->velocity, state->velocity, sizeof body->velocity);
        memcpy(body->angular_velocity, state->angular_velocity, sizeof body->angular_velocity);
    }
    for (int i = 0; i < v->scene.force_count; ++i) {
        v->scene.forces[i].from = v->given->scene->forces[i].from - v->simulated;
        v->scene.forces[i].until = v->given->scene->forces[i].until - v->simulated;
    }
    return pl_engine_plumb()->create(&v->setup, &v->inner, error);
}

pl_status variant_step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    const pl_status status = pl_engine_plumb()->step(v->inner, dt, stats, error);
    if (status == PL_OK) {
        v->simulated += dt;
        read_states(v);
        read_inner_contacts(v);
    }
    return status;
}

static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    variant_instance *v = own(instance);
    memcpy(v->before, v->states, (size_t)v->scene.body_count * sizeof *v->states);
    const pl_status status =
        (v->variant->step != NULL ? v->variant->step : variant_step)(v, dt, stats, error);
    v->steps += 1;
    v->time += dt;
    return status;
}

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    const variant_instance *v = own(instance);
    frame->time = v->time;
    memcpy(frame->bodies, v->states, (size_t)frame->body_count * sizeof *frame->bodies);
    if (v->variant->change_frame != NULL) {
        v->variant->change_frame(v, frame);
    }
}

static int read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    const variant_instance *v = own(instance);
    pl_contact *all_contacts = copy_of(v->contacts, (size_t)v->contact_count, sizeof *contacts);
    int count = v->contact_count;
    if (v->variant->change_contacts != NULL) {
        count = v->variant->change_contacts(v, all_contacts, count);
    }
    const int filled = count < capacity ? count : capacity;
    if (filled > 0) {
        memcpy(contacts, all_contacts, (size_t)filled * sizeof *contacts);
    }
    free(all_contacts);
    return count;
}

static void read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    const variant_instance *v = own(instance);
    memcpy(settings->gravity, v->given->scene->gravity, sizeof settings->gravity);
    settings->dt = v->given->dt;
    settings->linear_damping = 0;
    settings->angular_damping = 0;
    for (int i = 0; i < settings->body_count; ++i) {
        const pl_body *body = &v->given->scene->bodies[i];
        settings->mass[i] = body->is_static ? 0 : body->mass;
        for (int k = 0; k < 3; ++k) {
            settings->inertia[i][k] = body->is_static ? 0 : body->inertia[k];
        }
    }
    if (v->variant->change_settings != NULL) {
        v->variant->change_settings(v, settings);
    }
}

static void read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                      pl_pair_coefficients *found)
{
    const variant_instance *v = own(instance);
    *found = pl_setup_pair(v->given, body_a, body_b);
    if (v->variant->change_pair != NULL) {
        v->variant->change_pair(v, found);
    }
}

pl_engine variant_engine(const char *name, const variant *variants, int count)
{
    const pl_engine *inner = pl_engine_plumb();
    all = variants;
    for (int i = 0; i < count && i < PL_ENGINE_MAX_PROFILES; ++i) {
        profiles[i] = (pl_engine_profile){.name = variants[i].name, .help = variants[i].help};
    }
    pl_engine engine = *inner;
    engine.name = name;
    engine.version = "1";
    engine.profiles = profiles;
    engine.profile_count = count;
    engine.profile_defaults = NULL;
    engine.create = create;
    engine.destroy = destroy;
    engine.step = step;
    engine.read_frame = read_frame;
    engine.read_settings = read_settings;
    engine.read_pair = read_pair;
    engine.read_contacts = read_contacts;
    engine.extension = NULL;
    return engine;
}
