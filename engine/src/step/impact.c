/* Time-of-impact sub-steps of one island, with contacts of their own. */
#include "impact.h"

enum {
    MAX_SUBSTEPS = 8, /* of a step; at least two for each body */
    MAX_TRIES = 8,    /* to hit the time of an impact */
    /* Meshes of so many facets together have their contacts found once in a step; those of fewer
     * the more often, and all at least LEAST_SEARCHES times. */
    MANY_FACETS = 2000,
    LEAST_SEARCHES = 2
};

/* In units of the first impact's speed: contacts that close more slowly after it are no impacts. */
static const double MINOR = 1e-3;

/* s per s: impacts within this part of the step are simultaneous. */
static const double TOGETHER = 1e-3;

/* s per s: an impact that bounces also pushes through gaps that it would close in this part of the
 * step. */
static const double SHOCK = 1e-4;

/* An island on its way through a step that it takes in sub-steps. While it does, world->contacts
 * and world->previous are the lists of the sub-steps, and world->substep_contacts is the list of
 * the step. */
typedef struct substeps {
    pe_step *step;
    pe_world *world;
    const pe_islands *islands; /* of the step */
    int k;                     /* the island in it */
    pe_islands island;         /* the same bodies with the manifolds of the sub-step, all in one */
    pe_interval interval;      /* of the sub-step; only the bodies' free motions are filled */
    pe_pair_list pairs;        /* of the island */
    int *counts;               /* of all points of each manifold of the sub-step */
    pe_free_motion *free;      /* that of `interval` */
    pe_saved_pose *poses;      /* (bodies) at the sub-step's start */
    pe_twist *twists;          /* (bodies) at the sub-step's start */
    pe_twist *ends;            /* (bodies) at the end of `left`, without the impact */
    double left;               /* s, of the step */
    double near;               /* m: a gap through which an impact that bounces pushes */
    double slow;               /* m/s: at least what is no impact; rises with each impact */
    int order;                 /* of the last solve in the step */
    int searches_left;         /* for contacts */
    bool bounces;              /* a contact has restitution: impacts are found more exactly */
    bool may_push;             /* between impacts; else the step goes on as an ordinary one */
} substeps;

static int body_count(const substeps *s)
{
    return s->island.body_start[1];
}

static int max_substeps(const substeps *s)
{
    int two_each = 2 * body_count(s);
    return two_each > MAX_SUBSTEPS ? two_each : MAX_SUBSTEPS;
}

/* ---- Points ---- */

/* Speed, in m/s, at which the gap of a point opens, at these velocities of its bodies. */
static double opening_at(const pe_world *world, const pe_point_walk *at, const pe_twist *of_a,
                         const pe_twist *of_b)
{
    return pe_opening_speed(world, at->manifold, at->point, of_a, of_b);
}

static double opening(const pe_world *world, const pe_point_walk *at)
{
    const pe_twist *twists = pe_twists(world);
    return opening_at(world, at, &twists[at->manifold->a], &twists[at->manifold->b]);
}

/* m/s: a contact that closes more slowly is no impact. */
static double slow_at(const substeps *s, const pe_point_walk *at)
{
    return pe_max(s->slow, pe_slow_closing(s->world, at->manifold, s->step->dt));
}

/* Whether a point that opens at `speed` is an impact now. */
static bool impacts_now(const substeps *s, const pe_point_walk *at, double speed)
{
    return speed < -slow_at(s, at) &&
           at->point->separation <=
               pe_max(pe_closed_gap(at->manifold), -speed * TOGETHER * s->step->dt);
}

/* Moves on to the next point of the sub-step's contacts that closes fast enough for an impact. */
static bool next_closing(const substeps *s, pe_point_walk *at, double *speed)
{
    while (pe_next_point(at)) {
        *speed = opening(s->world, at);
        if (*speed < -slow_at(s, at)) {
            return true;
        }
    }
    return false;
}

/* ---- The points that take part in a solve ---- */

typedef enum choice {
    ALL,
    SEPARATING, /* all except those that are about to impact */
    IMPACTING   /* those that impact now, and those that touch */
} choice;

/* m: an impact pushes through a gap up to this. */
static double shock_gap(const substeps *s, const pe_point_walk *at)
{
    double fallen = 0.5 * s->step->dt * pe_max(slow_at(s, at), pe_fall(s->world, s->step->dt));
    return pe_max(pe_closed_gap(at->manifold),
                  at->manifold->restitution > 0 ? pe_min(fallen, s->near) : fallen);
}

static bool is_chosen(const substeps *s, choice which, const pe_point_walk *at)
{
    double speed = opening(s->world, at);
    switch (which) {
    case SEPARATING:
        return speed >= -slow_at(s, at);
    case IMPACTING:
        return impacts_now(s, at, speed) ||
               (speed >= -slow_at(s, at) && at->point->separation <= shock_gap(s, at));
    default:
        return true;
    }
}

/* Moves the chosen points of the manifold to its front; how many they are. The impulses of the
 * others become 0. */
static int bring_forward(const substeps *s, choice which, pe_manifold *m, int count)
{
    pe_manifold_point *points = pe_manifold_points(&s->world->contacts) + m->first;
    int chosen = 0;
    for (int j = 0; j < count; ++j) {
        if (is_chosen(s, which, &(pe_point_walk){.manifold = m, .point = &points[j]})) {
            pe_manifold_point moved = points[j];
            points[j] = points[chosen];
            points[chosen++] = moved;
        } else {
            points[j].impulse = pe_v3(0, 0, 0);
        }
    }
    return chosen;
}

/* Makes s->island that of the chosen points; how many they are. */
static int choose(substeps *s, choice which)
{
    pe_contacts *contacts = &s->world->contacts;
    int *listed = &s->island.start[1], total = 0;
    *listed = 0;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        pe_manifold *m = &pe_manifolds(contacts)[i];
        m->count = bring_forward(s, which, m, s->counts[i]);
        if (m->count > 0) {
            s->island.manifolds[(*listed)++] = i;
        }
        total += m->count;
    }
    return total;
}

/* ---- Lists of contacts ---- */

/* Exchanges the world's lists for those of sub-steps, or back. */
static void exchange_lists(pe_world *world)
{
    pe_contacts_swap(&world->contacts, &world->substep_contacts);
    pe_contacts_swap(&world->previous, &world->substep_previous);
}

static void count_points(substeps *s)
{
    const pe_contacts *contacts = &s->world->contacts;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        s->counts[i] = pe_manifolds(contacts)[i].count;
    }
}

/* Finds the contacts at the poses now. The list before is in world->previous. */
static pe_status find_contacts(substeps *s)
{
    choose(s, ALL);
    s->searches_left -= 1;
    pe_status status = pe_check_bodies(s->step, s->island.bodies, body_count(s));
    if (status == PE_OK) {
        status = pe_contacts_find(s->world, &s->step->rules, &s->pairs, NULL, s->step->dt,
                                  s->step->error);
        count_points(s);
    }
    return status;
}

/* The point of the step's contacts that stands for a point of a sub-step: of the same pair, that on
 * the same features, or else the nearest. */
static pe_manifold_point *step_point_of(const substeps *s, const pe_point_walk *of)
{
    pe_manifold_point *best = NULL;
    double least = HUGE_VAL;
    pe_point_walk at = pe_walk_island(&s->world->substep_contacts, s->islands, s->k);
    while (pe_next_point(&at)) {
        if (at.manifold->a == of->manifold->a && at.manifold->b == of->manifold->b) {
            pe_vec3 off = pe_sub(at.point->position, of->point->position);
            double distance = at.point->feature == of->point->feature ? -1 : pe_dot(off, off);
            if (distance < least) {
                least = distance;
                best = at.point;
            }
        }
    }
    return best;
}

/* Adds the impulses of a sub-step's list to those of the step, from which the next one starts. */
static void add_impulses(const substeps *s, const pe_contacts *list)
{
    for (pe_point_walk at = pe_walk_points(list); pe_next_point(&at);) {
        if (pe_dot(at.point->impulse, at.point->impulse) > 0) {
            pe_manifold_point *to = step_point_of(s, &at);
            /* NOLINTNEXTLINE(clang-analyzer-core.*): the step's list has points of every pair */
            to->impulse = pe_add(to->impulse, at.point->impulse);
        }
    }
}

/* ---- Motion up to an impact ---- */

static void predict(substeps *s, double dt)
{
    s->interval.begin = s->step->dt - s->left;
    s->interval.order = ++s->order;
    for (int i = 0; i < body_count(s); ++i) {
        int slot = s->island.bodies[i];
        s->free[slot] = pe_predict_body(s->world, slot, false, dt);
    }
    s->interval.dt = dt;
}

/* Whether any of the chosen points must push, because free motion over dt would close it; where
 * nothing bounces some mostly must. */
static bool must_push(const substeps *s, double dt)
{
    if (!s->bounces) {
        return true;
    }
    const pe_twist *twists = pe_twists(s->world);
    pe_point_walk at = pe_walk_points(&s->world->contacts);
    while (pe_next_point(&at)) {
        int a = at.manifold->a, b = at.manifold->b;
        const pe_twist *of_a = s->island.place[a] < 0 ? &twists[a] : &s->free[a].end;
        const pe_twist *of_b = s->island.place[b] < 0 ? &twists[b] : &s->free[b].end;
        double speed = opening_at(s->world, &at, of_a, of_b);
        if (pe_max(at.point->separation, 0) + dt * speed < -pe_closed_gap(at.manifold)) {
            return true;
        }
    }
    return false;
}

static pe_twist solved_twist(const pe_island_problem *built, int i)
{
    const double *v = built->problem.velocity[i];
    return (pe_twist){pe_v3_load(v), pe_v3_load(v + 3)};
}

/* The velocities at the end of the rest of the step, if there were no impacts. *pushing: whether
 * contacts push before the first one. */
static pe_status look_ahead(substeps *s, bool *pushing)
{
    pe_island_problem built;
    predict(s, s->left);
    *pushing = choose(s, SEPARATING) > 0 && must_push(s, s->left);
    bool solve = *pushing && s->may_push;
    pe_status status = solve ? pe_island_solve(s->step, &s->interval, &built) : PE_OK;
    for (int i = 0; i < body_count(s) && status == PE_OK; ++i) {
        s->ends[i] = solve ? solved_twist(&built, i) : s->free[s->island.bodies[i]].end;
    }
    choose(s, ALL);
    return status;
}

/* When a gap that opens by u0 now and by u1 at the end closes, in s: a root of
 * gap + u0 t + (u1 - u0) t^2 / (2 left). HUGE_VAL: never. */
static double closing_time(double gap, double closed, double u0, double u1, double left)
{
    if (gap <= closed) {
        return 0;
    }
    double square = u0 * u0 - 2 * gap * (u1 - u0) / left;
    return square >= 0 ? 2 * gap / (sqrt(square) - u0) : HUGE_VAL;
}

static const pe_twist *end_of(const substeps *s, int slot)
{
    int place = s->island.place[slot];
    return place < 0 ? &pe_twists(s->world)[slot] : &s->ends[place];
}

/* The time of the first impact in the rest of the step, in s from now; `left` when there is none.
 * *fast: whether any contact closes fast enough to be one at some time; false also where contacts
 * push that may not. */
static pe_status first_impact(substeps *s, double *time, bool *fast)
{
    bool pushing;
    pe_status status = look_ahead(s, &pushing);
    double u0;
    *time = s->left;
    *fast = false;
    if (pushing && !s->may_push) {
        return status;
    }
    pe_point_walk at = pe_walk_points(&s->world->contacts);
    while (status == PE_OK && next_closing(s, &at, &u0)) {
        double u1 = opening_at(s->world, &at, end_of(s, at.manifold->a), end_of(s, at.manifold->b));
        *time = pe_min(
            *time, closing_time(at.point->separation, pe_closed_gap(at.manifold), u0, u1, s->left));
        *fast = true;
    }
    return status;
}

/* The time to the nearest impact at the speeds now, in s; below 0 when that is past. */
static double time_to_impact(const substeps *s)
{
    double least = HUGE_VAL, speed;
    for (pe_point_walk at = pe_walk_points(&s->world->contacts); next_closing(s, &at, &speed);) {
        bool closed = fabs(at.point->separation) <= pe_closed_gap(at.manifold);
        least = pe_min(least, closed ? 0 : at.point->separation / -speed);
    }
    return least;
}

/* Moves the island over dt with the contacts of that choice. */
static pe_status move(substeps *s, choice which, double dt)
{
    predict(s, dt);
    if (choose(s, which) > 0 && must_push(s, dt)) {
        return pe_island_step(s->step, &s->interval);
    }
    for (pe_point_walk at = pe_walk_points(&s->world->contacts); pe_next_point(&at);) {
        at.point->impulse = pe_v3(0, 0, 0);
    }
    for (int i = 0; i < body_count(s); ++i) {
        pe_integrate_free(s->world, s->island.bodies[i], s->free, dt);
    }
    return PE_OK;
}

/* Copies the bodies' state to s->poses and s->twists, or back. */
static void save(substeps *s)
{
    for (int i = 0; i < body_count(s); ++i) {
        s->poses[i] = pe_pose_save(&pe_poses(s->world)[s->island.bodies[i]]);
        s->twists[i] = pe_twists(s->world)[s->island.bodies[i]];
    }
}

static void restore(substeps *s)
{
    for (int i = 0; i < body_count(s); ++i) {
        pe_poses(s->world)[s->island.bodies[i]] = pe_pose_restore(&s->poses[i]);
        pe_twists(s->world)[s->island.bodies[i]] = s->twists[i];
    }
}

/* A move over `time`, after which the impact is `more` away, both in s. */
typedef struct attempt {
    double time, more;
} attempt;

/* The time to try after an attempt; the same one where no impact is near. Contacts that push move
 * bodies by other velocities than those at the move's end, so that these alone may lead back and
 * forth: between two attempts on both sides of the impact its time is interpolated. */
static double next_time(attempt now, attempt last, double left, double enough)
{
    double had = fabs(last.more), has = fabs(now.more);
    if (now.more == HUGE_VAL || (has <= enough && had <= enough && has > 0.5 * had && had > 0)) {
        return now.time;
    }
    bool between = (now.more > 0 && last.more < 0) || (now.more < 0 && last.more > 0);
    double step = between ? (now.time - last.time) / (last.more - now.more) * now.more : now.more;
    return pe_max(0.1 * now.time, pe_min(now.time + step, left));
}

/* Moves for about `time`, to the impact, or to the end of the step. */
static pe_status move_to_impact(substeps *s, double time)
{
    const int listed = s->world->apart_count;
    attempt last = {0, 0};
    save(s);
    for (int n = 0; n < MAX_TRIES; ++n) {
        pe_status status = move(s, SEPARATING, time);
        if (status == PE_OK) {
            status = find_contacts(s);
        }
        if (status != PE_OK) {
            return status;
        }
        double more = time_to_impact(s);
        double next = next_time((attempt){time, more}, last, s->left, TOGETHER * s->step->dt);
        if (more == 0 || next == time || n + 1 == MAX_TRIES || s->searches_left <= 0) {
            break;
        }
        restore(s);
        s->world->apart_count = listed;
        pe_contacts_swap(&s->world->contacts, &s->world->previous);
        count_points(s);
        last = s->bounces ? (attempt){time, more} : last;
        time = next;
    }
    add_impulses(s, &s->world->previous);
    s->left -= time;
    return PE_OK;
}

/* ---- Impacts ---- */

/* Of the fastest impact now, in m/s; 0: there is none. */
static double impact_speed(const substeps *s)
{
    double most = 0, speed;
    for (pe_point_walk at = pe_walk_points(&s->world->contacts); next_closing(s, &at, &speed);) {
        most = impacts_now(s, &at, speed) ? pe_max(most, -speed) : most;
    }
    return most;
}

/* Gives the bodies of impacting contacts their new velocities. */
static pe_status solve_impact(substeps *s)
{
    double speed = impact_speed(s);
    if (speed == 0) {
        return PE_OK;
    }
    for (int i = 0; i < body_count(s); ++i) {
        int slot = s->island.bodies[i];
        s->free[slot] = (pe_free_motion){.end = pe_twists(s->world)[slot]};
    }
    s->near = SHOCK * s->step->dt * speed;
    choose(s, IMPACTING);
    pe_island_problem built;
    s->interval.dt = 1; /* gaps do not matter in an instant: over a second they close by nothing */
    s->interval.instant = true;
    pe_status status = pe_island_solve(s->step, &s->interval, &built);
    s->interval.instant = false;
    if (status == PE_OK) {
        for (int i = 0; i < body_count(s); ++i) {
            pe_twists(s->world)[s->island.bodies[i]] = solved_twist(&built, i);
        }
        pe_problem_store_impulses(s->world, &built);
        add_impulses(s, &s->world->contacts);
        s->interval.begin = s->step->dt - s->left;
        s->interval.order = ++s->order;
        status = pe_list_apart(s->step, &s->interval, s->interval.begin, &built, NULL);
    }
    choose(s, ALL);
    s->slow = pe_max(s->slow, MINOR * speed);
    return status;
}

/* Integrates from impact to impact and to the end of the step. */
static pe_status run_substeps(substeps *s)
{
    pe_status status = find_contacts(s);
    bool fast = true;
    for (int n = 0;
         n < max_substeps(s) && fast && s->left > 0 && s->searches_left > 0 && status == PE_OK;
         ++n) {
        double time;
        status = first_impact(s, &time, &fast);
        if (status == PE_OK && fast && time > 0) {
            status = move_to_impact(s, time);
        }
        if (status == PE_OK && fast && s->left > 0) {
            status = solve_impact(s);
        }
    }
    if (status == PE_OK && s->left > 0) {
        status = move(s, ALL, s->left);
        add_impulses(s, &s->world->contacts);
    }
    return status;
}

/* How often the contacts of an island may be found in a step. */
static int most_searches(const substeps *s)
{
    int facets = 0;
    for (int i = 0; i < body_count(s); ++i) {
        const pe_geometry *g = pe_bodies(s->world)[s->island.bodies[i]].geometry;
        facets += g != NULL && !pe_geometry_is_polytope(g) ? g->triangle_count : 0;
    }
    const int all = max_substeps(s) * MAX_TRIES + 1;
    int most = facets > 0 ? MANY_FACETS / facets : all;
    return most > all ? all : most < LEAST_SEARCHES ? LEAST_SEARCHES : most;
}

/* Lists the pairs of the island's manifolds, and sets the impulses of the step's contacts to 0. */
static void take_over_contacts(substeps *s)
{
    pe_point_walk at = pe_walk_island(&s->world->contacts, s->islands, s->k);
    while (pe_next_point(&at)) {
        int a = at.manifold->a, b = at.manifold->b;
        const pe_pair *last = s->pairs.count > 0 ? &s->pairs.items[s->pairs.count - 1] : NULL;
        if (last == NULL || last->a != a || last->b != b) {
            s->pairs.items[s->pairs.count++] = (pe_pair){a, b};
        }
        at.manifold->apart = true;
        at.point->impulse = pe_v3(0, 0, 0);
    }
}

static pe_status begin_substeps(substeps *s)
{
    pe_world *world = s->world;
    const pe_islands *islands = s->islands;
    int *bodies = islands->bodies + islands->body_start[s->k];
    int count = islands->body_start[s->k + 1] - islands->body_start[s->k];
    size_t pairs = (size_t)(islands->start[s->k + 1] - islands->start[s->k]);
    s->pairs.items = pe_scratch(world, pairs, sizeof *s->pairs.items);
    s->counts = pe_scratch(world, pairs * PE_MAX_MANIFOLDS, sizeof *s->counts);
    s->free = pe_scratch(world, (size_t)world->slot_count, sizeof *s->free);
    s->poses = pe_scratch(world, (size_t)count, sizeof *s->poses);
    s->twists = pe_scratch(world, (size_t)count, sizeof *s->twists);
    s->ends = pe_scratch(world, (size_t)count, sizeof *s->ends);
    s->island = (pe_islands){
        .count = 1,
        .start = pe_scratch(world, 2, sizeof(int)),
        .manifolds = pe_scratch(world, pairs * PE_MAX_MANIFOLDS, sizeof(int)),
        .body_start = pe_scratch(world, 2, sizeof(int)),
        .bodies = bodies,
        .place = islands->place,
    };
    if (pe_scratch_failed(world)) {
        return pe_fail(s->step->error, PE_NO_MEMORY, "no memory for the impacts of %d bodies",
                       count);
    }
    s->island.start[0] = s->island.start[1] = 0;
    s->island.body_start[0] = 0;
    s->island.body_start[1] = count;
    s->interval = (pe_interval){.islands = &s->island, .free = s->free, .substep = true};
    s->searches_left = most_searches(s);
    take_over_contacts(s);
    return PE_OK;
}

pe_status pe_impact_step(pe_step *step, const pe_islands *islands, int k, pe_path *path)
{
    pe_world *world = step->world;
    substeps s = {
        .step = step,
        .world = world,
        .islands = islands,
        .k = k,
        .left = step->dt,
        .bounces = pe_may_bounce(world, islands, k),
        .may_push = islands->body_start[k + 1] - islands->body_start[k] <= world->def.impact_bodies,
    };
    pe_status status = begin_substeps(&s);
    if (status != PE_OK) {
        return status;
    }
    world->substep_contacts.manifold_count = world->substep_contacts.point_count = 0;
    exchange_lists(world);
    status = run_substeps(&s);
    exchange_lists(world);
    *path = s.interval.path;
    return status;
}
