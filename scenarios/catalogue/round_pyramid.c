#include "round_pyramid.h"

pl_builder pl_build_round_pyramid(pl_scene *scene, const char *name, double dt, double duration,
                                  double friction, double floor_friction, pl_error *error)
{
    pl_builder builder = pl_build_begin(scene, name, dt, duration, friction, error);
    pl_body floor = pl_body_default();
    floor.is_static = true;
    floor.material = pl_build_material(&builder, "floor", floor_friction);
    floor.shape = pl_shape_plane(0, 0, 1, 0);
    pl_build_body(&builder, &floor, "floor");
    pl_build_pair(&builder, 0, floor.material, floor_friction);
    return builder;
}
