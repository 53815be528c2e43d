/* An engine that makes four sub-steps of a step, which it declares. Its contacts are those of the
 * pose before the step and those that come later; their impulses are summed over the sub-steps. */
#include "variant.h"

#include <stdlib.h>
#include <string.h>

enum { SUBSTEPS = 4 };

typedef struct contact_list {
    pl_contact *items; /* (count) */
    int count, capacity;
} contact_list;

static double squared_distance(const double a[3], const double b[3])
{
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    return sum;
}

/* The contact of the same bodies that is nearest, within 2 cm; NULL when there is none. */
static pl_contact *find_contact(contact_list *list, int first, const pl_contact *contact)
{
    pl_contact *best = NULL;
    double least = 4e-4;
    for (int i = 0; i < first; ++i) {
        pl_contact *other = &list->items[i];
        const double distance = squared_distance(other->point, contact->point);
        if (other->body_a == contact->body_a && other->body_b == contact->body_b &&
            distance < least) {
            best = other;
            least = distance;
        }
    }
    return best;
}

/* Adds the contacts of a sub-step to those of the step. */
static void merge_contacts(contact_list *list, const variant_instance *v)
{
    const int before = list->count;
    for (int i = 0; i < v->contact_count; ++i) {
        const pl_contact *contact = &v->contacts[i];
        pl_contact *same = find_contact(list, before, contact);
        if (same != NULL) {
            for (int k = 0; k < 3; ++k) {
                same->impulse[k] += contact->impulse[k];
            }
            continue;
        }
        if (list->count == list->capacity) {
            list->capacity = 2 * list->capacity + 8;
            list->items = realloc(list->items, (size_t)list->capacity * sizeof *list->items);
            if (list->items == NULL) {
                abort();
            }
        }
        list->items[list->count++] = *contact;
    }
}

static pl_status step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    contact_list list = {.count = 0};
    pl_status status = PL_OK;
    for (int i = 0; i < SUBSTEPS && status == PL_OK; ++i) {
        status = variant_step(v, dt / SUBSTEPS, stats, error);
        merge_contacts(&list, v);
    }
    free(v->contacts);
    v->contacts = list.items;
    v->contact_count = list.count;
    v->contact_capacity = list.capacity;
    return status;
}

static const variant variants[] = {
    {.name = "default", .help = "four sub-steps of a step", .step = step}};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    static pl_engine engine;
    engine = variant_engine("substeps", variants, 1);
    engine.substeps = SUBSTEPS;
    return &engine;
}
