/* Materials, and the table of friction and restitution for each pair of them. */
#include "ranges.h"
#include "world.h"

#include <string.h>

static pe_status check_coefficients(double friction, double restitution, pe_error *error)
{
    pe_status status = pe_check_range("friction", friction, 0, 1e12, error);
    return status == PE_OK ? pe_check_range("restitution", restitution, 0, 1, error) : status;
}

pe_status pe_material_create(pe_world *world, double friction, double restitution,
                             pe_material_id *material, pe_error *error)
{
    pe_status status = check_coefficients(friction, restitution, error);
    if (status != PE_OK) {
        return status;
    }
    /* A table of one row and one column more. */
    size_t n = (size_t)world->material_count;
    pe_array grown = {0};
    status = pe_array_reserve(&grown, &world->allocator, sizeof(pe_material_pair),
                              (n + 1) * (n + 1), 0, error);
    if (status != PE_OK) {
        return status;
    }
    pe_material_pair *table = grown.items;
    for (size_t i = 0; i < n; ++i) {
        memcpy(table + i * (n + 1), (pe_material_pair *)world->material_pair_array.items + i * n,
               n * sizeof *table);
        pe_material_pair own = table[i * (n + 1) + i];
        pe_material_pair mixed = {sqrt(own.friction * friction),
                                  pe_max(own.restitution, restitution)};
        table[i * (n + 1) + n] = mixed;
        table[n * (n + 1) + i] = mixed;
    }
    table[n * (n + 1) + n] = (pe_material_pair){friction, restitution};
    pe_array_free(&world->material_pair_array, &world->allocator);
    world->material_pair_array = grown;
    world->material_count += 1;
    *material = (pe_material_id){(uint32_t)n};
    return PE_OK;
}

static pe_status check_pair(const pe_world *world, pe_material_id a, pe_material_id b,
                            pe_error *error)
{
    uint32_t n = (uint32_t)world->material_count;
    if (a.index >= n || b.index >= n) {
        return pe_fail(error, PE_BAD_ARGUMENT, "no material %u in a world of %u",
                       a.index >= n ? a.index : b.index, n - 1);
    }
    return PE_OK;
}

pe_status pe_world_set_pair(pe_world *world, pe_material_id a, pe_material_id b, double friction,
                            double restitution, pe_error *error)
{
    pe_status status = check_pair(world, a, b, error);
    if (status == PE_OK) {
        status = check_coefficients(friction, restitution, error);
    }
    if (status == PE_OK) {
        pe_material_pair pair = {friction, restitution};
        *pe_material_pair_of(world, (int)a.index, (int)b.index) = pair;
        *pe_material_pair_of(world, (int)b.index, (int)a.index) = pair;
        world->contacts_stale = true;
    }
    return status;
}
