#include "motion_order.h"

#include "check.h"

#include <math.h>

static const double EXACT = 1e-10; /* what counts as no error, in m or rad */

double order_step(int k)
{
    return 1.0 / (60 << k);
}

double order_of(const char *name, const double error[STEP_SIZES])
{
    double most = 0;
    for (int k = 0; k < STEP_SIZES; ++k) {
        most = fmax(most, error[k]);
    }
    if (most < EXACT) {
        print_message("%-44s exact: %.1e at most\n", name, most);
        return HUGE_VAL;
    }
    double order = log2(error[0] / error[STEP_SIZES - 1]) / (STEP_SIZES - 1);
    print_message("%-44s order %.3f: errors", name, order);
    for (int k = 0; k < STEP_SIZES; ++k) {
        print_message(" %.3e", error[k]);
    }
    print_message(", orders");
    for (int k = 0; k + 1 < STEP_SIZES; ++k) {
        print_message(" %.2f", log2(error[k] / error[k + 1]));
    }
    print_message("\n");
    return order;
}

void assert_order(const char *name, const double error[STEP_SIZES], double least)
{
    double order = order_of(name, error);
    if (!(order >= least)) {
        fail_msg("%s: of order %.3f, expected at least %.2f", name, order, least);
    }
}

pe_world *accurate_world(pe_vec3 gravity)
{
    pe_world_def def = pe_world_def_default();
    def.profile = PE_PROFILE_ACCURATE;
    def.gravity = gravity;
    def.restitution_threshold = 0;
    return make_world(&def);
}

void step_times(pe_world *world, double h, int count)
{
    for (int i = 0; i < count; ++i) {
        step(world, h);
    }
}

on_plane put_on_plane(pe_vec3 gravity, double friction, double restitution, pe_body_def def)
{
    on_plane p = {.world = accurate_world(gravity)};
    def.material = add_material(p.world, friction, restitution);
    add_plane(p.world, (pe_vec3){0, 0, 1}, def.material);
    p.body = add_body(p.world, &def);
    return p;
}

pe_vec3 slope_gravity(double angle)
{
    return (pe_vec3){GRAVITY * sin(angle), 0, -GRAVITY * cos(angle)};
}

pe_body_def sphere_def(double radius, double height)
{
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = radius};
    def.position = (pe_vec3){0, 0, height};
    return def;
}
