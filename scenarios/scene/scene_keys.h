/* The keys of every object of a scene file. scene.schema.json says the same with types and meaning;
 * a test holds the two together. */
#ifndef PLUMB_SCENE_KEYS_H
#define PLUMB_SCENE_KEYS_H

#include "base/json_field.h"

typedef enum pl_object_kind {
    PL_OBJECT_SCENE,
    PL_OBJECT_MATERIAL,
    PL_OBJECT_PAIR,
    PL_OBJECT_BODY,
    PL_OBJECT_PLANE, /* and the other shapes, in the order of pl_shape_kind */
    PL_OBJECT_SPHERE,
    PL_OBJECT_BOX,
    PL_OBJECT_CAPSULE,
    PL_OBJECT_CYLINDER,
    PL_OBJECT_HULL,
    PL_OBJECT_MESH,
    PL_OBJECT_FORCE,
    PL_OBJECT_EXPECT,
    PL_OBJECT_REST,
    PL_OBJECT_TRAVEL,
    PL_OBJECT_VALUE,
    PL_OBJECT_COUNT
} pl_object_kind;

/* (PL_OBJECT_COUNT) */
extern const pl_key_set pl_scene_keys[];

/* The names of the shapes as a scene file has them, by pl_shape_kind. */
extern const char *const pl_shape_names[];

/* The names of the quantities, by pl_quantity. */
extern const char *const pl_quantity_names[];

#endif
