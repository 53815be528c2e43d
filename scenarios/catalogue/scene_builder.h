/* What all scenarios do to build a scene, without a check after every line: the first failure is
 * kept, the calls after it do nothing, and pl_build_end reports it. */
#ifndef PLUMB_SCENE_BUILDER_H
#define PLUMB_SCENE_BUILDER_H

#include "plumb/scene.h"

typedef struct pl_builder {
    pl_scene *scene;
    pl_status status;
    pl_error *error; /* NULL allowed */
} pl_builder;

/* Begins an empty scene with one material, number 0, of this friction and without restitution. */
pl_builder pl_build_begin(pl_scene *scene, const char *name, double dt, double duration,
                          double friction, pl_error *error);

/* Adds a material without restitution and returns its index; 0 after a failure. */
int pl_build_material(pl_builder *builder, const char *name, double friction);

/* The friction between two materials, in place of the geometric mean of theirs. */
void pl_build_pair(pl_builder *builder, int material_a, int material_b, double friction);

/* A static plane "floor" of material 0. */
void pl_build_floor(pl_builder *builder, double nx, double ny, double nz, double offset);

/* Adds `body`, named as printf does, and returns its index; -1 after a failure. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int pl_build_body(pl_builder *builder, const pl_body *body, const char *name, ...);

/* Expects a body to end where it starts. */
void pl_build_rest(pl_builder *builder, int body);

/* Expects a body to travel; `travel` has its index. */
void pl_build_travel(pl_builder *builder, const pl_expect_travel *travel);

/* Expects a value; `value` has its body's index. */
void pl_build_value(pl_builder *builder, const pl_expect_value *value);

/* Sets the primary error and the distance beyond which a resting body has fallen (INFINITY: none).
 */
void pl_build_judge(pl_builder *builder, const char *primary_error, double collapse_distance);

/* Validates. On failure the scene is left empty. */
pl_status pl_build_end(pl_builder *builder);

#endif
