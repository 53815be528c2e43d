/* The bodies that checks are made with, each of shapes that the engine claims. */
#ifndef PLUMB_CHECK_BODIES_H
#define PLUMB_CHECK_BODIES_H

#include "probe.h"

/* Whether the engine claims all of these PL_NEEDS_*. */
bool pl_check_claims(const pl_probe *probe, uint32_t needs);

/* A body of 2 kg, about 1 m wide, at rest at the origin: of the first kind that the engine claims
 * of sphere, box, capsule, cylinder. Skips the check when it claims none of them. */
pl_body pl_check_any_body(pl_probe *probe);

/* The same, but a box where the engine claims boxes. Its orientation is about no axis of symmetry,
 * and the three moments of inertia of a box differ; the first is the largest. */
pl_body pl_check_turned_body(pl_probe *probe);

/* A hull whose centre of mass and principal axes are not those of its frame. Owned by the scene. */
pl_shape pl_check_skew_hull(pl_probe *probe);

/* The hull of a box whose lowest face is at z = 0.2 of its own frame. Owned by the scene. */
pl_shape pl_check_box_hull(pl_probe *probe);

/* A mesh, not convex, whose centre of mass and principal axes are not those of its frame. Owned by
 * the scene. */
pl_shape pl_check_skew_mesh(pl_probe *probe);

/* A mesh in the form of a table with two legs, whose feet are at z = 0. Owned by the scene. */
pl_shape pl_check_table_mesh(pl_probe *probe);

/* Adds a static body whose top is the plane z = 0: a half-space, or a box where the engine claims
 * no planes. Returns its index, or -1 after skipping the check when it claims neither. */
int pl_check_add_floor(pl_probe *probe);

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

#endif
