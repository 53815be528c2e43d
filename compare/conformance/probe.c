#include "probe.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Mistakes that give a known number ---- */

/* Ratios and guesses are recognised to this relative difference: far below the difference between
 * two mistakes, and above the errors of an integrator. */
static const double RECOGNISED = 2e-3;

const char *pl_guess_cause(pl_vec found, const pl_guess *guesses, int count, const char *otherwise)
{
    for (int i = 0; i < count; ++i) {
        const pl_vec value = guesses[i].value;
        if (pl_vec_length(pl_vec_sub(found, value)) <= RECOGNISED * pl_vec_length(value)) {
            return guesses[i].cause;
        }
    }
    return otherwise;
}

static const char *ratio_name(double ratio)
{
    static const struct {
        double ratio;
        const char *name;
    } known[] = {
        {57.295779513, ": degrees in place of radians"},
        {0.01745329252, ": radians taken for degrees"},
        {-1, ": the opposite sign"},
        {2, ": double"},
        {0.5, ": half"},
        {-2, ": double, with the opposite sign"},
        {-0.5, ": half, with the opposite sign"},
        {100, ": centimetres in place of metres"},
        {0.01, ": metres taken for centimetres"},
        {1000, ": a thousand"},
        {0.001, ": a thousandth"},
        {9.81, ": multiplied by gravity"},
        {1 / 9.81, ": divided by gravity"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i) {
        if (fabs(ratio - known[i].ratio) <= RECOGNISED * fabs(known[i].ratio)) {
            return known[i].name;
        }
    }
    return "";
}

void pl_describe_ratio(pl_vec found, pl_vec expected, char *text, size_t size)
{
    const double length = pl_vec_length(expected);
    text[0] = '\0';
    if (!(length > 0)) {
        return;
    }
    const double ratio = pl_vec_dot(found, expected) / (length * length);
    const double off = pl_vec_length(pl_vec_mad(found, -ratio, expected));
    if (pl_vec_length(found) <= RECOGNISED * length) {
        snprintf(text, size, ", which is nothing");
    } else if (off <= RECOGNISED * fabs(ratio) * length) {
        snprintf(text, size, ", which is %.5g times what was expected%s", ratio, ratio_name(ratio));
    }
}

/* ---- Expectations ---- */

static void end(pl_probe *probe, pl_check_outcome outcome, const char *expected, const char *found,
                const char *cause)
{
    pl_check_result *result = probe->result;
    if (probe->over) {
        return;
    }
    probe->over = true;
    result->outcome = outcome;
    snprintf(result->expected, sizeof result->expected, "%s", expected);
    snprintf(result->found, sizeof result->found, "%s", found);
    snprintf(result->cause, sizeof result->cause, "%s", cause);
}

void pl_probe_fail(pl_probe *probe, const char *expected, const char *found, const char *cause)
{
    end(probe, PL_CHECK_FAILED, expected, found, cause);
}

void pl_probe_skip(pl_probe *probe, const char *why)
{
    end(probe, PL_CHECK_SKIPPED, "", why, "");
}

const char *pl_probe_text(pl_probe *probe, const char *format, ...)
{
    const int count = (int)(sizeof probe->texts / sizeof *probe->texts);
    char *text = probe->texts[probe->text_count++ % count];
    va_list values;
    va_start(values, format);
    vsnprintf(text, PL_CHECK_TEXT_SIZE, format, values);
    va_end(values);
    return text;
}

bool pl_probe_require(pl_probe *probe, bool condition, const char *expected, const char *found,
                      const char *cause)
{
    if (!condition) {
        pl_probe_fail(probe, expected, found, cause);
    }
    return !probe->over;
}

double pl_probe_tolerance(const pl_probe *probe, double scale)
{
    const bool single = probe->choice->engine->precision == PL_PRECISION_FLOAT;
    return scale * (single ? 2e-5 : 1e-10);
}

bool pl_probe_expect(pl_probe *probe, const char *what, double found, double expected,
                     double tolerance, const char *cause)
{
    char ratio[100];
    pl_describe_ratio((pl_vec){found, 0, 0}, (pl_vec){expected, 0, 0}, ratio, sizeof ratio);
    return pl_probe_require(
        probe, fabs(found - expected) <= tolerance,
        pl_probe_text(probe, "%s: %.10g, to %.2g", what, expected, tolerance),
        pl_probe_text(probe, "%.10g%s", isnan(found) ? fabs(found) : found, ratio), cause);
}

bool pl_probe_expect_vector(pl_probe *probe, const char *what, pl_vec found, pl_vec expected,
                            double tolerance, const char *cause)
{
    char ratio[100];
    const pl_vec off = pl_vec_sub(found, expected);
    const bool equal =
        fabs(off.x) <= tolerance && fabs(off.y) <= tolerance && fabs(off.z) <= tolerance;
    pl_describe_ratio(found, expected, ratio, sizeof ratio);
    return pl_probe_require(
        probe, equal,
        pl_probe_text(probe, "%s: (%.8g, %.8g, %.8g), to %.2g", what, expected.x, expected.y,
                      expected.z, tolerance),
        pl_probe_text(probe, "(%.8g, %.8g, %.8g)%s", found.x, found.y, found.z, ratio), cause);
}

bool pl_probe_expect_bodies(pl_probe *probe, const pl_contact *contact)
{
    const int count = probe->scene.body_count, a = contact->body_a, b = contact->body_b;
    const char *found = pl_probe_text(probe, "a contact of bodies %d and %d", a, b);
    pl_probe_require(probe, a >= 0 && a < count && b >= 0 && b < count,
                     "the bodies of a contact are indices of the scene", found,
                     "body_a or body_b is not set, is the engine's own number, or is -1 for what "
                     "does not move");
    return pl_probe_require(probe, a != b, "a contact is of two bodies", found,
                            "both are read from the same side of the engine's contact");
}

/* ---- Scenes ---- */

bool pl_probe_expect_made(pl_probe *probe, pl_status status, const pl_error *error)
{
    return pl_probe_require(probe, status == PL_OK, "the check's scene can be made", error->message,
                            "");
}

pl_scene *pl_probe_scene(pl_probe *probe, double dt)
{
    pl_session_destroy(&probe->session);
    pl_scene_free(&probe->scene);
    probe->scene = pl_scene_default();
    probe->scene.dt = dt;
    probe->scene.duration = 10;
    const uint32_t needed = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION;
    const bool has_friction = (~probe->choice->engine->capabilities & needed) == 0;
    pl_probe_add_material(probe, has_friction ? 0.5 : 0, 0);
    return &probe->scene;
}

pl_scene *pl_probe_floating(pl_probe *probe, double dt)
{
    pl_scene *scene = pl_probe_scene(probe, dt);
    memset(scene->gravity, 0, sizeof scene->gravity);
    return scene;
}

int pl_probe_add_material(pl_probe *probe, double friction, double restitution)
{
    pl_error error = {.message = ""};
    pl_material material = {.friction = friction, .restitution = restitution};
    int index = 0;
    snprintf(material.name, sizeof material.name, "material %d", probe->scene.material_count);
    pl_probe_expect_made(probe, pl_scene_add_material(&probe->scene, &material, &index, &error),
                         &error);
    return index;
}

int pl_probe_add_body(pl_probe *probe, pl_body body)
{
    pl_error error = {.message = ""};
    int index = 0;
    const double *q = body.orientation;
    body.mass = body.mass == 0 ? 1 : body.mass;
    if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0) {
        body.orientation[0] = 1;
    }
    snprintf(body.name, sizeof body.name, "body %d", probe->scene.body_count);
    if (probe->scene.body_count == PL_PROBE_MOST_BODIES) {
        pl_fail(&error, PL_NO_MEMORY, "too many bodies");
        pl_probe_expect_made(probe, PL_NO_MEMORY, &error);
        return 0;
    }
    pl_probe_expect_made(probe, pl_scene_add_body(&probe->scene, &body, &index, &error), &error);
    return index;
}

int pl_probe_add_floor(pl_probe *probe)
{
    return pl_probe_add_body(probe,
                             (pl_body){.is_static = true, .shape = pl_shape_plane(0, 0, 1, 0)});
}

int pl_probe_add_ball(pl_probe *probe, double mass, pl_vec position, pl_vec velocity)
{
    return pl_probe_add_body(probe, (pl_body){.shape = pl_shape_sphere(PL_BALL_RADIUS),
                                              .mass = mass,
                                              .position = {position.x, position.y, position.z},
                                              .velocity = {velocity.x, velocity.y, velocity.z}});
}

static void read_frame(pl_probe *probe)
{
    memset(probe->now, 0xff, sizeof probe->now);
    probe->frame =
        (pl_frame){.time = NAN, .body_count = probe->scene.body_count, .bodies = probe->now};
    pl_session_read_frame(&probe->session, &probe->frame);
}

void pl_probe_create(pl_probe *probe)
{
    pl_error error = {.message = ""};
    if (probe->over ||
        !pl_probe_expect_made(probe, pl_scene_validate(&probe->scene, &error), &error)) {
        return;
    }
    pl_session_destroy(&probe->session);
    const pl_status status = pl_session_create(&probe->session, &probe->scene, &error);
    /* A profile may lack a shape that others of its engine have. None may lack spheres and planes. */
    const uint32_t shapes =
        pl_scene_needs(&probe->scene) &
        (PL_NEEDS_BOX | PL_NEEDS_CAPSULE | PL_NEEDS_CYLINDER | PL_NEEDS_HULL | PL_NEEDS_MESH);
    if (status == PL_UNSUPPORTED && shapes != 0) {
        pl_probe_skip(probe, error.message);
        return;
    }
    if (status != PL_OK) {
        pl_probe_fail(probe, "create accepts a scene that needs only what the engine claims",
                      error.message, "capabilities claims too much");
        return;
    }
    probe->steps = 0;
    probe->contact_count = 0;
    read_frame(probe);
    memcpy(probe->start, probe->now, sizeof probe->start);
    memcpy(probe->before, probe->now, sizeof probe->before);
}

void pl_probe_steps(pl_probe *probe, int count)
{
    for (int i = 0; i < count && !probe->over; ++i) {
        pl_error error = {.message = ""};
        memcpy(probe->before, probe->now, sizeof probe->before);
        if (pl_session_step(&probe->session, &probe->stats, NULL, &error) != PL_OK) {
            pl_probe_fail(probe, "step returns PL_OK", error.message, "");
            return;
        }
        probe->steps += 1;
        read_frame(probe);
        int found = 0;
        if (pl_session_read_contacts(&probe->session, &probe->contacts, &probe->contact_capacity,
                                     &found, &error) != PL_OK) {
            pl_probe_fail(probe, "read_contacts returns the number of contacts", error.message,
                          "the number is negative, or differs from call to call");
            return;
        }
        probe->contact_count = found < 0 ? 0 : found;
    }
}

bool pl_probe_run(pl_probe *probe, int steps)
{
    pl_probe_create(probe);
    pl_probe_steps(probe, steps);
    return !probe->over;
}

int pl_probe_substeps(pl_probe *probe)
{
    double mass[PL_PROBE_MOST_BODIES], inertia[PL_PROBE_MOST_BODIES][3];
    pl_engine_settings settings = {
        .body_count = probe->scene.body_count, .mass = mass, .inertia = inertia};
    pl_session_read_settings(&probe->session, &settings);
    return settings.substeps;
}
