#include "scene_builder.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static bool ready(const pl_builder *builder)
{
    return builder->status == PL_OK;
}

pl_builder pl_build_begin(pl_scene *scene, const char *name, double dt, double duration,
                          double friction, pl_error *error)
{
    pl_builder builder = {.scene = scene, .error = error};
    const pl_material material = {.name = "block", .friction = friction};
    *scene = pl_scene_default();
    snprintf(scene->name, sizeof scene->name, "%s", name);
    scene->dt = dt;
    scene->duration = duration;
    builder.status = pl_scene_add_material(scene, &material, NULL, error);
    return builder;
}

int pl_build_material(pl_builder *builder, const char *name, double friction)
{
    pl_material material = {.friction = friction};
    int index = 0;
    snprintf(material.name, sizeof material.name, "%s", name);
    if (ready(builder)) {
        builder->status = pl_scene_add_material(builder->scene, &material, &index, builder->error);
    }
    return ready(builder) ? index : 0;
}

void pl_build_pair(pl_builder *builder, int material_a, int material_b, double friction)
{
    const pl_material_pair pair = {
        .material_a = material_a, .material_b = material_b, .friction = friction};
    if (ready(builder)) {
        builder->status = pl_scene_add_pair(builder->scene, &pair, builder->error);
    }
}

void pl_build_floor(pl_builder *builder, double nx, double ny, double nz, double offset)
{
    pl_body floor = pl_body_default();
    floor.is_static = true;
    floor.shape = pl_shape_plane(nx, ny, nz, offset);
    pl_build_body(builder, &floor, "floor");
}

int pl_build_body(pl_builder *builder, const pl_body *body, const char *name, ...)
{
    if (!ready(builder)) {
        return -1;
    }
    pl_body named = *body;
    va_list arguments;
    va_start(arguments, name);
    vsnprintf(named.name, sizeof named.name, name, arguments);
    va_end(arguments);
    int index = -1;
    builder->status = pl_scene_add_body(builder->scene, &named, &index, builder->error);
    return index;
}

void pl_build_rest(pl_builder *builder, int body)
{
    if (!ready(builder)) {
        return;
    }
    const pl_body *resting = &builder->scene->bodies[body];
    pl_expect_rest rest = {.body = body, .has_orientation = true};
    memcpy(rest.position, resting->position, sizeof rest.position);
    memcpy(rest.orientation, resting->orientation, sizeof rest.orientation);
    builder->status = pl_scene_add_rest(builder->scene, &rest, builder->error);
}

void pl_build_travel(pl_builder *builder, const pl_expect_travel *travel)
{
    if (ready(builder)) {
        builder->status = pl_scene_add_travel(builder->scene, travel, builder->error);
    }
}

void pl_build_value(pl_builder *builder, const pl_expect_value *value)
{
    if (ready(builder)) {
        builder->status = pl_scene_add_value(builder->scene, value, builder->error);
    }
}

void pl_build_judge(pl_builder *builder, const char *primary_error, double collapse_distance)
{
    pl_scene *scene = builder->scene;
    snprintf(scene->primary_error, sizeof scene->primary_error, "%s", primary_error);
    scene->collapse_distance = collapse_distance;
}

pl_status pl_build_end(pl_builder *builder)
{
    if (ready(builder)) {
        builder->status = pl_scene_validate(builder->scene, builder->error);
    }
    if (!ready(builder)) {
        pl_scene_free(builder->scene);
    }
    return builder->status;
}
