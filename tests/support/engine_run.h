/* Drives an engine through its adapter for the conformance tests. Whatever fails fails the test. */
#ifndef PLUMB_TEST_ENGINE_RUN_H
#define PLUMB_TEST_ENGINE_RUN_H

#include "plumb/scenario.h"
#include "runner/session.h"

enum { MOST_CONTACTS = 256, MOST_BODIES = 8 };

static const double g = 9.81; /* m/s^2, of pl_scene_default */

/* Each returns the index of what it added. */
int put_material(pl_scene *scene, const char *name, double friction, double restitution);
int put_body(pl_scene *scene, pl_body body);

/* The plane z = 0. */
pl_body floor_body(void);
/* By its half extents. */
pl_body box_body(double mass, double x, double y, double z);

/* A floor (body 0) and a box of half height `half_height` flat upon it (body 1), one material. */
pl_scene scene_with_block(double friction, double mass, double half_width, double half_height);

/* A floor of ice (material 0), rubber (material 1), and a pair of them that no rule of mixing
 * gives: friction 0.35, restitution 0.6. For an engine without restitution it is 0 everywhere. */
pl_scene scene_of_pairs(const pl_engine_choice *choice);

/* Whether the engine has a coefficient of restitution. */
bool has_restitution(const pl_engine_choice *choice);

typedef struct engine_run {
    pl_engine_choice choice;
    pl_session session;
    const pl_scene *scene;
    pl_body_state before[MOST_BODIES], now[MOST_BODIES];
    double time;
    pl_step_stats stats;
    pl_contact contacts[MOST_CONTACTS];
    pl_contact_time times[MOST_CONTACTS]; /* of the contacts, if the engine says */
    bool has_times;
    int contact_count;
} engine_run;

/* The run must stay where it is until it is finished. */
void engine_start(engine_run *r, const pl_engine_choice *choice, const pl_scene *scene);
/* One step of the scene's dt. */
void engine_step(engine_run *r);
void engine_finish(engine_run *r);

/* From the centre of mass of a box or sphere to where contact i acted on it, m, world. */
void engine_contact_arm(const engine_run *r, int i, int body, double arm[3]);

/* Applies a law to every profile of every engine of this build; on failure the last line names the
 * engine. */
void for_each_profile(void (*law)(const pl_engine_choice *choice));

/* MuJoCo's Newton and conjugate gradient methods find accelerations, from which forces follow: the
 * two agree as far as the search went. Relative; 0 for every other solver. */
double force_mismatch(const pl_engine_choice *choice);

/* The share of the depth that an engine reports and works with: 0.5 of MuJoCo 2.2 for the face of a
 * box on a box (mjc_BoxBox halves it to place the point, and then takes it for the depth); else 1. */
double depth_share(const pl_engine_choice *choice, pl_shape_kind a, pl_shape_kind b);

/* Bullet's Lemke solver bounds a friction impulse by mu N s in place of mu times the normal impulse
 * (btLemkeSolver.h takes no notice of limitDependency), and a normal one by 1e10 N s, which costs
 * ten of sixteen digits. What it reports is what it applied; but it is not Coulomb's law. */
bool solves_coulomb(const pl_engine_choice *choice);

#endif
