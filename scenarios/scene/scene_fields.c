#include "scene_fields.h"

#include "solids/polyhedron.h"

#include <float.h>
#include <math.h>

#define COUNT_OF(array) ((int)(sizeof(array) / sizeof(array)[0]))

/* A new one is also in scene.schema.json, which is made from the table of fields. */
static const char *const primary_errors[] = {"rest_position_error",
                                             "rest_rotation_error",
                                             "travel_error",
                                             "value_error",
                                             "discrete_error",
                                             "penetration_max",
                                             "penetration_rest",
                                             "drift",
                                             "creep",
                                             "energy_gain",
                                             "momentum_error",
                                             "statistics_error",
                                             "chaotic_error",
                                             "path_deviation",
                                             "lift",
                                             "settle_time",
                                             "energy_lost"};

const char *const *pl_primary_errors(int *count)
{
    *count = COUNT_OF(primary_errors);
    return primary_errors;
}

const char *const pl_shape_names[PL_SHAPE_KIND_COUNT] = {
    [PL_SHAPE_PLANE] = "plane",     [PL_SHAPE_SPHERE] = "sphere",     [PL_SHAPE_BOX] = "box",
    [PL_SHAPE_CAPSULE] = "capsule", [PL_SHAPE_CYLINDER] = "cylinder", [PL_SHAPE_HULL] = "hull",
    [PL_SHAPE_MESH] = "mesh"};

static const char *const quantity_names[PL_QUANTITY_COUNT] = {
    [PL_QUANTITY_POSITION] = "position",   [PL_QUANTITY_VELOCITY] = "velocity",
    [PL_QUANTITY_SPIN] = "spin",           [PL_QUANTITY_TURN] = "turn",
    [PL_QUANTITY_APEX] = "apex",           [PL_QUANTITY_PERIOD] = "period",
    [PL_QUANTITY_TOP_SPEED] = "top_speed", [PL_QUANTITY_EXCURSION] = "excursion",
    [PL_QUANTITY_ENERGY] = "energy"};

static const char *const bound_names[] = {
    [PL_BOUND_EQUAL] = "equal", [PL_BOUND_AT_MOST] = "at_most", [PL_BOUND_AT_LEAST] = "at_least"};

static const char *const statistic_names[PL_STATISTIC_COUNT] = {
    [PL_STATISTIC_MASS_HEIGHT] = "mass_height",
    [PL_STATISTIC_RUN_OUT_P95] = "run_out_p95",
    [PL_STATISTIC_SPREAD_X] = "spread_x",
    [PL_STATISTIC_SPREAD_Y] = "spread_y",
    [PL_STATISTIC_ENERGY_LOST] = "energy_lost"};

static const char *const frame_names[] = {[PL_FRAME_WORLD] = "world", [PL_FRAME_BODY] = "body"};

const pl_range_rule pl_range_rules[] = {
    [PL_RANGE_FINITE] = {"a finite number", "", -DBL_MAX, DBL_MAX, false},
    [PL_RANGE_POSITIVE] = {"a finite number above 0", ", \"exclusiveMinimum\": 0", 0, DBL_MAX,
                           true},
    [PL_RANGE_POSITIVE_OR_INFINITE] = {"a number above 0", ", \"exclusiveMinimum\": 0", 0,
                                       (double)INFINITY, true},
    [PL_RANGE_NOT_NEGATIVE] = {"a finite number of at least 0", ", \"minimum\": 0", 0, DBL_MAX,
                               false},
    [PL_RANGE_FRACTION] = {"a number from 0 to 1", ", \"minimum\": 0, \"maximum\": 1", 0, 1, false},
    [PL_RANGE_NOT_ZERO] = {"a finite number other than 0", ", \"not\": { \"const\": 0 }", -DBL_MAX,
                           DBL_MAX, false}};

bool pl_range_holds(pl_range range, double value)
{
    const pl_range_rule *rule = &pl_range_rules[range];
    return (rule->open ? value > rule->least : value >= rule->least) && value <= rule->most &&
           !(range == PL_RANGE_NOT_ZERO && value == 0);
}

/* ---- When a field has a meaning ---- */

static bool is_dynamic(const void *object)
{
    return !((const pl_body *)object)->is_static;
}

static bool is_placed(const void *object)
{
    return ((const pl_body *)object)->shape.kind != PL_SHAPE_PLANE;
}

static bool has_orientation(const void *object)
{
    return ((const pl_expect_rest *)object)->has_orientation;
}

static bool rest_has_tolerance(const void *object)
{
    return ((const pl_expect_rest *)object)->tolerance != 0;
}

static bool rest_has_orientation_tolerance(const void *object)
{
    return ((const pl_expect_rest *)object)->orientation_tolerance != 0;
}

static bool travel_has_tolerance(const void *object)
{
    return ((const pl_expect_travel *)object)->tolerance != 0;
}

static bool value_has_tolerance(const void *object)
{
    return ((const pl_expect_value *)object)->tolerance != 0;
}

static bool statistic_has_tolerance(const void *object)
{
    return ((const pl_expect_statistic *)object)->tolerance != 0;
}

static bool has_expectation(const void *object)
{
    const pl_scene *scene = object;
    return scene->rest_count > 0 || scene->travel_count > 0 || scene->value_count > 0 ||
           scene->statistic_count > 0 || scene->primary_error[0] != '\0' ||
           !isinf(scene->collapse_distance) || !isinf(scene->acceptance) || scene->same_bits;
}

static bool may_collapse(const void *object)
{
    const pl_scene *scene = object;
    return scene->rest_count > 0 || !isinf(scene->collapse_distance);
}

static bool is_judged(const void *object)
{
    return !isinf(((const pl_scene *)object)->acceptance);
}

/* ---- Fields ---- */

#define ALWAYS .need = PL_NEED_ALWAYS
#define DEFAULTED .need = PL_NEED_DEFAULT
#define OMITTED .need = PL_NEED_DEFAULT, .omit_default = true
#define POSITIVE .range = PL_RANGE_POSITIVE
#define ITEMS(kind, array, number)                                                                 \
    .items = (kind), .offset = offsetof(pl_scene, array), .count = offsetof(pl_scene, number)
#define WORDS(names) .words = (names), .word_count = COUNT_OF(names)

static const pl_field scene_fields[] = {
    {"plumb_scene", PL_FIELD_VERSION, .line = 1, ALWAYS,
     .about = "version of this format: 1, or 2 where there are parameters, or an expectation has a "
              "tolerance, a bound, a "
              "number, or a quantity without direction, or is same_bits; both are read alike"},
    {"name", PL_FIELD_NAME, offsetof(pl_scene, name), .line = 2, .omit_default = true,
     .about = "for reports"},
    {"parameters", PL_FIELD_PARAMETERS, .line = 3, .items = PL_OBJECT_PARAMETER,
     .most = PL_MAX_SCENE_PARAMETERS,
     .about = "by name; each is used, and is a number or an object"},
    {"gravity", PL_FIELD_VECTOR, offsetof(pl_scene, gravity), .line = 3, DEFAULTED,
     .unit = "m/s^2"},
    {"dt", PL_FIELD_NUMBER, offsetof(pl_scene, dt), .line = 4, DEFAULTED, POSITIVE, .unit = "s",
     .about = "time step"},
    {"duration", PL_FIELD_NUMBER, offsetof(pl_scene, duration), .line = 5, DEFAULTED, POSITIVE,
     .unit = "s", .about = "at least dt; the run has round(duration / dt) steps"},
    {"materials", PL_FIELD_NAMED_ITEMS, .line = 6,
     ITEMS(PL_OBJECT_MATERIAL, materials, material_count), .most = PL_MAX_MATERIALS,
     .about = "by name. A body that names none gets \"default\", which has friction 0.5 and "
              "restitution 0 unless it is given here"},
    {"pairs", PL_FIELD_ITEMS, .line = 7, ITEMS(PL_OBJECT_PAIR, pairs, pair_count),
     .about = "overrides of the mixing rule, which takes the geometric mean of the two frictions "
              "and the larger restitution"},
    {"shapes", PL_FIELD_SHAPES, .line = 8,
     .about = "by name, for bodies that share one. The name of a hull or a mesh is kept when the "
              "scene is written"},
    {"bodies", PL_FIELD_ITEMS, .line = 9, ALWAYS, ITEMS(PL_OBJECT_BODY, bodies, body_count),
     .least = 1, .most = PL_MAX_BODIES},
    {"expect", PL_FIELD_OBJECT, .line = 10, .items = PL_OBJECT_EXPECT, .applies = has_expectation},
};

static const pl_field material_fields[] = {
    {"friction", PL_FIELD_NUMBER, offsetof(pl_material, friction), ALWAYS,
     .range = PL_RANGE_NOT_NEGATIVE, .about = "Coulomb coefficient"},
    {"restitution", PL_FIELD_NUMBER, offsetof(pl_material, restitution), ALWAYS,
     .range = PL_RANGE_FRACTION, .about = "Newton coefficient"},
};

static const pl_field pair_fields[] = {
    {"a", PL_FIELD_MATERIAL, offsetof(pl_material_pair, material_a), ALWAYS},
    {"b", PL_FIELD_MATERIAL, offsetof(pl_material_pair, material_b), ALWAYS},
    {"friction", PL_FIELD_NUMBER, offsetof(pl_material_pair, friction), ALWAYS,
     .range = PL_RANGE_NOT_NEGATIVE, .about = "Coulomb coefficient"},
    {"restitution", PL_FIELD_NUMBER, offsetof(pl_material_pair, restitution), ALWAYS,
     .range = PL_RANGE_FRACTION, .about = "Newton coefficient"},
};

static const pl_field body_fields[] = {
    {"name", PL_FIELD_NAME, offsetof(pl_body, name), ALWAYS, .about = "unique in the scene"},
    {"static", PL_FIELD_BOOL, offsetof(pl_body, is_static), OMITTED,
     .about = "a plane is always static and need not say so"},
    {"mass", PL_FIELD_NUMBER, offsetof(pl_body, mass), POSITIVE, .applies = is_dynamic,
     .unit = "kg"},
    {"density", PL_FIELD_DENSITY, POSITIVE, .unit = "kg/m^3", .about = "in place of mass"},
    {"inertia", PL_FIELD_INERTIA, offsetof(pl_body, inertia), POSITIVE, .applies = is_dynamic,
     .unit = "kg m^2",
     .about = "principal, about the centre of mass, along the shape's axes (for a hull or a mesh "
              "along its principal axes); that of a uniform solid where it is not given"},
    {"material", PL_FIELD_MATERIAL, offsetof(pl_body, material),
     .about = "\"default\" where it is not given"},
    {"shape", PL_FIELD_SHAPE, offsetof(pl_body, shape), ALWAYS,
     .about = "a shape, or the name of one of the scene's shapes"},
    {"position", PL_FIELD_VECTOR, offsetof(pl_body, position), DEFAULTED, .line = 1,
     .applies = is_placed, .unit = "m", .about = "not of a plane"},
    {"orientation", PL_FIELD_QUATERNION, offsetof(pl_body, orientation), DEFAULTED, .line = 1,
     .applies = is_placed, .about = "not of a plane"},
    {"velocity", PL_FIELD_VECTOR, offsetof(pl_body, velocity), OMITTED, .line = 2, .unit = "m/s",
     .about = "of the centre of mass, world frame"},
    {"angular_velocity", PL_FIELD_VECTOR, offsetof(pl_body, angular_velocity), OMITTED, .line = 2,
     .unit = "rad/s", .about = "world frame"},
    {"forces", PL_FIELD_FORCES, .line = 3, .items = PL_OBJECT_FORCE},
};

static const pl_field plane_fields[] = {
    {"type", PL_FIELD_TYPE, ALWAYS},
    {"normal", PL_FIELD_UNIT, offsetof(pl_shape, normal), ALWAYS, .about = "out of the solid"},
    {"offset", PL_FIELD_NUMBER, offsetof(pl_shape, offset), ALWAYS, .unit = "m",
     .about = "along the normal"},
};

static const pl_field sphere_fields[] = {
    {"type", PL_FIELD_TYPE, ALWAYS},
    {"radius", PL_FIELD_NUMBER, offsetof(pl_shape, radius), ALWAYS, POSITIVE, .unit = "m"},
};

static const pl_field box_fields[] = {
    {"type", PL_FIELD_TYPE, ALWAYS},
    {"half_extents", PL_FIELD_VECTOR, offsetof(pl_shape, half_extents), ALWAYS, POSITIVE,
     .unit = "m"},
};

/* Of a capsule and of a cylinder. */
static const pl_field round_fields[] = {
    {"type", PL_FIELD_TYPE, ALWAYS},
    {"radius", PL_FIELD_NUMBER, offsetof(pl_shape, radius), ALWAYS, POSITIVE, .unit = "m"},
    {"half_height", PL_FIELD_NUMBER, offsetof(pl_shape, half_height), ALWAYS, POSITIVE,
     .unit = "m"},
};

static const pl_field hull_fields[] = {
    {"type", PL_FIELD_TYPE, ALWAYS},
    {"points", PL_FIELD_POINTS, ALWAYS, .least = 4, .most = PL_MAX_HULL_POINTS, .unit = "m"},
};

static const pl_field mesh_fields[] = {
    {"type", PL_FIELD_TYPE, ALWAYS},
    {"file", PL_FIELD_FILE, .unit = "m",
     .about = "a Wavefront .obj file; a relative path begins at the scene file's folder, or at the "
              "working directory when the scene comes from standard input"},
    {"vertices", PL_FIELD_POINTS, .least = 4, .most = PL_MAX_VERTICES, .unit = "m"},
    {"triangles", PL_FIELD_TRIANGLES, .least = 4, .most = PL_MAX_TRIANGLES,
     .about = "three vertices each, by their number from 0; each edge is of two triangles"},
};

static const pl_field force_fields[] = {
    {"force", PL_FIELD_VECTOR, offsetof(pl_force, force), ALWAYS, .unit = "N"},
    {"at", PL_FIELD_VECTOR, offsetof(pl_force, at), OMITTED, .unit = "m",
     .about = "from the centre of mass"},
    {"frame", PL_FIELD_WORD, offsetof(pl_force, frame), OMITTED, WORDS(frame_names),
     .about = "axes of force and at; those of the body turn with it"},
    {"from", PL_FIELD_NUMBER, offsetof(pl_force, from), OMITTED, .range = PL_RANGE_NOT_NEGATIVE,
     .unit = "s"},
    {"until", PL_FIELD_NUMBER, offsetof(pl_force, until), .omit_default = true,
     .range = PL_RANGE_POSITIVE_OR_INFINITE, .unit = "s",
     .about = "after from; without it the force never ends"},
};

static const pl_field expect_fields[] = {
    {"rest", PL_FIELD_ITEMS, .line = 1, ITEMS(PL_OBJECT_REST, rests, rest_count)},
    {"travel", PL_FIELD_ITEMS, .line = 2, ITEMS(PL_OBJECT_TRAVEL, travels, travel_count)},
    {"values", PL_FIELD_ITEMS, .line = 3, ITEMS(PL_OBJECT_VALUE, values, value_count)},
    {"statistics", PL_FIELD_ITEMS, .line = 3,
     ITEMS(PL_OBJECT_STATISTIC, statistics, statistic_count)},
    {"same_bits", PL_FIELD_BOOL, offsetof(pl_scene, same_bits), .line = 4, OMITTED,
     .about = "whether a second run in the same process is to have the same states, bit for bit"},
    {"primary", PL_FIELD_METRIC, offsetof(pl_scene, primary_error), .line = 4,
     WORDS(primary_errors),
     .about = "the metric that reference_error copies; travel_error where there is a travel, "
              "value_error where there is a value, rest_position_error where there is a rest, else "
              "statistics_error where there is a statistic, else none"},
    {"collapse_distance", PL_FIELD_NUMBER, offsetof(pl_scene, collapse_distance), .line = 5,
     .range = PL_RANGE_POSITIVE_OR_INFINITE, .nullable = true, .applies = may_collapse, .unit = "m",
     .about = "a body of rest that ends farther away has collapsed. Half the smallest dimension of "
              "these bodies where it is not given; null: never"},
    {"acceptance", PL_FIELD_NUMBER, offsetof(pl_scene, acceptance), .line = 5,
     .range = PL_RANGE_POSITIVE_OR_INFINITE, .nullable = true, .applies = is_judged,
     .about =
         "the largest primary error of an accurate run, in the unit of the primary metric, and "
         "the tolerance of each expectation that states none; without acceptance and "
         "tolerances no run is called accurate"},
};

static const pl_field rest_fields[] = {
    {"body", PL_FIELD_BODY, offsetof(pl_expect_rest, body), ALWAYS},
    {"position", PL_FIELD_VECTOR, offsetof(pl_expect_rest, position), ALWAYS, .unit = "m"},
    {"orientation", PL_FIELD_QUATERNION, offsetof(pl_expect_rest, orientation),
     .applies = has_orientation, .about = "not judged where it is not given"},
    {"tolerance", PL_FIELD_NUMBER, offsetof(pl_expect_rest, tolerance), POSITIVE,
     .applies = rest_has_tolerance, .unit = "m", .about = "without it the scene's acceptance"},
    {"orientation_tolerance", PL_FIELD_NUMBER, offsetof(pl_expect_rest, orientation_tolerance),
     POSITIVE, .applies = rest_has_orientation_tolerance, .unit = "rad",
     .about = "without it the scene's acceptance"},
};

static const pl_field travel_fields[] = {
    {"body", PL_FIELD_BODY, offsetof(pl_expect_travel, body), ALWAYS},
    {"direction", PL_FIELD_UNIT, offsetof(pl_expect_travel, direction), ALWAYS,
     .about = "world frame"},
    {"distance", PL_FIELD_NUMBER, offsetof(pl_expect_travel, distance), ALWAYS,
     .range = PL_RANGE_NOT_ZERO, .unit = "m", .about = "of the continuous problem"},
    {"discrete", PL_FIELD_NUMBER, offsetof(pl_expect_travel, discrete), .omit_default = true,
     .range = PL_RANGE_NOT_ZERO, .unit = "m",
     .about = "the exact answer of semi-implicit Euler at this dt"},
    {"tolerance", PL_FIELD_NUMBER, offsetof(pl_expect_travel, tolerance), POSITIVE,
     .applies = travel_has_tolerance, .unit = "m",
     .about = "without it the scene's acceptance, as a fraction of the distance"},
};

static const pl_field value_fields[] = {
    {"body", PL_FIELD_BODY, offsetof(pl_expect_value, body), ALWAYS},
    {"quantity", PL_FIELD_WORD, offsetof(pl_expect_value, quantity), ALWAYS, WORDS(quantity_names),
     .about = "along the direction: position (m, from the start), velocity (m/s), spin (rad/s), "
              "turn (rad, whole turns too) at `until`; apex (m, from the start) and period (s, of "
              "the spin in the body's own axes) in from .. until. Without a direction: top_speed "
              "(m/s) and excursion (m, the largest distance from the start) in from .. until, and "
              "energy (J, kinetic and potential, against the potential energy of the start) at "
              "`until`"},
    {"direction", PL_FIELD_UNIT, offsetof(pl_expect_value, direction), DEFAULTED,
     .about = "world frame; of a period in the axes of the shape's frame"},
    {"from", PL_FIELD_NUMBER, offsetof(pl_expect_value, from), DEFAULTED,
     .range = PL_RANGE_NOT_NEGATIVE, .unit = "s"},
    {"until", PL_FIELD_NUMBER, offsetof(pl_expect_value, until), POSITIVE, .unit = "s",
     .about = "within the run; its end where it is not given"},
    {"value", PL_FIELD_NUMBER, offsetof(pl_expect_value, value), ALWAYS,
     .about = "of the continuous problem"},
    {"discrete", PL_FIELD_NUMBER, offsetof(pl_expect_value, discrete), .omit_default = true,
     .about = "the exact answer of semi-implicit Euler at this dt"},
    {"scale", PL_FIELD_NUMBER, offsetof(pl_expect_value, scale), DEFAULTED, POSITIVE,
     .about = "what the error is divided by"},
    {"tolerance", PL_FIELD_NUMBER, offsetof(pl_expect_value, tolerance), POSITIVE,
     .applies = value_has_tolerance,
     .about = "in the quantity's unit; without it the scene's acceptance, times the scale"},
    {"bound", PL_FIELD_WORD, offsetof(pl_expect_value, bound), OMITTED, WORDS(bound_names),
     .about = "at_most and at_least: what is found may be less, or more, than the value"},
    {"number", PL_FIELD_NUMBER, offsetof(pl_expect_value, number), OMITTED,
     .range = PL_RANGE_NOT_NEGATIVE,
     .about = "of an apex: which one in from .. until, counted from 1; 0: the highest"},
    {"answer", PL_FIELD_NUMBER, offsetof(pl_expect_value, answer), OMITTED,
     .range = PL_RANGE_NOT_NEGATIVE,
     .about =
         "of a scene with several right answers, the number, 1 to 8, of the one that the value "
         "belongs to: the error is that from the nearest answer. 0: it belongs to all"},
};

static const pl_field statistic_fields[] = {
    {"metric", PL_FIELD_WORD, offsetof(pl_expect_statistic, metric), ALWAYS, WORDS(statistic_names),
     .about = "of the state at the end of the run"},
    {"low", PL_FIELD_NUMBER, offsetof(pl_expect_statistic, low), ALWAYS,
     .about = "5 % quantile of right runs"},
    {"high", PL_FIELD_NUMBER, offsetof(pl_expect_statistic, high), ALWAYS,
     .about = "95 % quantile of right runs, at least low"},
    {"scale", PL_FIELD_NUMBER, offsetof(pl_expect_statistic, scale), ALWAYS, POSITIVE,
     .about = "what the distance from low .. high is divided by"},
    {"tolerance", PL_FIELD_NUMBER, offsetof(pl_expect_statistic, tolerance), POSITIVE,
     .applies = statistic_has_tolerance,
     .about = "in the metric's unit; without it the scene's acceptance, times the scale"},
};

static const pl_field parameter_fields[] = {
    {"value", PL_FIELD_NUMBER, offsetof(pl_scene_parameter, value), ALWAYS, .about = "the default"},
    {"low", PL_FIELD_NUMBER, offsetof(pl_scene_parameter, low),
     .about = "the least value allowed; without it there is none"},
    {"high", PL_FIELD_NUMBER, offsetof(pl_scene_parameter, high),
     .about = "the largest value allowed, above low; without it there is none"},
    {"unit", PL_FIELD_NAME, offsetof(pl_scene_parameter, unit),
     .about = "\"1\" if it is not given"},
    {"description", PL_FIELD_TEXT, offsetof(pl_scene_parameter, description),
     .about = "a line for people"},
};

/* ---- Objects ---- */

static const pl_scene_parameter parameter_defaults = {
    .low = -(double)INFINITY, .high = (double)INFINITY, .unit = "1"};
static const pl_scene scene_defaults = {.gravity = {0, 0, -9.81},
                                        .dt = 1.0 / 60,
                                        .duration = 5,
                                        .collapse_distance = (double)INFINITY,
                                        .acceptance = (double)INFINITY};
static const pl_material no_material = {.friction = 0};
static const pl_material_pair no_pair = {.friction = 0};
static const pl_body body_defaults = {.mass = 1, .orientation = {1, 0, 0, 0}};
static const pl_shape no_shape = {.radius = 0};
static const pl_force force_defaults = {.until = (double)INFINITY};
static const pl_expect_rest rest_defaults = {.orientation = {1, 0, 0, 0}};
static const pl_expect_travel travel_defaults = {.discrete = (double)NAN};
static const pl_expect_value value_defaults = {
    .direction = {0, 0, 1}, .discrete = (double)NAN, .scale = 1};
static const pl_expect_statistic no_statistic = {.scale = 1};

#define OF(array, struct_defaults)                                                                 \
    .fields = (array), .field_count = COUNT_OF(array), .size = sizeof(struct_defaults),            \
    .defaults = &(struct_defaults)

const pl_object pl_objects[PL_OBJECT_COUNT] = {
    [PL_OBJECT_SCENE] = {"scene", OF(scene_fields, scene_defaults),
                         .about = "A scene of rigid bodies and what is expected of it. SI units, "
                                  "right-handed, z up by custom. The reader checks more than a "
                                  "schema can: that names are unique and known, vectors and "
                                  "quaternions of unit length (to 1e-6 in a file, then "
                                  "normalised), inertias physical, and duration / dt at most 10 "
                                  "million steps."},
    [PL_OBJECT_MATERIAL] = {"material", OF(material_fields, no_material),
                            .about = "against itself"},
    [PL_OBJECT_PAIR] = {"pair", OF(pair_fields, no_pair), .about = "two materials"},
    [PL_OBJECT_BODY] = {"body", OF(body_fields, body_defaults),
                        .about = "position and orientation place the shape's own frame, for a hull "
                                 "or a mesh that of its vertices. A static body never moves: it "
                                 "has no mass, density, inertia, velocity or forces. Any other "
                                 "body has either mass or density."},
    [PL_OBJECT_PLANE] = {"plane", OF(plane_fields, no_shape),
                         .about = "the solid half-space {x : normal.x <= offset}"},
    [PL_OBJECT_SPHERE] = {"sphere", OF(sphere_fields, no_shape), .about = "about the origin"},
    [PL_OBJECT_BOX] = {"box", OF(box_fields, no_shape), .about = "about the origin"},
    [PL_OBJECT_CAPSULE] = {"capsule", OF(round_fields, no_shape),
                           .about = "all points within radius of the segment from -half_height to "
                                    "half_height on the z axis"},
    [PL_OBJECT_CYLINDER] = {"cylinder", OF(round_fields, no_shape),
                            .about = "about the z axis, from -half_height to half_height"},
    [PL_OBJECT_HULL] = {"hull", OF(hull_fields, no_shape),
                        .about = "the convex hull of points that do not lie in one plane; those "
                                 "inside, on an edge or on a face are ignored"},
    [PL_OBJECT_MESH] = {"mesh", OF(mesh_fields, no_shape),
                        .about = "the solid within closed surfaces that do not cross themselves or "
                                 "each other, given by file or by vertices and triangles. Each "
                                 "surface is turned outward, a cavity's inward, however it is "
                                 "wound",
                        .schema = "\"oneOf\": [{ \"required\": [\"file\"] }, { \"required\": "
                                  "[\"vertices\", \"triangles\"] }]"},
    [PL_OBJECT_FORCE] = {"force", OF(force_fields, force_defaults),
                         .about = "constant over from <= t < until"},
    [PL_OBJECT_EXPECT] = {"expect", OF(expect_fields, scene_defaults),
                          .about = "the right answer, at the end of the run"},
    [PL_OBJECT_REST] = {"rest", OF(rest_fields, rest_defaults),
                        .about = "the final pose of a body"},
    [PL_OBJECT_TRAVEL] = {"travel", OF(travel_fields, travel_defaults),
                          .about = "how far a body moves along one line"},
    [PL_OBJECT_VALUE] = {"value", OF(value_fields, value_defaults),
                         .about = "a number that is read from the path of one body"},
    [PL_OBJECT_STATISTIC] = {"statistic", OF(statistic_fields, no_statistic),
                             .about = "where a number of the final state lies in nine of ten right "
                                      "runs of a chaotic scene"},
    [PL_OBJECT_PARAMETER] = {"parameter", OF(parameter_fields, parameter_defaults),
                             .about = "a number that other fields name. --set NAME=VALUE overrides "
                                      "its value"}};
