/* What each thread of a step has to itself: a view of the world with scratch memory of its own. */
#ifndef PE_VIEW_H
#define PE_VIEW_H

#include "world.h"

/* Makes all views show the world as it is now. The arrays of a view are those of the world, except for
 * the arena, the kept patterns, `previous`, the contacts of sub-steps, and the contacts apart, which
 * are empty. It has no pool, because loops are not nested. The lists of the world must not grow, or be
 * exchanged, while views are in use. */
void pe_views_open(pe_world *world);

/* The world as the worker sees it: its view, or the world itself where it has one thread. */
pe_world *pe_view_of(pe_world *world, int worker);

/* Frees what the views have of their own. */
void pe_views_free(pe_world *world);

#endif
