#include "path.h"

#include "plumb/vec.h"

#include <stdlib.h>

/* As unit vectors of a scene are checked. */
static const double PARALLEL = 1e-9;

typedef struct followed {
    int body;
    pl_vec origin;
    pl_vec normal; /* of the plane that bears it; null where there is none */
    pl_vec along;  /* of its travel; null where it stands */
} followed;

struct pl_path {
    followed *bodies; /* (count): travels first */
    int count, travels;
    bool borne; /* any of them */
};

/* The normal of the plane that bears a body that moves along `along`, or null. */
static pl_vec bearing_normal(const pl_scene *scene, pl_vec along)
{
    pl_vec best = {0, 0, 0};
    double most = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (body->shape.kind == PL_SHAPE_PLANE) {
            pl_vec normal = pl_vec_of(body->shape.normal);
            double against = -pl_vec_dot(normal, pl_vec_of(scene->gravity));
            if (against > most && fabs(pl_vec_dot(normal, along)) <= PARALLEL) {
                most = against;
                best = normal;
            }
        }
    }
    return best;
}

static void follow(pl_path *path, const pl_scene *scene, int body, pl_vec origin, pl_vec along)
{
    pl_vec normal = bearing_normal(scene, along);
    path->borne = path->borne || pl_vec_length(normal) > 0;
    path->bodies[path->count++] =
        (followed){.body = body, .origin = origin, .normal = normal, .along = along};
}

pl_path *pl_path_create(const pl_scene *scene)
{
    const pl_vec still = {0, 0, 0};
    pl_path *path = calloc(1, sizeof *path);
    if (path == NULL) {
        return NULL;
    }
    path->bodies =
        calloc((size_t)scene->travel_count + (size_t)scene->rest_count + 1, sizeof *path->bodies);
    if (path->bodies == NULL) {
        pl_path_destroy(path);
        return NULL;
    }
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        follow(path, scene, travel->body, pl_vec_of(scene->bodies[travel->body].position),
               pl_vec_of(travel->direction));
    }
    path->travels = path->count;
    for (int i = 0; i < scene->rest_count; ++i) {
        follow(path, scene, scene->rests[i].body, pl_vec_of(scene->rests[i].position), still);
    }
    return path;
}

void pl_path_destroy(pl_path *path)
{
    if (path != NULL) {
        free(path->bodies);
        free(path);
    }
}

bool pl_path_has_lift(const pl_path *path)
{
    return path->borne;
}

bool pl_path_has_line(const pl_path *path)
{
    return path->travels > 0;
}

static pl_vec displacement(const followed *f, const pl_body_state *bodies)
{
    return pl_vec_sub(pl_vec_of(bodies[f->body].position), f->origin);
}

double pl_path_lift(const pl_path *path, const pl_body_state *bodies)
{
    double highest = 0;
    for (int i = 0; i < path->count; ++i) {
        const followed *f = &path->bodies[i];
        highest = fmax(highest, pl_vec_dot(displacement(f, bodies), f->normal));
    }
    return highest;
}

double pl_path_deviation(const pl_path *path, const pl_body_state *bodies)
{
    double farthest = 0;
    for (int i = 0; i < path->travels; ++i) {
        const followed *f = &path->bodies[i];
        pl_vec off = pl_vec_reject(displacement(f, bodies), f->along);
        farthest = fmax(farthest, pl_vec_length(pl_vec_reject(off, f->normal)));
    }
    return farthest;
}
