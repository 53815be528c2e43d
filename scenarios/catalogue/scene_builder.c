#include "scene_builder.h"

#include "base/trigonometry.h"
#include "converged.h"
#include "scene_family.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const double pl_axis_x[3] = {1, 0, 0}, pl_axis_y[3] = {0, 1, 0}, pl_axis_z[3] = {0, 0, 1};

/* ---- Scenes ---- */

/* The value of the parameter of that name; 0 where the scenario has none. */
static double value_of(const pl_scenario *scenario, const double *values, const char *name)
{
    const int index = pl_scenario_param(scenario, name);
    return index >= 0 ? values[index] : 0;
}

pl_status pl_scenario_build(const pl_scenario *scenario, const double *values, uint64_t seed,
                            pl_scene *scene, pl_error *error)
{
    if (scenario->file != NULL) {
        return pl_scene_family_build(scenario, values, scene, error);
    }
    const pl_material material = {.name = "block",
                                  .friction = value_of(scenario, values, "friction"),
                                  .restitution = value_of(scenario, values, "restitution")};
    *scene = pl_scene_default();
    snprintf(scene->name, sizeof scene->name, "%s", scenario->name);
    snprintf(scene->primary_error, sizeof scene->primary_error, "%s", scenario->primary_error);
    scene->acceptance = scenario->acceptance;
    scene->dt = value_of(scenario, values, "dt");
    scene->duration = value_of(scenario, values, "duration");
    pl_builder builder = {.scene = scene, .random = {.state = seed}, .error = error};
    builder.gravity = -scene->gravity[2];
    builder.steps = (double)pl_scene_steps(scene);
    builder.end = builder.steps * scene->dt;
    builder.status = pl_scene_add_material(scene, &material, NULL, error);
    if (builder.status == PL_OK) {
        scenario->build(&builder, values);
    }
    pl_build_statistics(&builder, scenario, values, seed);
    if (builder.status == PL_OK) {
        builder.status = pl_scene_validate(scene, error);
    }
    if (builder.status != PL_OK) {
        pl_scene_free(scene);
    }
    return builder.status;
}

uint32_t pl_scenario_needs(const pl_scenario *scenario)
{
    double values[PL_MAX_PARAMS];
    pl_scene scene;
    uint32_t needs = 0;
    for (int i = 0; i < scenario->param_count; ++i) {
        values[i] = scenario->params[i].value;
    }
    if (pl_scenario_build(scenario, values, 0, &scene, NULL) == PL_OK) {
        needs = pl_scene_needs(&scene);
        pl_scene_free(&scene);
    }
    return needs;
}

void pl_build_refuse(pl_builder *builder, const char *format, ...)
{
    char message[sizeof builder->error->message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    builder->status =
        pl_fail(builder->error, PL_BAD_INPUT, "%s: %s", builder->scene->name, message);
}

/* ---- Materials and bodies ---- */

static bool ready(const pl_builder *builder)
{
    return builder->status == PL_OK;
}

int pl_build_material(pl_builder *builder, const char *name, double friction, double restitution)
{
    pl_material material = {.friction = friction, .restitution = restitution};
    int index = 0;
    snprintf(material.name, sizeof material.name, "%s", name);
    if (ready(builder)) {
        builder->status = pl_scene_add_material(builder->scene, &material, &index, builder->error);
    }
    return index;
}

void pl_build_pair(pl_builder *builder, int material_a, int material_b, double friction)
{
    const pl_material_pair pair = {
        .material_a = material_a, .material_b = material_b, .friction = friction};
    if (ready(builder)) {
        builder->status = pl_scene_add_pair(builder->scene, &pair, builder->error);
    }
}

pl_body pl_body_at(pl_shape shape, double x, double y, double z)
{
    pl_body body = pl_body_default();
    body.shape = shape;
    body.position[0] = x;
    body.position[1] = y;
    body.position[2] = z;
    return body;
}

void pl_turn_about_axis(pl_body *body, int axis, double angle)
{
    body->orientation[0] = pl_cosine(angle / 2);
    body->orientation[1 + axis] = pl_sine(angle / 2);
}

void pl_turn_about_y(pl_body *body, double angle)
{
    pl_turn_about_axis(body, 1, angle);
}

void pl_build_plane(pl_builder *builder, const char *name, int material, double nx, double ny,
                    double nz, double offset)
{
    pl_body plane = pl_body_at(pl_shape_plane(nx, ny, nz, offset), 0, 0, 0);
    plane.is_static = true;
    plane.material = material;
    pl_build_body(builder, &plane, "%s", name);
}

void pl_build_floor(pl_builder *builder)
{
    pl_build_plane(builder, "floor", 0, 0, 0, 1, 0);
}

int pl_build_body(pl_builder *builder, const pl_body *body, const char *name, ...)
{
    pl_body named = *body;
    int index = -1;
    va_list arguments;
    va_start(arguments, name);
    vsnprintf(named.name, sizeof named.name, name, arguments);
    va_end(arguments);
    if (ready(builder)) {
        builder->status = pl_scene_add_body(builder->scene, &named, &index, builder->error);
    }
    return index;
}

pl_shape pl_build_hull(pl_builder *builder, const char *name, const double (*points)[3], int count)
{
    const pl_polyhedron *hull = NULL;
    if (ready(builder)) {
        builder->status =
            pl_scene_add_hull(builder->scene, name, points, count, &hull, builder->error);
    }
    return hull != NULL ? pl_shape_of(hull) : (pl_shape){.kind = PL_SHAPE_HULL};
}

void pl_build_force(pl_builder *builder, const pl_force *force)
{
    if (ready(builder)) {
        builder->status = pl_scene_add_force(builder->scene, force, builder->error);
    }
}

/* ---- Random numbers ---- */

double pl_draw_uniform(pl_random *random, double low, double high)
{
    return low + (high - low) * pl_random_unit(random);
}

void pl_draw_orientation(pl_random *random, double q[4])
{
    double square;
    do {
        square = 0;
        for (int k = 0; k < 4; ++k) {
            q[k] = pl_draw_uniform(random, -1, 1);
            square += q[k] * q[k];
        }
    } while (square > 1 || square < 0.01);
    double length = sqrt(square);
    for (int k = 0; k < 4; ++k) {
        q[k] /= length;
    }
}

/* ---- Answers ---- */

pl_answer pl_uniform_distance(double v, double a, double h, double steps)
{
    double t = steps * h;
    return (pl_answer){v * t + a * t * t / 2, v * t + a * h * h * steps * (steps + 1) / 2};
}

pl_answer pl_braking_distance(double v, double braking, double h, double steps)
{
    double t = fmin(steps * h, v / braking);
    double moving = fmin(steps, floor(v / (braking * h)));
    double discrete = pl_uniform_distance(v, -braking, h, moving).discrete;
    return (pl_answer){v * t - braking * t * t / 2, discrete > 0 ? discrete : (double)NAN};
}

pl_answer pl_exactly(double value)
{
    return (pl_answer){value, value};
}

pl_answer pl_continuous(double value)
{
    return (pl_answer){value, (double)NAN};
}

/* ---- Expectations ---- */

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

void pl_build_start_off(pl_builder *builder, int body, int axis, double distance)
{
    if (ready(builder)) {
        builder->scene->bodies[body].position[axis] += distance;
    }
}

void pl_build_travel(pl_builder *builder, int body, const double direction[3], pl_answer distance)
{
    pl_expect_travel travel = {
        .body = body, .distance = distance.continuous, .discrete = distance.discrete};
    memcpy(travel.direction, direction, sizeof travel.direction);
    if (ready(builder)) {
        builder->status = pl_scene_add_travel(builder->scene, &travel, builder->error);
    }
}

void pl_build_value(pl_builder *builder, const pl_expect_value *value)
{
    if (ready(builder)) {
        builder->status = pl_scene_add_value(builder->scene, value, builder->error);
    }
}

void pl_build_at_end(pl_builder *builder, int body, pl_quantity quantity, const double direction[3],
                     pl_answer answer, double scale)
{
    pl_expect_value value = pl_expect_value_default(builder->scene);
    value.body = body;
    value.quantity = quantity;
    memcpy(value.direction, direction, sizeof value.direction);
    value.value = answer.continuous;
    value.discrete = answer.discrete;
    value.scale = scale;
    pl_build_value(builder, &value);
}

/* Two unit vectors at right angles to `d` and to each other. */
static void across(const double d[3], double a[3], double b[3])
{
    const double level = sqrt(d[0] * d[0] + d[1] * d[1]);
    a[0] = level > 0 ? -d[1] / level : 1;
    a[1] = level > 0 ? d[0] / level : 0;
    a[2] = 0;
    for (int k = 0; k < 3; ++k) {
        b[k] = d[(k + 1) % 3] * a[(k + 2) % 3] - d[(k + 2) % 3] * a[(k + 1) % 3];
    }
}

void pl_build_displaced(pl_builder *builder, int body, const double direction[3], pl_answer answer,
                        double scale)
{
    double side[2][3];
    across(direction, side[0], side[1]);
    pl_build_at_end(builder, body, PL_QUANTITY_POSITION, direction, answer, scale);
    for (int i = 0; i < 2; ++i) {
        pl_build_at_end(builder, body, PL_QUANTITY_POSITION, side[i], pl_exactly(0), scale);
    }
}

void pl_build_none(pl_builder *builder, int body, pl_quantity quantity, unsigned axes, double scale)
{
    const double *const axis[] = {pl_axis_x, pl_axis_y, pl_axis_z};
    for (int k = 0; k < 3; ++k) {
        if ((axes >> k & 1) != 0) {
            pl_build_at_end(builder, body, quantity, axis[k], pl_exactly(0), scale);
        }
    }
}

pl_expect_value pl_value_within(const pl_builder *builder, int body, pl_quantity quantity,
                                const double direction[3], double value, double tolerance)
{
    pl_expect_value expected = pl_expect_value_default(builder->scene);
    expected.body = body;
    expected.quantity = quantity;
    memcpy(expected.direction, direction, sizeof expected.direction);
    expected.value = value;
    expected.tolerance = tolerance;
    expected.scale = tolerance / builder->scene->acceptance;
    return expected;
}

void pl_build_within(pl_builder *builder, int body, pl_quantity quantity, const double direction[3],
                     double value, double tolerance)
{
    const pl_expect_value expected =
        pl_value_within(builder, body, quantity, direction, value, tolerance);
    pl_build_value(builder, &expected);
}

void pl_build_none_within(pl_builder *builder, int body, pl_quantity quantity, unsigned axes,
                          double tolerance)
{
    const double *const axis[] = {pl_axis_x, pl_axis_y, pl_axis_z};
    for (int k = 0; k < 3; ++k) {
        if ((axes >> k & 1) != 0) {
            pl_build_within(builder, body, quantity, axis[k], 0, tolerance);
        }
    }
}

void pl_build_rest_within(pl_builder *builder, int body, double size)
{
    pl_build_rest(builder, body);
    if (ready(builder)) {
        pl_expect_rest *rest = &builder->scene->rests[builder->scene->rest_count - 1];
        rest->tolerance = 0.01 * size;
        rest->orientation_tolerance = 0.01;
    }
}

void pl_build_straight(pl_builder *builder, int body, const pl_straight *path)
{
    const double *const n = path->up, *const d = path->along;
    const double visible = 0.01 * path->size, sunk = 0.06 * path->size, turn = 0.06;
    double side[3];
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        side[k] = n[i] * d[j] - n[j] * d[i];
    }
    pl_expect_value values[] = {
        pl_value_within(builder, body, PL_QUANTITY_POSITION, d, path->distance,
                        fmax(0.06 * fabs(path->distance), visible)),
        pl_value_within(builder, body, PL_QUANTITY_POSITION, side, 0, visible),
        pl_value_within(builder, body, PL_QUANTITY_APEX, n, 0, visible),
        pl_value_within(builder, body, PL_QUANTITY_POSITION, n, 0, sunk),
        pl_value_within(builder, body, PL_QUANTITY_TURN, pl_axis_x, 0, turn),
        pl_value_within(builder, body, PL_QUANTITY_TURN, pl_axis_y, 0, turn),
        pl_value_within(builder, body, PL_QUANTITY_TURN, pl_axis_z, 0, turn),
    };
    values[2].bound = PL_BOUND_AT_MOST;
    for (size_t i = 0; i < sizeof values / sizeof *values; ++i) {
        values[i].until = path->until;
        pl_build_value(builder, &values[i]);
    }
}

void pl_build_same_bits(pl_builder *builder)
{
    if (ready(builder)) {
        builder->scene->same_bits = true;
    }
}

void pl_build_statistic(pl_builder *builder, pl_statistic metric, double value, double scale)
{
    const pl_expect_statistic statistic = {
        .metric = metric, .low = value, .high = value, .scale = scale};
    if (ready(builder)) {
        builder->status = pl_scene_add_statistic(builder->scene, &statistic, builder->error);
    }
}
