/* The world of sphere_world.h: semi-implicit Euler, and sequential impulses in the contacts. */
#include "sphere_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 1/x; 0 for the mass and inertia of a body that never moves. */
static double inverse(double x)
{
    return x > 0 ? 1 / x : 0;
}

static double dot(sw_vec a, sw_vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static sw_vec cross(sw_vec a, sw_vec b)
{
    const sw_vec c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return c;
}

/* a + s b */
static sw_vec add(sw_vec a, double s, sw_vec b)
{
    const sw_vec c = {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
    return c;
}

/* ---- The world ---- */

sw_world *sw_create(int most_bodies, sw_vec gravity, int max_iterations, sw_pair_function *pair,
                    const void *user)
{
    sw_world *world = (sw_world *)calloc(1, sizeof *world);
    sw_body *bodies = (sw_body *)calloc((size_t)most_bodies + 1, sizeof *bodies);
    if (world == NULL || bodies == NULL) {
        free(world);
        free(bodies);
        return NULL;
    }
    world->bodies = bodies;
    world->gravity = gravity;
    world->max_iterations = max_iterations;
    world->pair = pair;
    world->user = user;
    return world;
}

void sw_destroy(sw_world *world)
{
    if (world != NULL) {
        free(world->bodies);
        free(world->contacts);
        free(world);
    }
}

void sw_add_sphere(sw_world *world, const sw_body *sphere)
{
    world->bodies[world->body_count++] = *sphere;
}

void sw_add_plane(sw_world *world, sw_vec normal, double offset)
{
    sw_body *plane = &world->bodies[world->body_count++];
    plane->orientation.w = 1;
    plane->is_plane = true;
    plane->normal = normal;
    plane->offset = offset;
}

void sw_apply_force(sw_world *world, int body, sw_vec force, sw_vec arm)
{
    sw_body *b = &world->bodies[body];
    b->force = add(b->force, 1, force);
    b->torque = add(b->torque, 1, cross(arm, force));
}

/* ---- Collision detection ---- */

/* Finds the normal, point and separation of bodies A, a plane or a sphere, and B, a sphere. */
static void measure(const sw_body *a, const sw_body *b, sw_contact *c)
{
    if (a->is_plane) {
        c->normal = a->normal;
        c->separation = dot(a->normal, b->position) - a->offset - b->radius;
        c->point = add(b->position, -b->radius, c->normal);
        return;
    }
    const sw_vec apart = add(b->position, -1, a->position), zero = {0, 0, 0}, up = {0, 0, 1};
    const double distance = sqrt(dot(apart, apart));
    c->normal = distance > 0 ? add(zero, 1 / distance, apart) : up;
    c->separation = distance - a->radius - b->radius;
    c->point = add(a->position, a->radius + c->separation / 2, c->normal);
}

/* Adds the contact of two bodies if they touch, or would by the end of the step. */
static bool collide(sw_world *world, int body_a, int body_b, double dt)
{
    const bool swap = world->bodies[body_b].is_plane;
    sw_contact c;
    memset(&c, 0, sizeof c);
    c.body_a = swap ? body_b : body_a;
    c.body_b = swap ? body_a : body_b;
    const sw_body *a = &world->bodies[c.body_a], *b = &world->bodies[c.body_b];
    if (a->mass + b->mass <= 0) {
        return true;
    }
    measure(a, b, &c);
    const sw_pair pair = world->pair(world->user, body_a, body_b);
    const double before = dot(c.normal, add(b->velocity_before, -1, a->velocity_before));
    const double path = dt * dot(c.normal, add(b->velocity, -1, a->velocity));
    const bool bounces = pair.restitution > 0 && before < 0;
    /* A bounce is taken in the step whose beginning or end is nearer to the impact. */
    if (c.separation > 0 && c.separation + (bounces ? path / 2 : path) > 0) {
        return true;
    }
    c.friction = pair.friction;
    /* A bounce returns the velocity before the step, without what gravity adds in it, so that a
     * body at rest does not begin to bounce. Without a bounce a gap may close, but no further, and
     * a fifth of an overlap opens. */
    c.target =
        bounces ? -pair.restitution * before : -c.separation / dt * (c.separation > 0 ? 1 : 0.2);
    if (world->contact_count == world->contact_capacity) {
        const int capacity = 2 * world->contact_capacity + 16;
        void *larger = realloc(world->contacts, (size_t)capacity * sizeof c);
        if (larger == NULL) {
            return false;
        }
        world->contacts = (sw_contact *)larger;
        world->contact_capacity = capacity;
    }
    world->contacts[world->contact_count++] = c;
    return true;
}

/* ---- The step ---- */

/* Applies s times an impulse at a point that is `arm` away from the centre. */
static void push(sw_body *b, double s, sw_vec impulse, sw_vec arm)
{
    b->velocity = add(b->velocity, s * inverse(b->mass), impulse);
    b->angular_velocity = add(b->angular_velocity, s * inverse(b->inertia), cross(arm, impulse));
}

/* Corrects the impulse of one contact. Returns by how much it changed the velocity, m/s. */
static double solve(sw_world *world, sw_contact *c)
{
    sw_body *a = &world->bodies[c->body_a], *b = &world->bodies[c->body_b];
    const sw_vec n = c->normal, arm_a = add(c->point, -1, a->position);
    const sw_vec zero = {0, 0, 0}, arm_b = add(c->point, -1, b->position);
    const double inverse_mass = inverse(a->mass) + inverse(b->mass);
    const double inverse_tangent_mass = inverse_mass + inverse(a->inertia) * dot(arm_a, arm_a) +
                                        inverse(b->inertia) * dot(arm_b, arm_b);
    const sw_vec velocity = add(add(b->velocity, 1, cross(b->angular_velocity, arm_b)), -1,
                                add(a->velocity, 1, cross(a->angular_velocity, arm_a)));
    const double normal_velocity = dot(n, velocity), old = dot(n, c->impulse);
    const double normal_impulse = fmax(0, old + (c->target - normal_velocity) / inverse_mass);
    /* Coulomb's law: the friction that would stop the sliding, but at most mu times the normal. */
    const sw_vec sliding = add(velocity, -normal_velocity, n);
    const sw_vec friction = add(add(c->impulse, -old, n), -1 / inverse_tangent_mass, sliding);
    const double size = sqrt(dot(friction, friction)), most = c->friction * normal_impulse;
    const double share = size > most ? most / size : 1;
    const sw_vec impulse = add(add(zero, normal_impulse, n), share, friction);
    const sw_vec change = add(impulse, -1, c->impulse);
    c->impulse = impulse;
    push(a, -1, change, arm_a);
    push(b, 1, change, arm_b);
    return sqrt(dot(change, change)) * inverse_mass;
}

/* Adds what gravity and the applied forces give, and forgets the forces. */
static void accelerate(sw_body *b, sw_vec gravity, double dt)
{
    const sw_vec zero = {0, 0, 0};
    b->velocity_before = b->velocity;
    b->velocity = add(b->velocity, b->mass > 0 ? dt : 0, gravity);
    b->velocity = add(b->velocity, dt * inverse(b->mass), b->force);
    b->angular_velocity = add(b->angular_velocity, dt * inverse(b->inertia), b->torque);
    b->force = b->torque = zero;
}

/* Moves a body by its velocity, and turns it about its angular velocity. */
static void move(sw_body *b, double dt)
{
    const double half = dt / 2 * sqrt(dot(b->angular_velocity, b->angular_velocity));
    const double c = cos(half), s = half > 0 ? sin(half) / half * dt / 2 : 0;
    sw_quat *q = &b->orientation;
    const sw_vec zero = {0, 0, 0}, v = {q->x, q->y, q->z}, by = add(zero, s, b->angular_velocity);
    const sw_vec turned = add(add(cross(by, v), c, v), q->w, by);
    const double w = c * q->w - dot(by, v), norm = sqrt(w * w + dot(turned, turned));
    const sw_quat unit = {turned.x / norm, turned.y / norm, turned.z / norm, w / norm};
    *q = unit;
    b->position = add(b->position, dt, b->velocity);
}

bool sw_step(sw_world *world, double dt)
{
    for (int i = 0; i < world->body_count; ++i) {
        accelerate(&world->bodies[i], world->gravity, dt);
    }
    world->contact_count = 0;
    for (int a = 0; a < world->body_count; ++a) {
        for (int b = a + 1; b < world->body_count; ++b) {
            if (!collide(world, a, b, dt)) {
                return false;
            }
        }
    }
    world->residual = world->contact_count > 0 ? INFINITY : 0;
    world->iterations = 0;
    while (world->iterations < world->max_iterations && world->residual > 1e-13) {
        world->iterations += 1;
        world->residual = 0;
        for (int i = 0; i < world->contact_count; ++i) {
            world->residual = fmax(world->residual, solve(world, &world->contacts[i]));
        }
    }
    for (int i = 0; i < world->body_count; ++i) {
        if (world->bodies[i].mass > 0) {
            move(&world->bodies[i], dt);
        }
    }
    return true;
}
