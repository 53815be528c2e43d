/* An engine that makes four sub-steps of a step, which it declares. Its contacts are those of the
 * pose before the step and those that come later; their impulses are summed over the sub-steps. */
#include "fault_variant.h"

#include <stdlib.h>
#include <string.h>

enum { SUBSTEPS = 4 };

typedef struct contact_list {
    pl_contact *items;  /* (count) */
    double (*place)[3]; /* (count), m: of the contact in the last sub-step that had it */
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

/* The contact of the same bodies that was nearest, within 2 cm; -1 when there is none. */
static int find_contact(const contact_list *list, int first, const pl_contact *contact)
{
    int best = -1;
    double least = 4e-4;
    for (int i = 0; i < first; ++i) {
        const pl_contact *other = &list->items[i];
        const double distance = squared_distance(list->place[i], contact->point);
        if (other->body_a == contact->body_a && other->body_b == contact->body_b &&
            distance < least) {
            best = i;
            least = distance;
        }
    }
    return best;
}

static void make_room(contact_list *list)
{
    if (list->count == list->capacity) {
        list->capacity = 2 * list->capacity + 8;
        list->items = realloc(list->items, (size_t)list->capacity * sizeof *list->items);
        list->place = realloc(list->place, (size_t)list->capacity * sizeof *list->place);
        if (list->items == NULL || list->place == NULL) {
            abort();
        }
    }
}

/* Adds the contacts of a sub-step to those of the step. */
static void merge_contacts(contact_list *list, const variant_instance *v)
{
    const int before = list->count;
    for (int i = 0; i < v->contact_count; ++i) {
        const pl_contact *contact = &v->contacts[i];
        int same = find_contact(list, before, contact);
        if (same < 0) {
            make_room(list);
            same = list->count++;
            list->items[same] = *contact;
        } else {
            for (int k = 0; k < 3; ++k) {
                list->items[same].impulse[k] += contact->impulse[k];
            }
        }
        memcpy(list->place[same], contact->point, sizeof list->place[same]);
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
    free(list.place);
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
