/* The inside of a check, in the check's own process: an engine in a small scene, and the
 * expectations that it meets or fails. The first expectation that fails is the result; all later
 * ones are ignored, so that a check reads straight down.
 *
 *     static void check_gravity(pl_probe *p)
 *     {
 *         pl_probe_scene(p, 1.0 / 100);
 *         pl_probe_add_ball(p, 1, (pl_vec){0, 0, 5}, (pl_vec){0, 0, 0});
 *         pl_probe_run(p, 10);
 *         pl_probe_expect(p, "the velocity after 10 steps, m/s", p->now[0].velocity[2], -0.981,
 *                         pl_probe_tolerance(p, 0.981), "gravity is not that of the scene");
 *     } */
#ifndef PLUMB_PROBE_H
#define PLUMB_PROBE_H

#include "conformance.h"
#include "plumb/vec.h"
#include "runner/session.h"

enum { PL_PROBE_MOST_BODIES = 16 };

/* A check in progress. */
typedef struct pl_probe {
    const pl_check *check;
    const pl_engine_choice *choice;
    pl_session session;
    pl_scene scene;                             /* of the coming or the present instance */
    long steps;                                 /* made since create */
    pl_frame frame;                             /* as last read */
    pl_body_state start[PL_PROBE_MOST_BODIES];  /* as read after create */
    pl_body_state before[PL_PROBE_MOST_BODIES]; /* before the last step */
    pl_body_state now[PL_PROBE_MOST_BODIES];    /* after the last step */
    pl_step_stats stats;                        /* of the last step */
    pl_contact *contacts;                       /* (contact_count) of the last step */
    int contact_count;                          /* 0 where the engine does not report contacts */
    int contact_capacity;
    char texts[8][PL_CHECK_TEXT_SIZE]; /* of pl_probe_text */
    int text_count;
    pl_check_result *result;
    bool over; /* failed or skipped: what follows does nothing */
} pl_probe;

/* The checks of each file; one without a name ends them. */
extern const pl_check pl_state_checks[], pl_place_checks[], pl_motion_checks[], pl_mass_checks[],
    pl_claim_checks[], pl_material_checks[], pl_contact_checks[], pl_impulse_checks[],
    pl_conduct_checks[];

/* ---- Scenes ---- */

/* Ends the present instance, if there is one, and begins an empty scene with gravity (0, 0, -9.81),
 * this step in s, a duration of 10 s, and one material with restitution 0 and friction 0.5, or 0
 * for an engine that does not claim friction and rotation. The scene is the probe's. */
pl_scene *pl_probe_scene(pl_probe *probe, double dt);

/* The same without gravity. */
pl_scene *pl_probe_floating(pl_probe *probe, double dt);

/* Adds a material, whose index is returned. */
int pl_probe_add_material(pl_probe *probe, double friction, double restitution);

/* Adds a body, whose index is returned; its name is made up. A mass of 0 stands for 1 kg, and an
 * orientation of 0 for no turn. */
int pl_probe_add_body(pl_probe *probe, pl_body body);

/* Adds the static plane z = 0, of material 0, and returns its index. */
int pl_probe_add_floor(pl_probe *probe);

/* The radius of balls, m. */
static const double PL_BALL_RADIUS = 0.5;

/* Adds a sphere of that radius and material 0 (kg, m, m/s), and returns its index. */
int pl_probe_add_ball(pl_probe *probe, double mass, pl_vec position, pl_vec velocity);

/* Creates the scene in the engine and reads the first frame. A scene that the engine refuses with
 * PL_UNSUPPORTED although it claims all that the scene needs is a failure. */
void pl_probe_create(pl_probe *probe);

/* Makes steps, each with reading the frame and the contacts. */
void pl_probe_steps(pl_probe *probe, int count);

/* Creates the scene and makes steps. False if the check is over. */
bool pl_probe_run(pl_probe *probe, int steps);

/* The sub-steps of a step of the instance, as the engine reads them back or declares them. */
int pl_probe_substeps(pl_probe *probe);

/* ---- Expectations ---- */

/* `scale` times the rounding of the engine's precision: 1e-10 for doubles, 2e-5 for floats. */
double pl_probe_tolerance(const pl_probe *probe, double scale);

/* Expects |found - expected| <= tolerance; NAN fails. `what` with its unit is the subject of the
 * messages, `cause` what usually causes a difference. True while all went well. */
bool pl_probe_expect(pl_probe *probe, const char *what, double found, double expected,
                     double tolerance, const char *cause);

/* The same for three components. */
bool pl_probe_expect_vector(pl_probe *probe, const char *what, pl_vec found, pl_vec expected,
                            double tolerance, const char *cause);

/* A text for an expectation, as printf; valid until eight more are made. */
__attribute__((format(printf, 2, 3))) const char *pl_probe_text(pl_probe *probe, const char *format,
                                                                ...);

/* Expects a condition; the texts say what was expected and what was found. */
bool pl_probe_require(pl_probe *probe, bool condition, const char *expected, const char *found,
                      const char *cause);

/* Fails with these texts. */
void pl_probe_fail(pl_probe *probe, const char *expected, const char *found, const char *cause);

/* Expects that a part of the check's scene could be made: `status` and `error` are of its making. */
bool pl_probe_expect_made(pl_probe *probe, pl_status status, const pl_error *error);

/* Expects that the bodies of a contact are two of the scene. */
bool pl_probe_expect_bodies(pl_probe *probe, const pl_contact *contact);

/* Ends the check as skipped, unless it has failed. */
void pl_probe_skip(pl_probe *probe, const char *why);

/* ---- Bodies, each of shapes that the engine claims (check_bodies.c) ---- */

/* Whether the engine claims all of these PL_NEEDS_*. */
bool pl_check_claims(const pl_probe *probe, uint32_t needs);

/* A body of 2 kg, about 1 m wide, at rest at the origin: of the first kind that the engine claims
 * of sphere, box, capsule, cylinder. Skips the check when it claims none of them. */
pl_body pl_check_any_body(pl_probe *probe);

/* The same, but a box where the engine claims boxes. Its orientation is about no axis of symmetry,
 * and the three moments of inertia of a box differ; the first is the largest. */
pl_body pl_check_turned_body(pl_probe *probe);

/* A hull, or a mesh that is not convex, whose centre of mass and principal axes are not those of its
 * frame. Owned by the scene. */
pl_shape pl_check_skew_solid(pl_probe *probe, pl_shape_kind kind);

/* The hull of a box whose lowest face is at z = 0.2 of its own frame, or a mesh in the form of a table with
 * two legs, whose feet are at z = 0. Owned by the scene. */
pl_shape pl_check_standing_solid(pl_probe *probe, pl_shape_kind kind);

/* Adds a static body whose top is the plane z = 0: a half-space, or a box where the engine claims
 * no planes. Skips the check when it claims neither. */
void pl_check_add_floor(pl_probe *probe);

/* Creates a scene of one body without gravity, whose index is returned. */
int pl_check_create_floating(pl_probe *probe, double dt, pl_body body);

/* The time, s, in which a body has moved since the start of the scene, by its path along its velocity
 * at the start, to which all forces must be perpendicular. Checks of forces take their time from it,
 * since the length of the step is the matter of another check. The time that was asked for where that
 * is more than a factor 10 off. */
double pl_check_time(const pl_probe *probe, int body);

/* The world's axes of the vector `local`, given in the axes of an orientation. */
pl_vec pl_check_rotate(const double orientation[4], pl_vec local);

/* The inverse of pl_check_rotate. */
pl_vec pl_check_rotate_back(const double orientation[4], pl_vec world);

/* ---- Mistakes that give a known number ---- */

/* What a known mistake would have given. */
typedef struct pl_guess {
    pl_vec value;
    const char *cause; /* static */
} pl_guess;

/* The cause of the first of `count` guesses whose value is `found`, to a thousandth of its length;
 * `otherwise` where there is none. */
const char *pl_guess_cause(pl_vec found, const pl_guess *guesses, int count, const char *otherwise);

/* Writes how many times `expected` `found` is, such as ", which is 57.296 times as much: degrees in place
 * of radians"; an empty text where the components have no common ratio. */
void pl_describe_ratio(pl_vec found, pl_vec expected, char *text, size_t size);

#endif
