/* A box falls onto a plane and comes to rest. */
#include <plumb/engine.h>
#include <stdio.h>

int main(void)
{
    pe_error error;
    pe_world *world;
    pe_world_def def = pe_world_def_default();
    if (pe_world_create(&def, &world, &error) != PE_OK) {
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    pe_body_def plane = pe_body_def_default(), box = pe_body_def_default();
    plane.shape = (pe_shape){.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}};
    plane.is_static = true;
    box.shape = (pe_shape){.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}};
    box.position.z = 2;
    pe_body_id ground, id;
    pe_status status = pe_body_create(world, &plane, &ground, &error);
    status = status == PE_OK ? pe_body_create(world, &box, &id, &error) : status;
    for (int step = 0; status == PE_OK && step < 120; ++step) {
        status = pe_world_step(world, 1.0 / 60, NULL, &error);
    }
    pe_body_state state;
    status = status == PE_OK ? pe_body_get_state(world, id, &state, &error) : status;
    pe_world_destroy(world);
    if (status != PE_OK) {
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    printf("z = %.9f m\n", state.position.z);
}
