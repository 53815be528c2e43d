/* sphere_world: a small library that simulates spheres and half-spaces. It stands for your engine,
 * and knows nothing of Plumb. Units are SI, and vectors are in world axes. */
#ifndef SPHERE_WORLD_H
#define SPHERE_WORLD_H

#include <stdbool.h>

/* A vector. */
typedef struct sw_vec {
    double x, y, z;
} sw_vec;

/* A rotation from the axes of a body to those of the world, of unit length. */
typedef struct sw_quat {
    double x, y, z, w;
} sw_quat;

/* A sphere, or a plane, which has mass 0 and stays at the origin. */
typedef struct sw_body {
    double mass;    /* kg; 0: the body never moves */
    double inertia; /* kg m^2, about every axis through the centre */
    double radius;  /* m */
    sw_vec position;
    sw_quat orientation;
    sw_vec velocity, angular_velocity;
    /* The fields below are the world's. */
    bool is_plane;
    sw_vec normal;
    double offset;
    sw_vec force, torque;   /* for the next step */
    sw_vec velocity_before; /* at the beginning of the step */
} sw_body;

/* A contact of the last step, as it was before the bodies moved. */
typedef struct sw_contact {
    int body_a, body_b;
    sw_vec point;
    sw_vec normal;     /* of unit length, from A to B */
    double separation; /* m; negative where the bodies overlap */
    sw_vec impulse;    /* N s, on B */
    /* The fields below are the solver's. */
    double friction;
    double target; /* m/s: the least normal velocity at the end of the step */
} sw_contact;

/* Friction and restitution of two bodies. */
typedef struct sw_pair {
    double friction, restitution;
} sw_pair;

/* Returns the coefficients of a contact; `user` is what sw_create was given. */
typedef sw_pair sw_pair_function(const void *user, int body_a, int body_b);

/* A world. Its fields are for reading. */
typedef struct sw_world {
    sw_vec gravity;
    int max_iterations;
    sw_pair_function *pair;
    const void *user;
    int body_count, contact_count, contact_capacity;
    sw_body *bodies;      /* (body_count) in the order in which they were added */
    sw_contact *contacts; /* (contact_count) of the last step */
    int iterations;       /* that the last step needed */
    double residual;      /* m/s: the largest change of velocity in the last of them */
} sw_world;

/* Makes a world for up to `most_bodies` bodies. Returns NULL without memory. */
sw_world *sw_create(int most_bodies, sw_vec gravity, int max_iterations, sw_pair_function *pair,
                    const void *user);

/* Frees a world and all that is in it. NULL is allowed. */
void sw_destroy(sw_world *world);

/* Adds a sphere. */
void sw_add_sphere(sw_world *world, const sw_body *sphere);

/* Adds the half-space of all points x with normal . x <= offset (m), which never moves. */
void sw_add_plane(sw_world *world, sw_vec normal, double offset);

/* Applies a force (N) over the next step at a point that is `arm` (m) away from the centre. */
void sw_apply_force(sw_world *world, int body, sw_vec force, sw_vec arm);

/* Advances by dt seconds. Returns false without memory. */
bool sw_step(sw_world *world, double dt);

#endif
