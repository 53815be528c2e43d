#include "scene_keys.h"

#include "plumb/scene.h"

#define KEY_SET(name, array)                                                                       \
    {                                                                                              \
        .object = name, .keys = array, .count = sizeof array / sizeof array[0]                     \
    }

static const char *const scene_keys[] = {"plumb_scene", "name",  "gravity", "dt",     "duration",
                                         "materials",   "pairs", "shapes",  "bodies", "expect"};
static const char *const material_keys[] = {"friction", "restitution"};
static const char *const pair_keys[] = {"a", "b", "friction", "restitution"};
static const char *const body_keys[] = {
    "name",  "static",   "mass",        "density",  "inertia",          "material",
    "shape", "position", "orientation", "velocity", "angular_velocity", "forces"};
static const char *const plane_keys[] = {"type", "normal", "offset"};
static const char *const sphere_keys[] = {"type", "radius"};
static const char *const box_keys[] = {"type", "half_extents"};
static const char *const capsule_keys[] = {"type", "radius", "half_height"};
static const char *const cylinder_keys[] = {"type", "radius", "half_height"};
static const char *const hull_keys[] = {"type", "points"};
static const char *const mesh_keys[] = {"type", "file", "vertices", "triangles"};
static const char *const force_keys[] = {"force", "at", "frame", "from", "until"};
static const char *const expect_keys[] = {"rest", "travel", "values", "primary",
                                          "collapse_distance"};
static const char *const rest_keys[] = {"body", "position", "orientation"};
static const char *const travel_keys[] = {"body", "direction", "distance", "discrete"};
static const char *const value_keys[] = {"body",  "quantity", "direction", "from",
                                         "until", "value",    "discrete",  "scale"};

const pl_key_set pl_scene_keys[PL_OBJECT_COUNT] = {
    [PL_OBJECT_SCENE] = KEY_SET("scene", scene_keys),
    [PL_OBJECT_MATERIAL] = KEY_SET("material", material_keys),
    [PL_OBJECT_PAIR] = KEY_SET("pair", pair_keys),
    [PL_OBJECT_BODY] = KEY_SET("body", body_keys),
    [PL_OBJECT_PLANE] = KEY_SET("plane", plane_keys),
    [PL_OBJECT_SPHERE] = KEY_SET("sphere", sphere_keys),
    [PL_OBJECT_BOX] = KEY_SET("box", box_keys),
    [PL_OBJECT_CAPSULE] = KEY_SET("capsule", capsule_keys),
    [PL_OBJECT_CYLINDER] = KEY_SET("cylinder", cylinder_keys),
    [PL_OBJECT_HULL] = KEY_SET("hull", hull_keys),
    [PL_OBJECT_MESH] = KEY_SET("mesh", mesh_keys),
    [PL_OBJECT_FORCE] = KEY_SET("force", force_keys),
    [PL_OBJECT_EXPECT] = KEY_SET("expect", expect_keys),
    [PL_OBJECT_REST] = KEY_SET("rest", rest_keys),
    [PL_OBJECT_TRAVEL] = KEY_SET("travel", travel_keys),
    [PL_OBJECT_VALUE] = KEY_SET("value", value_keys)};

const char *const pl_shape_names[PL_SHAPE_KIND_COUNT] = {
    [PL_SHAPE_PLANE] = "plane",     [PL_SHAPE_SPHERE] = "sphere",     [PL_SHAPE_BOX] = "box",
    [PL_SHAPE_CAPSULE] = "capsule", [PL_SHAPE_CYLINDER] = "cylinder", [PL_SHAPE_HULL] = "hull",
    [PL_SHAPE_MESH] = "mesh"};

const char *const pl_quantity_names[PL_QUANTITY_COUNT] = {
    [PL_QUANTITY_POSITION] = "position", [PL_QUANTITY_VELOCITY] = "velocity",
    [PL_QUANTITY_SPIN] = "spin",         [PL_QUANTITY_TURN] = "turn",
    [PL_QUANTITY_APEX] = "apex",         [PL_QUANTITY_PERIOD] = "period"};
