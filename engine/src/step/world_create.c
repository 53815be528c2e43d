/* Creates and destroys worlds. */
#include "broad_phase/broad_phase.h"
#include "model/geometry.h"
#include "model/ranges.h"
#include "model/rest.h"
#include "model/view.h"
#include "sparse/pattern_store.h"

/* A world and what the phases of the step keep in it, in one block of memory. */
typedef struct full_world {
    pe_world world; /* first: a pointer to it is one to the block */
    pe_broad broad;
    pe_pattern_store patterns;
    pe_rest rest;
} full_world;

pe_world_def pe_world_def_default(void)
{
    return (pe_world_def){
        .gravity = {0, 0, -9.81},
        .tolerance = 1e-8,
        .max_contact_updates = 2.4e6,
        .max_iterations = 100000,
        .restitution_threshold = 0,
        .impact_bodies = 2,
        .contact_margin = 1e-3,
        .penetration_slop = 1e-4,
        .threads = 1,
    };
}

static pe_status check_def(const pe_world_def *def, pe_error *error)
{
    if (def->profile < PE_PROFILE_DEFAULT || def->profile > PE_PROFILE_FAST) {
        return pe_fail(error, PE_BAD_ARGUMENT, "profile: expected one of pe_profile, found %d",
                       (int)def->profile);
    }
    pe_status status = pe_check_vector("gravity", def->gravity, PE_MOST_SPEED, error);
    const struct {
        const char *name;
        double found, least, most;
    } numbers[] = {
        {"tolerance", def->tolerance, 1e-30, PE_MOST_SPEED},
        {"max_contact_updates", def->max_contact_updates, 1, 1e30},
        {"restitution_threshold", def->restitution_threshold, 0, PE_MOST_SPEED},
        {"contact_margin", def->contact_margin, 0, PE_MOST_LENGTH},
        {"penetration_slop", def->penetration_slop, 1e-30, PE_MOST_LENGTH},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0] && status == PE_OK; ++i) {
        status = pe_check_range(numbers[i].name, numbers[i].found, numbers[i].least,
                                numbers[i].most, error);
    }
    if (status != PE_OK) {
        return status;
    }
    if (def->max_iterations < 1) {
        return pe_fail(error, PE_BAD_ARGUMENT, "max_iterations: expected at least 1, found %d",
                       def->max_iterations);
    }
    if (def->impact_bodies < 0) {
        return pe_fail(error, PE_BAD_ARGUMENT, "impact_bodies: expected at least 0, found %d",
                       def->impact_bodies);
    }
    if (def->threads < 1 || def->threads > PE_MOST_THREADS) {
        return pe_fail(error, PE_BAD_ARGUMENT, "threads: expected 1 to %d, found %d",
                       PE_MOST_THREADS, def->threads);
    }
    if ((def->tasks.run == NULL) != (def->tasks.wait == NULL)) {
        return pe_fail(error, PE_BAD_ARGUMENT, "tasks: expected both functions or neither");
    }
    if ((def->allocator.allocate == NULL) != (def->allocator.release == NULL)) {
        return pe_fail(error, PE_BAD_ARGUMENT, "allocator: expected both functions or neither");
    }
    return PE_OK;
}

/* Starts the threads, and makes a view for each, with a store of patterns. */
static pe_status create_threads(pe_world *world, pe_error *error)
{
    const pe_allocator *allocator = &world->allocator;
    pe_status status = pe_pool_create(&world->def, allocator, &world->pool, error);
    if (status != PE_OK || world->pool == NULL) {
        return status;
    }
    const size_t count = (size_t)world->def.threads;
    pe_world *views = allocator->allocate(allocator->context, count * sizeof *views);
    pe_pattern_store *stores = allocator->allocate(allocator->context, count * sizeof *stores);
    if (views == NULL || stores == NULL) {
        pe_release(allocator, views);
        pe_release(allocator, stores);
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu threads", count);
    }
    for (size_t i = 0; i < count; ++i) {
        stores[i] = (pe_pattern_store){0};
        views[i] = (pe_world){.patterns = &stores[i]};
    }
    world->views = views;
    return PE_OK;
}

static void destroy_threads(pe_world *world)
{
    if (world->views != NULL) {
        pe_pattern_store *stores = world->views[0].patterns;
        for (int i = 0; i < world->def.threads; ++i) {
            pe_pattern_store_free(&stores[i], &world->allocator);
        }
        pe_views_free(world);
        pe_release(&world->allocator, stores);
        pe_release(&world->allocator, world->views);
    }
    pe_pool_destroy(world->pool, &world->allocator);
}

pe_status pe_world_create(const pe_world_def *def, pe_world **world, pe_error *error)
{
    *world = NULL;
    pe_status status = check_def(def, error);
    if (status != PE_OK) {
        return status;
    }
    pe_allocator allocator =
        def->allocator.allocate != NULL ? def->allocator : pe_allocator_default();
    full_world *block = allocator.allocate(allocator.context, sizeof *block);
    if (block == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for a world");
    }
    *block = (full_world){.world = {.def = *def,
                                    .allocator = allocator,
                                    .broad = &block->broad,
                                    .patterns = &block->patterns,
                                    .rest = &block->rest}};
    pe_world *made = &block->world;

    /* Slot 0 is the static dummy, and material 0 the default one. */
    pe_body_def dummy = pe_body_def_default();
    dummy.is_static = true;
    pe_body_id id;
    pe_material_id material;
    status = create_threads(made, error);
    if (status == PE_OK) {
        status = pe_material_create(made, 0.5, 0, &material, error);
    }
    if (status == PE_OK) {
        status = pe_body_create(made, &dummy, &id, error);
    }
    if (status != PE_OK) {
        pe_world_destroy(made);
        return status;
    }
    pe_bodies(made)[0].alive = false;
    *world = made;
    return PE_OK;
}

void pe_world_destroy(pe_world *world)
{
    if (world == NULL) {
        return;
    }
    pe_allocator allocator = world->allocator;
    destroy_threads(world);
    pe_array *arrays[] = {
        &world->body_array,          &world->pose_array,          &world->twist_array,
        &world->mass_array,          &world->applied_force_array, &world->record_array,
        &world->material_pair_array, &world->start_pose_array,    &world->apart_array,
    };
    pe_contacts *lists[] = {&world->contacts, &world->previous, &world->solved,
                            &world->substep_contacts, &world->substep_previous};
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; ++i) {
        pe_array_free(arrays[i], &allocator);
    }
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; ++i) {
        pe_contacts_free(lists[i], &allocator);
    }
    pe_geometry **geometries = world->geometry_array.items;
    for (int i = 0; i < world->geometry_count; ++i) {
        pe_geometry_free(geometries[i], &allocator);
    }
    pe_array_free(&world->geometry_array, &allocator);
    pe_broad_free(world->broad, &allocator);
    pe_pattern_store_free(world->patterns, &allocator);
    pe_rest_free(world->rest, &allocator);
    pe_arena_free(&world->arena, &allocator);
    pe_release(&allocator, world);
}

void pe_world_get_gravity(const pe_world *world, pe_vec3 *gravity)
{
    *gravity = world->def.gravity;
}
