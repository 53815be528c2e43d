/* Triangles of two surfaces that cross. */
#include "collide_mesh.h"

typedef struct crossings {
    double slack;
    pe_take_crossing *take;
    void *context;
} crossings;

static bool try_facets(void *context, pe_facet *a, pe_facet *b)
{
    const crossings *c = context;
    double above_a[3] = {0}, above_b[3];
    pe_vec3 where[PE_MOST_PIERCINGS];
    if (pe_facet_heights(b, a, c->slack, above_b) &&
        (a->face < 0 || pe_facet_heights(a, b, c->slack, above_a))) {
        int count = pe_facets_cross(a, above_b, b, above_a, c->slack, where);
        if (count > 0) {
            c->take(c->context, &(pe_crossing){a, b, above_a, above_b, count, where});
        }
    }
    return true;
}

void pe_solids_each_crossing(const pe_solid_pair *pair, pe_take_crossing *take, void *context)
{
    crossings c = {pair->slack, take, context};
    double bound = pair->slack;
    pe_near_facets(pair, &bound, try_facets, &c);
}
