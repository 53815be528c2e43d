/* Energy and momentum of a run: what the engine gained or lost of them, apart from the work and the
 * impulses of the scene. Both depend on the engine's integrator, which is detected from the frames.
 * The scales of a scene, which they are divided by, and the validity checks of a frame are here too.
 *
 * Arrays of states have scene->body_count items. */
#ifndef PLUMB_MECHANICS_H
#define PLUMB_MECHANICS_H

#include "base/arena.h"
#include "metrics.h"
#include "plumb/contact_times.h"
#include "plumb/scene.h"
#include "plumb/vec.h"

/* ---- The engine's integrator (integrator.c) ----
 *
 * It is detected from the frames: how positions follow velocities. What the engine declares of itself, its
 * sub-steps and its precision, is known beforehand. */

/* What an engine declares, by which its frames are judged. {0} is one sub-step, in doubles. */
typedef struct pl_referee_engine {
    int substeps;           /* that it makes in a step; 0: one */
    pl_precision precision; /* of its numbers */
} pl_referee_engine;

/* The sub-steps of a step, at least one. */
int pl_substeps_of(const pl_referee_engine *engine);

/* By how much rounding may change a number in a step, relative to the number: 0 for an engine in
 * doubles, whose rounding no metric resolves. An engine in floats rounds, by 2^-24 each, the number
 * and what it adds to it in each of n sub-steps, and both again where the frame is read: together
 * 2 (n + 1) 2^-24. Over many steps these add up, because rounding may go the same way each time. */
double pl_step_rounding(const pl_referee_engine *engine);

/* How an engine integrates positions over a step of length h. */
typedef enum pl_position_rule {
    PL_SEMI_IMPLICIT, /* x' = x + h v', with v' = v + h g + J/m: conserves E + (h/2) m g.v. With n
                         sub-steps h is h / n here. */
    PL_SECOND_ORDER,  /* exact under constant gravity: conserves E */
    PL_POSITION_RULE_COUNT
} pl_position_rule;

/* Steps of bodies in which the two integrators differ, counted by the integrator that they fit; the
 * last item counts those that fit neither. Starts as {0}, but for the engine. */
typedef struct pl_integrator_votes {
    long flying[PL_POSITION_RULE_COUNT + 1]; /* in steps in which gravity alone acted */
    long pushed[PL_POSITION_RULE_COUNT + 1]; /* in other steps */
    pl_referee_engine engine;
} pl_integrator_votes;

/* The part of a step's displacement by which n sub-steps of semi-implicit Euler differ from one, as
 * the second-order rule does by 1/2: (1 - 1/n) / 2. */
double pl_later_share(const pl_referee_engine *engine);

/* Counts one step of the dynamic bodies. `turned` (scene->body_count) is what forces that turn with
 * the bodies add to the displacements of a second-order integrator, m. */
void pl_integrator_see(pl_integrator_votes *votes, const pl_scene *scene,
                       const pl_body_state *before, const pl_body_state *after,
                       const pl_vec *turned);

/* The integrator that fits most steps in free flight. Without such steps it is that of second order
 * if more of the other steps fit it than chance explains: an engine of second order may move
 * colliding bodies differently, one of semi-implicit Euler has no such steps. PL_SEMI_IMPLICIT where
 * no step distinguishes the two, for example because nothing accelerates: both energies then grow
 * alike. */
pl_position_rule pl_integrator_of(const pl_integrator_votes *votes);

/* Whether the steps of a run agree on one integrator. */
typedef enum pl_integrator_certainty {
    PL_INTEGRATOR_UNDETECTED, /* no step distinguishes the two, or more steps fit neither */
    PL_INTEGRATOR_MIXED,      /* some steps fit the one, some the other */
    PL_INTEGRATOR_DETECTED    /* nine in ten of the steps that fit either integrator fit it */
} pl_integrator_certainty;

/* How certain pl_integrator_of is. */
pl_integrator_certainty pl_integrator_certain(const pl_integrator_votes *votes);

/* ---- The exact answers of an integrator at the scene's step, with any number of sub-steps (discrete_answer.c) ---- */

/* The distance of a travel, m; NAN if it is not known. */
double pl_discrete_travel(const pl_scene *scene, const pl_expect_travel *travel,
                          pl_position_rule rule, const pl_referee_engine *engine);

/* An expected value, in its unit; NAN if it is not known. */
double pl_discrete_value(const pl_scene *scene, const pl_expect_value *value, pl_position_rule rule,
                         const pl_referee_engine *engine);

/* ---- Scales (scale.c) ---- */

/* The scales of one scene. */
typedef struct pl_scale {
    int dynamic_count;
    /* J: initial kinetic energy + M |g| H, where H is the extent along gravity of the bounding
     * spheres of the dynamic bodies at the start; 1 J if that is 0. */
    double energy;
    /* N s: sum over dynamic bodies of m |v0| + |I w0| / r + m |g| T, with the bounding radius r and
     * the duration T, + sum over forces of |F| T_F with each force's own duration T_F; at least
     * 1e-300. */
    double momentum;
    /* N m s: momentum x (the largest distance of a dynamic body's centre from the origin at the
     * start, plus its r). */
    double angular_momentum;
    double speed_bound;  /* m/s: no point of a body is faster in a valid run; see scale.c */
    double travel_bound; /* m: no body goes farther in a valid run */
} pl_scale;

/* The scales of the scene's initial state. */
pl_scale pl_scale_of(const pl_scene *scene);

/* PL_ENDING_NONFINITE, with body and step in `error`, when a number of a dynamic body or of a static
 * one's pose is NaN or infinite, or the orientation of a dynamic one has a squared norm outside
 * 1/2 .. 2. */
pl_ending pl_check_finite(const pl_scene *scene, const pl_body_state *bodies, long step,
                          pl_error *error);

/* PL_ENDING_DIVERGED, with the reason in `error`, when a point of a dynamic body is faster than
 * scale->speed_bound, when one is farther than scale->travel_bound from where it began, or when the current `energy_gain` (the metric) exceeds 10. A free fall,
 * however long, gains no energy. */
pl_ending pl_check_bounds(const pl_scene *scene, const pl_scale *scale, const pl_body_state *bodies,
                          double energy_gain, long step, pl_error *error);

/* ---- Forces of the scene, which may turn with their bodies within a step (applied_force.c) ---- */

/* Simpson's rule over a step: the start, the midpoint and the end. */
enum { PL_NODES = 3 };
extern const double pl_node_times[PL_NODES]; /* of the step */
extern const double pl_node_weights[PL_NODES];

/* Whether the force acts in step number `step` (from 1) of length dt, s. */
bool pl_applied_force_acts(const pl_force *force, long step, double dt);

/* A force at a node of a step, in the world frame. */
typedef struct pl_applied_force {
    pl_vec impulse; /* over the whole step, N s */
    pl_vec arm;     /* m */
} pl_applied_force;

/* The force at a node of a step of dt seconds. */
pl_applied_force pl_applied_force_at(const pl_force *force, const pl_body_state *before,
                                     const pl_body_state *after, double dt, int node);

/* The force's impulse on its body over a step of dt seconds, N s, world frame. A force in the
 * body's frame turns within the step of a second-order integrator, and keeps the direction of the
 * start in a step of semi-implicit Euler. */
pl_vec pl_applied_force_impulse(const pl_force *force, pl_position_rule integrator,
                                const pl_body_state *before, const pl_body_state *after, double dt);

/* ---- Energy and momentum ---- */

/* The energy and momentum of a run so far. */
typedef struct pl_mechanics pl_mechanics;

/* `scene` must outlive it. Memory of the arena. */
pl_mechanics *pl_mechanics_create(const pl_scene *scene, pl_arena *arena);

/* Takes the state before the first step. */
void pl_mechanics_start(pl_mechanics *mechanics, const pl_body_state *bodies);

/* A step as the referee sees it. */
typedef struct pl_step {
    long number;                         /* from 1 */
    const pl_body_state *before, *after; /* (scene->body_count) */
    const pl_contact *contacts;          /* between bodies of the scene */
    const pl_contact_time *times;        /* of the contacts; NULL: all are of the whole step */
    int contact_count;                   /* < 0: the engine reports no contacts */
    bool has_points_alone;      /* the engine reported contact points, and not their impulses */
    bool repeats;               /* the states, contacts and times are those of the last step */
    const pl_step_stats *stats; /* NULL: the engine reports none */
    double cpu_time;            /* of the process, for the step call alone, s */
} pl_step;

/* Takes a step, whose contacts may be unreported. */
void pl_mechanics_step(pl_mechanics *mechanics, const pl_step *step);

/* The steps so far by the integrator that they fit. Borrowed. What the engine declares is set there
 * before pl_mechanics_start. */
pl_integrator_votes *pl_mechanics_votes(pl_mechanics *mechanics);

/* Of the last state: (E - E0 - work) / scale.energy, where E is the energy that the integrator
 * conserves. */
double pl_mechanics_energy_gain(const pl_mechanics *mechanics, const pl_scale *scale,
                                pl_position_rule integrator);

/* Of the last state: the larger of |p - p0 - J| / scale.momentum and |L - L0 - K| /
 * scale.angular_momentum, where J and K are the impulses of gravity, of the scene's forces and of
 * the reported contacts with static bodies; each without what rounding of the declared precision
 * explains. If the engine reports no contacts, the result is valid
 * only while nothing has touched a static body. With sub-steps, L counts only while no contact with
 * a static body was reported: its arms are those of sub-steps that are not known. */
double pl_mechanics_momentum_error(const pl_mechanics *mechanics, const pl_scale *scale,
                                   pl_position_rule integrator);

#endif
