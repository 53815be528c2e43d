/* Two bodies meet when their gap is at most
 *
 *   1e-3 r + h (|v_a - v_b| + r_a |w_a| + r_b |w_b|)
 *
 * r the bounding radii, and the smaller of them in the first term. The second is as far as any two
 * of their points can approach, or have parted, in a step of h at these velocities: an engine may
 * stop a body at another before they touch, or throw it off within the step. The first is for
 * bodies at rest, which engines keep a little apart. */
#include "candidate_pairs.h"

#include "gap.h"
#include "solid.h"
#include "surface_set.h"
#include "sweep_and_prune.h"

#include <stdlib.h>
#include <string.h>

static const double RESTING_GAP = 1e-3; /* of the smaller bounding radius */

struct pl_candidate_pairs {
    const pl_scene *scene;
    pl_broad_phase *broad_phase;
    pl_surface_set *surfaces;
    double *radius; /* (body_count): bounding radii */
    double *reach;  /* (body_count): a pair that meets has a gap of at most the sum of its two */
};

pl_candidate_pairs *pl_candidate_pairs_create(const pl_scene *scene)
{
    size_t count = (size_t)scene->body_count + 1;
    pl_candidate_pairs *n = calloc(1, sizeof *n);
    if (n == NULL) {
        return NULL;
    }
    n->scene = scene;
    n->broad_phase = pl_broad_phase_create(scene);
    n->surfaces = pl_surface_set_create(scene);
    n->radius = calloc(count, sizeof *n->radius);
    n->reach = calloc(count, sizeof *n->reach);
    if (n->broad_phase == NULL || n->surfaces == NULL || n->radius == NULL || n->reach == NULL) {
        pl_candidate_pairs_destroy(n);
        return NULL;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        n->radius[i] = pl_bounding_radius(&scene->bodies[i].shape);
    }
    return n;
}

void pl_candidate_pairs_destroy(pl_candidate_pairs *n)
{
    if (n != NULL) {
        pl_broad_phase_destroy(n->broad_phase);
        pl_surface_set_destroy(n->surfaces);
        free(n->radius);
        free(n->reach);
        free(n);
    }
}

/* Static bodies are where the scene has them, whatever an engine says. */
static pl_placed_shape place(const pl_candidate_pairs *n, const pl_body_state *bodies, int body)
{
    const pl_body *b = &n->scene->bodies[body];
    pl_placed_shape placed = {.shape = &b->shape, .surface = pl_surface_set_of(n->surfaces, body)};
    memcpy(placed.position, b->is_static ? b->position : bodies[body].position,
           sizeof placed.position);
    memcpy(placed.orientation, b->is_static ? b->orientation : bodies[body].orientation,
           sizeof placed.orientation);
    return placed;
}

static double turning_speed(const pl_candidate_pairs *n, const pl_body_state *bodies, int body)
{
    return n->radius[body] * pl_vec_length(pl_vec_of(bodies[body].angular_velocity));
}

/* One frame. */
typedef struct frame {
    const pl_candidate_pairs *nearby;
    const pl_body_state *bodies;
    void (*see)(void *context, const pl_near_pair *pair);
    void *context;
} frame;

static bool both_dynamic(const frame *f, int a, int b)
{
    const pl_body *bodies = f->nearby->scene->bodies;
    return !bodies[a].is_static && !bodies[b].is_static;
}

static pl_vec centre_of(const frame *f, int body)
{
    return pl_centre_of_mass(&f->nearby->scene->bodies[body].shape, f->bodies[body].position,
                             f->bodies[body].orientation);
}

static bool is_far(const frame *f, int a, int b)
{
    const pl_candidate_pairs *n = f->nearby;
    pl_vec c = pl_vec_sub(centre_of(f, a), centre_of(f, b));
    return pl_vec_length(c) > n->radius[a] + n->radius[b] + n->reach[a] + n->reach[b];
}

/* The gap of two dynamic bodies at which they still meet. */
static double meeting_gap(const frame *f, int a, int b)
{
    const pl_candidate_pairs *n = f->nearby;
    pl_vec between = pl_vec_sub(pl_vec_of(f->bodies[a].velocity), pl_vec_of(f->bodies[b].velocity));
    double speed =
        pl_vec_length(between) + turning_speed(n, f->bodies, a) + turning_speed(n, f->bodies, b);
    double rest = RESTING_GAP * fmin(n->radius[a], n->radius[b]);
    return rest + n->scene->dt * speed;
}

static void see_pair(void *context, int a, int b)
{
    const frame *f = context;
    bool may_meet = both_dynamic(f, a, b);
    if (may_meet && is_far(f, a, b)) {
        return;
    }
    double within = may_meet ? meeting_gap(f, a, b) : 0;
    pl_placed_shape placed_a = place(f->nearby, f->bodies, a);
    pl_placed_shape placed_b = place(f->nearby, f->bodies, b);
    pl_near_pair pair = {.a = a, .b = b};
    pair.status = pl_gap(&placed_a, &placed_b, within, &pair.gap);
    pair.meets = may_meet && !(pair.status == PL_OK && pair.gap > within);
    f->see(f->context, &pair);
}

void pl_candidate_pairs_each(pl_candidate_pairs *n, const pl_body_state *bodies,
                             void (*see)(void *context, const pl_near_pair *pair), void *context)
{
    frame f = {.nearby = n, .bodies = bodies, .see = see, .context = context};
    for (int i = 0; i < n->scene->body_count; ++i) {
        if (!n->scene->bodies[i].is_static) {
            double speed =
                pl_vec_length(pl_vec_of(bodies[i].velocity)) + turning_speed(n, bodies, i);
            n->reach[i] = RESTING_GAP * n->radius[i] + n->scene->dt * speed;
        }
    }
    pl_broad_phase_each_pair(n->broad_phase, bodies, n->reach, see_pair, &f);
}
