#include "view.h"

/* A view begins with tasks of many small islands, for each of which its arena is rewound. */
enum { LEAST_BLOCK = 16384 };

void pe_views_open(pe_world *world)
{
    for (int i = 0; world->views != NULL && i < pe_pool_threads(world->pool); ++i) {
        pe_world *view = &world->views[i], own = *view;
        *view = *world;
        view->pool = NULL;
        view->views = NULL;
        view->arena = own.arena;
        view->patterns = own.patterns;
        view->previous = own.previous;
        view->substep_contacts = own.substep_contacts;
        view->substep_previous = own.substep_previous;
        view->apart_array = own.apart_array;
        view->apart_count = 0;
        view->previous.manifold_count = view->previous.point_count = 0;
        pe_arena_reset(&view->arena, &view->allocator);
        view->arena.least = LEAST_BLOCK;
    }
}

pe_world *pe_view_of(pe_world *world, int worker)
{
    return world->views != NULL ? &world->views[worker] : world;
}

void pe_views_free(pe_world *world)
{
    for (int i = 0; world->views != NULL && i < pe_pool_threads(world->pool); ++i) {
        pe_world *own = &world->views[i];
        pe_contacts_free(&own->previous, &world->allocator);
        pe_contacts_free(&own->substep_contacts, &world->allocator);
        pe_contacts_free(&own->substep_previous, &world->allocator);
        pe_array_free(&own->apart_array, &world->allocator);
        pe_arena_free(&own->arena, &world->allocator);
    }
}
