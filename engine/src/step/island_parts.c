/* Islands that take a step in parts, so that their impacts can have their own time.
 *
 * An island holds all bodies that are near each other. Within one step few of its contacts act: those
 * that push, and those that close. The parts between the others are stepped each by itself. Where
 * two of them meet all the same, both go back to the step's start and are stepped as one part. */
#include "impact.h"
#include "model/ranges.h"

#include <string.h>

enum {
    MOST_ROUNDS = 3 /* of parts; then the island is stepped whole */
};

/* m/s: a contact acts if its impulse gave the lighter body such a speed. */
static const double PUSH = 1e-7;

/* m: a contact that closes by less does not act, and bodies that overlap by less do not meet. */
static const double CLOSED = 1e-8;

/* In units of the smaller body: bodies that come closer than their gap by this have met, even if
 * they are apart again at the step's end. */
static const double THROUGH = 0.5;

/* An island on its way through a step that it takes in parts. Arrays of bodies go by their places in
 * the island. */
typedef struct division {
    pe_step *step;
    pe_world *world;
    const pe_islands *whole;
    int k;
    const int *bodies;    /* (body_count): slots */
    const int *manifolds; /* (manifold_count): in the world's contacts */
    int body_count, manifold_count;
    double
        slow; /* m: what gravity moves in the step. Contacts that open by more have stopped to push */

    int *parent;   /* (body_count): a forest of the parts */
    double *reach; /* (body_count): m, how far a part that met another moved, by its root; else 0 */
    int *size;     /* (body_count): bodies of the part, by its root */
    int *stepped_as; /* (body_count): bodies of the part that the body was last stepped in; or 0 */
    pe_path *path;   /* (body_count): of the part that the body was last stepped in */
    pe_islands parts;

    int apart_begin;                 /* how many contacts were listed apart before the island's */
    pe_record *saved_records;        /* (body_count) at the step's start */
    pe_manifold *saved_manifolds;    /* (manifold_count) at the step's start */
    pe_manifold_point *saved_points; /* (points of these) */
} division;

static const pe_manifold *manifold_of(const division *d, int j)
{
    return &pe_manifolds(&d->world->contacts)[d->manifolds[j]];
}

/* The places of the manifold's bodies; false where one of them is static. */
static bool places_of(const division *d, const pe_manifold *m, int *a, int *b)
{
    *a = d->whole->place[m->a];
    *b = d->whole->place[m->b];
    return *a >= 0 && *b >= 0;
}

/* Whether no part has both of the manifold's bodies. */
static bool is_left_out(const division *d, const pe_manifold *m, int *a, int *b)
{
    return places_of(d, m, a, b) && pe_root_of(d->parent, *a) != pe_root_of(d->parent, *b);
}

/* ---- Which contacts act ---- */

/* Whether the manifold pushed in the last step or closes in this one, as far as can be seen. */
static bool acts(const division *d, const pe_manifold *m)
{
    const pe_world *world = d->world;
    const pe_twist *twists = pe_twists(world);
    const pe_free_motion *free = d->step->free;
    const pe_mass *masses = pe_masses(world);
    double least = PUSH * pe_min(masses[m->a].mass, masses[m->b].mass);
    for (int j = m->first; j < m->first + m->count; ++j) {
        const pe_manifold_point *point = &pe_manifold_points(&world->contacts)[j];
        double now = pe_opening_speed(world, m, point, &twists[m->a], &twists[m->b]);
        double end = pe_opening_speed(world, m, point, &free[m->a].end, &free[m->b].end);
        double speed = pe_min(now, end), gap = pe_max(point->separation, 0);
        double left = gap + d->step->dt * speed;
        if (left < -CLOSED || (pe_dot(point->impulse, m->normal) > least && left < d->slow)) {
            return true;
        }
    }
    return false;
}

static void join_acting(division *d)
{
    int a, b;
    for (int i = 0; i < d->body_count; ++i) {
        d->parent[i] = i;
    }
    for (int j = 0; j < d->manifold_count; ++j) {
        const pe_manifold *m = manifold_of(d, j);
        if (places_of(d, m, &a, &b) && acts(d, m)) {
            pe_join_roots(d->parent, a, b);
        }
    }
}

/* ---- Saving and going back ---- */

static void save(division *d)
{
    const pe_contacts *contacts = &d->world->contacts;
    pe_manifold_point *to = d->saved_points;
    for (int i = 0; i < d->body_count; ++i) {
        d->saved_records[i] = pe_records(d->world)[d->bodies[i]];
    }
    for (int j = 0; j < d->manifold_count; ++j) {
        const pe_manifold *m = manifold_of(d, j);
        d->saved_manifolds[j] = *m;
        memcpy(to, pe_manifold_points(contacts) + m->first, (size_t)m->count * sizeof *to);
        to += m->count;
    }
}

/* Whether the part of a body is not the one that it was last stepped in: parts only grow. */
static bool is_changed(const division *d, int place)
{
    return d->stepped_as[place] != d->size[pe_root_of(d->parent, place)];
}

/* Forgets the contacts that parts which are to be stepped again have listed apart. */
static void forget_contacts_apart(const division *d)
{
    pe_contact *contacts = d->world->apart_array.items;
    int kept = d->apart_begin;
    for (int i = kept; i < d->world->apart_count; ++i) {
        int a = d->whole->place[contacts[i].body_a.index];
        int b = d->whole->place[contacts[i].body_b.index];
        if (!is_changed(d, a < 0 ? b : a)) {
            contacts[kept++] = contacts[i];
        }
    }
    d->world->apart_count = kept;
}

/* Puts the bodies and contacts of the parts that are to be stepped back to the step's start. Contacts
 * between two parts push nothing. */
static void go_back(division *d)
{
    const pe_contacts *contacts = &d->world->contacts;
    const pe_manifold_point *from = d->saved_points;
    forget_contacts_apart(d);
    for (int j = 0; j < d->manifold_count; from += d->saved_manifolds[j++].count) {
        pe_manifold *m = &pe_manifolds(contacts)[d->manifolds[j]];
        pe_manifold_point *points = pe_manifold_points(contacts) + m->first;
        int a, b;
        if (is_left_out(d, m, &a, &b)) {
            for (int i = 0; i < m->count; ++i) {
                points[i].impulse = pe_v3(0, 0, 0);
            }
        } else if (is_changed(d, a < 0 ? b : a)) {
            *m = d->saved_manifolds[j];
            memcpy(points, from, (size_t)m->count * sizeof *points);
        }
    }
    for (int i = 0; i < d->body_count; ++i) {
        if (is_changed(d, i)) {
            pe_poses(d->world)[d->bodies[i]] = pe_pose_restore(&d->step->poses[d->bodies[i]]);
            pe_twists(d->world)[d->bodies[i]] = d->step->twists[d->bodies[i]];
        }
    }
}

/* ---- Stepping the parts ---- */

static pe_status step_part(division *d, int p, pe_path *path)
{
    pe_step *step = d->step;
    const pe_islands *parts = &d->parts;
    if (parts->start[p] == parts->start[p + 1]) { /* one body that touches nothing */
        pe_integrate_free(d->world, parts->bodies[parts->body_start[p]], step->free, step->dt);
        *path = PE_PATH_WARM;
        return PE_OK;
    }
    if (pe_impact_has_own_time(step, parts, p)) {
        return pe_impact_step(step, parts, p, path);
    }
    pe_interval interval = {.islands = parts, .k = p, .free = step->free, .dt = step->dt};
    pe_status status = pe_island_step(step, &interval);
    *path = interval.path;
    return status;
}

/* Steps the parts that have changed. */
static pe_status step_parts(division *d)
{
    const pe_islands *parts = &d->parts;
    pe_status status = PE_OK;
    for (int p = 0; p < parts->count && status == PE_OK; ++p) {
        const int *slots = parts->bodies + parts->body_start[p];
        const int count = parts->body_start[p + 1] - parts->body_start[p];
        if (!is_changed(d, d->whole->place[slots[0]])) {
            continue;
        }
        pe_arena_mark before = pe_arena_fill(&d->world->arena);
        pe_path path;
        status = step_part(d, p, &path);
        pe_arena_rewind(&d->world->arena, &d->world->allocator, before);
        for (int i = 0; i < count; ++i) {
            int place = d->whole->place[slots[i]];
            d->stepped_as[place] = count;
            d->path[place] = path;
        }
    }
    return status;
}

/* Divides the island by the forest. */
static pe_status divide(division *d)
{
    memset(d->size, 0, (size_t)d->body_count * sizeof *d->size);
    for (int i = 0; i < d->body_count; ++i) {
        d->size[pe_root_of(d->parent, i)] += 1;
    }
    return pe_islands_divide(d->world, d->whole, d->k, d->parent, &d->parts, d->step->error);
}

/* ---- Parts that meet ---- */

/* An upper bound, in m, on how far a point of b has moved in the step relative to one of a. */
static double motion_of(const division *d, const pe_manifold *m, pe_vec3 *displacement)
{
    const pe_pose *now = pe_poses(d->world);
    const pe_saved_pose *then = d->step->poses;
    const int slots[2] = {m->a, m->b};
    double turned = 0;
    *displacement = pe_sub(pe_sub(now[m->b].position, then[m->b].position),
                           pe_sub(now[m->a].position, then[m->a].position));
    for (int i = 0; i < 2; ++i) {
        pe_quat p = then[slots[i]].orientation, q = now[slots[i]].orientation;
        pe_vec3 v = pe_v3(q.x - p.x, q.y - p.y, q.z - p.z);
        double w = q.w - p.w;
        turned += 2 * pe_bodies(d->world)[slots[i]].bounding_radius * sqrt(w * w + pe_dot(v, v));
    }
    return pe_length(*displacement) + turned;
}

/* Whether the bodies of a manifold between two parts have met. They may keep the depth that they
 * had. *motion: as motion_of. */
static pe_status have_met(const division *d, const pe_manifold *m, double *motion, bool *met)
{
    const pe_body *bodies = pe_bodies(d->world);
    pe_vec3 displacement;
    double gap = pe_max(0, m->least_separation), depth = gap - m->least_separation;
    *motion = motion_of(d, m, &displacement);
    *met = false;
    if (!(*motion > gap + CLOSED && *motion <= PE_MOST_LENGTH)) {
        return PE_OK; /* or the state is not finite: the step will be undone */
    }
    double size = pe_min(bodies[m->a].size, bodies[m->b].size);
    if (-pe_dot(m->normal, displacement) > gap + THROUGH * size) {
        *met = true;
        return PE_OK;
    }
    double overlap;
    pe_status status = pe_pair_overlap(d->world, m->a, m->b, &overlap, d->step->error);
    *met = overlap > depth + CLOSED;
    return status;
}

/* Joins a and b, whose parts move by so much. */
static void join(division *d, int a, int b, double reach)
{
    pe_join_roots(d->parent, a, b);
    double *of = &d->reach[pe_root_of(d->parent, a)];
    *of = pe_max(*of, reach);
}

/* Joins the parts that have met, and with them all that they reach at their speed. */
static pe_status join_met(division *d, bool *any)
{
    memset(d->reach, 0, (size_t)d->body_count * sizeof *d->reach);
    *any = false;
    int a, b;
    for (int j = 0; j < d->manifold_count; ++j) {
        const pe_manifold *m = manifold_of(d, j);
        double motion;
        bool met;
        if (is_left_out(d, m, &a, &b)) {
            pe_status status = have_met(d, m, &motion, &met);
            if (status != PE_OK) {
                return status;
            }
            if (met) {
                *any = true;
                d->reach[pe_root_of(d->parent, b)] = motion;
                join(d, a, b, motion);
            }
        }
    }
    for (bool grown = *any; grown;) {
        grown = false;
        for (int j = 0; j < d->manifold_count; ++j) {
            const pe_manifold *m = manifold_of(d, j);
            if (is_left_out(d, m, &a, &b)) {
                double reach =
                    pe_max(d->reach[pe_root_of(d->parent, a)], d->reach[pe_root_of(d->parent, b)]);
                if (m->least_separation < reach) {
                    join(d, a, b, reach);
                    grown = true;
                }
            }
        }
    }
    return PE_OK;
}

/* ---- The island ---- */

static pe_status begin(division *d)
{
    pe_world *world = d->world;
    size_t bodies = (size_t)d->body_count, points = 0;
    for (int j = 0; j < d->manifold_count; ++j) {
        points += (size_t)manifold_of(d, j)->count;
    }
    d->parent = pe_scratch(world, bodies, sizeof *d->parent);
    d->reach = pe_scratch(world, bodies, sizeof *d->reach);
    d->size = pe_scratch(world, bodies, sizeof *d->size);
    d->stepped_as = pe_scratch_zero(world, bodies, sizeof *d->stepped_as);
    d->path = pe_scratch(world, bodies, sizeof *d->path);
    d->saved_records = pe_scratch(world, bodies, sizeof *d->saved_records);
    d->saved_manifolds = pe_scratch(world, (size_t)d->manifold_count, sizeof *d->saved_manifolds);
    d->saved_points = pe_scratch(world, points, sizeof *d->saved_points);
    return pe_scratch_failed(world) ? pe_fail(d->step->error, PE_NO_MEMORY,
                                              "no memory for the parts of %d bodies", d->body_count)
                                    : PE_OK;
}

/* Whether a part has an impact at its own time that may bounce: others are not worth the work. */
static bool pays(const division *d)
{
    bool any = false;
    for (int p = 0; p < d->parts.count && !any; ++p) {
        any =
            pe_may_bounce(d->world, &d->parts, p) && pe_impact_has_own_time(d->step, &d->parts, p);
    }
    return any;
}

/* Whether a part that is too large for sub-steps was stepped and will be again. */
static bool is_large_work_lost(const division *d)
{
    int bound = d->world->def.impact_bodies;
    for (int i = 0; i < d->body_count; ++i) {
        if (d->stepped_as[i] > bound && is_changed(d, i)) {
            return true;
        }
    }
    return false;
}

/* Steps all parts until none of them meet. *lost: whether a large one was stepped in vain. */
static pe_status run_rounds(division *d, bool *lost)
{
    pe_status status = PE_OK;
    bool met = true;
    *lost = false;
    for (int round = 0; met && status == PE_OK; ++round) {
        go_back(d);
        status = step_parts(d);
        if (status == PE_OK) {
            status = join_met(d, &met);
        }
        for (int i = 1; i < d->body_count && met && round + 1 >= MOST_ROUNDS; ++i) {
            pe_join_roots(d->parent, 0, i);
        }
        if (status == PE_OK && met) {
            status = divide(d);
            *lost |= is_large_work_lost(d);
        }
    }
    return status;
}

/* The longest wait of the bodies. */
static pe_backoff wait_of(const division *d)
{
    pe_backoff longest = {0};
    for (int i = 0; i < d->body_count; ++i) {
        longest = pe_backoff_longer(longest, pe_records(d->world)[d->bodies[i]].parts);
    }
    return longest;
}

/* What the solvers found out about a part tells nothing about the island. */
static void keep_waits(const division *d)
{
    for (int i = 0; i < d->body_count; ++i) {
        pe_record *r = &pe_records(d->world)[d->bodies[i]];
        r->direct = pe_backoff_less(d->saved_records[i].direct);
        r->settling = pe_backoff_less(d->saved_records[i].settling);
    }
}

static void set_wait(const division *d, pe_backoff wait)
{
    for (int i = 0; i < d->body_count; ++i) {
        pe_records(d->world)[d->bodies[i]].parts = wait;
    }
}

/* Notes which bodies were solved directly; the path of the worst part. */
static pe_path note_paths(const division *d)
{
    pe_path worst = PE_PATH_WARM;
    for (int i = 0; i < d->body_count; ++i) {
        d->step->solved_directly[d->bodies[i]] = d->path[i] != PE_PATH_SWEEPS;
        worst = d->path[i] > worst ? d->path[i] : worst;
    }
    return worst;
}

pe_status pe_parts_step(pe_step *step, int k, bool *done, pe_path *path)
{
    const pe_islands *whole = &step->islands;
    division d = {
        .step = step,
        .world = step->world,
        .whole = whole,
        .k = k,
        .bodies = whole->bodies + whole->body_start[k],
        .manifolds = whole->manifolds + whole->start[k],
        .body_count = whole->body_start[k + 1] - whole->body_start[k],
        .manifold_count = whole->start[k + 1] - whole->start[k],
        .slow = step->dt * step->dt * pe_length(step->world->def.gravity),
        .apart_begin = step->world->apart_count,
    };
    *done = false;
    pe_backoff wait = wait_of(&d);
    if (wait.wait > 0) {
        set_wait(&d, pe_backoff_less(wait));
        return PE_OK;
    }
    pe_status status = begin(&d);
    if (status == PE_OK) {
        join_acting(&d);
        status = divide(&d);
    }
    if (status != PE_OK || !pays(&d)) {
        return status;
    }
    *done = true;
    save(&d);
    bool lost;
    status = run_rounds(&d, &lost);
    if (status == PE_OK) {
        keep_waits(&d);
        set_wait(&d, pe_backoff_after(lost, wait.pause));
        *path = note_paths(&d);
    }
    return status;
}
