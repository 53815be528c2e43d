/* Metrics of the motion of bodies. All vectors are in the world frame.
 *
 * lift, path_deviation: of the bodies with an expected rest or travel. The supporting plane of a
 * body is the static plane whose normal points most against gravity and along which the body's
 * travel runs. The lift-off height is measured along its normal, from the rest or from the start of
 * the travel, and is 0 for a body below that. The path deviation is measured from the line of the
 * travel through its start, without the part along the normal.
 *
 * settle_time: the first time from which all velocities stay below a threshold for 0.5 s, so that
 * the top of a bounce or the turning point of a swing does not count.
 *
 * drift, creep: of the same bodies, the largest displacement d from a baseline pose and its
 * least-squares slope over time t, both without the part along the travel. The baseline is the pose
 * at settle_time, which is known only 0.5 s later. So two measurements run: one restarts whenever
 * the scene becomes quiet, and is final once the scene has settled; the other starts at 1 s (or
 * half the duration), and is used if the scene never settles. In a scene that expects nothing of any
 * body, all dynamic ones are followed once it has settled, and before that there is no drift. The
 * slope is
 *
 *   sum (t - mean t)(d - mean d) / sum (t - mean t)^2
 *
 * with both sums updated in one pass, so that no large numbers are subtracted from each other.
 * Source: Welford 1962, with the cross sum updated like the sum of squares.
 *
 * spread_x, spread_y, mass_height, run_out_p95: of the final centres of mass of the dynamic bodies.
 * Ensembles of chaotic scenes are compared by them. The percentile is interpolated between two
 * order statistics (Hyndman and Fan 1996, definition 7). */
#include "base/statistics.h"
#include "modules.h"
#include "referee/geometry/solid.h"

/* Tolerance of scene checks of unit vectors. */
static const double PARALLEL = 1e-9;

static const double QUIET_SPEED = 1e-3; /* m/s */
static const double QUIET_SPIN = 1e-3;  /* rad/s */
static const double HOLD = 0.5;         /* s */

/* Sums over the samples since a baseline, of one body. */
typedef struct track {
    pl_vec baseline;
    pl_vec mean;
    pl_vec cross; /* sum of (t - mean t)(d - mean d) */
} track;

/* The measurements of drift. */
enum { SINCE_QUIET, SINCE_FIXED, SINCE_COUNT };

/* A body that the scene expects to rest or to travel. */
typedef struct followed {
    int body;
    pl_vec origin; /* the rest, or the start of the travel */
    pl_vec along;  /* of its travel; null if it should rest */
    pl_vec normal; /* of its supporting plane; null if it has none */
    bool is_again; /* one before is of the same body, and has its drift */
    track tracks[SINCE_COUNT];
} followed;

typedef struct drift {
    long samples;
    double start;                  /* s */
    double mean_time, square_time; /* of t since the start, and the sum of squares about it */
    double largest;                /* m */
} drift;

typedef struct motion {
    const pl_scene *scene;
    followed *followed; /* (followed_count): travels first */
    int followed_count;
    bool supported;       /* any of them has a supporting plane */
    bool follows_settled; /* they are all dynamic bodies, from where they settle */

    long hold;        /* steps in 0.5 s */
    long quiet_since; /* first step of the current quiet period; -1 while something moves */
    bool settled;     /* the quiet period has lasted 0.5 s, and quiet_since is final */
    drift drifts[SINCE_COUNT];
    long fixed_step; /* where SINCE_FIXED begins */

    int dynamic_count;
    pl_vec *start;   /* (body_count): centres of mass */
    double *run_out; /* (dynamic_count), m */
} motion;

/* ---- Bodies with a reference ---- */

/* The normal of the supporting plane of a body that moves along `along`, or null. */
static pl_vec supporting_normal(const pl_scene *scene, pl_vec along)
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

static void follow(motion *m, bool *seen, const followed *body)
{
    followed *added = &m->followed[m->followed_count++];
    *added = *body;
    added->is_again = seen[body->body];
    seen[body->body] = true;
    m->supported = m->supported || pl_vec_length(body->normal) > 0;
}

static void follow_all(motion *m, bool *seen)
{
    const pl_scene *scene = m->scene;
    const pl_vec still = {0, 0, 0}, normal = supporting_normal(scene, still);
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        pl_vec along = pl_vec_of(travel->direction);
        follow(m, seen,
               &(followed){.body = travel->body,
                           .origin = pl_vec_of(scene->bodies[travel->body].position),
                           .along = along,
                           .normal = supporting_normal(scene, along)});
    }
    for (int i = 0; i < scene->rest_count; ++i) {
        follow(m, seen,
               &(followed){.body = scene->rests[i].body,
                           .origin = pl_vec_of(scene->rests[i].position),
                           .along = still,
                           .normal = normal});
    }
    for (int i = 0; i < scene->body_count && m->follows_settled; ++i) {
        if (!scene->bodies[i].is_static) {
            m->followed[m->followed_count++] = (followed){.body = i};
        }
    }
}

static void *create(const pl_run_view *view, pl_arena *arena)
{
    const pl_scene *scene = view->scene;
    motion *m = pl_arena_take(arena, 1, sizeof *m);
    const size_t expected = (size_t)scene->travel_count + (size_t)scene->rest_count;
    m->scene = scene;
    m->dynamic_count = view->scale.dynamic_count;
    m->follows_settled = expected + (size_t)scene->value_count == 0;
    m->followed = pl_arena_take(arena, m->follows_settled ? (size_t)m->dynamic_count : expected,
                                sizeof *m->followed);
    m->start = pl_arena_take(arena, (size_t)scene->body_count, sizeof *m->start);
    m->run_out = pl_arena_take(arena, (size_t)m->dynamic_count, sizeof *m->run_out);
    /* The small number keeps a whole number of steps from being rounded up. */
    m->hold = (long)ceil(HOLD / scene->dt - 1e-6);
    m->quiet_since = -1;
    m->fixed_step = lround(fmin(1, scene->duration / 2) / scene->dt);
    follow_all(m, pl_arena_take(arena, (size_t)scene->body_count, sizeof(bool)));
    view->series[PL_METRIC_LIFT]->applies = m->supported;
    view->series[PL_METRIC_PATH_DEVIATION]->applies = scene->travel_count > 0;
    return m;
}

static pl_vec displacement(const followed *f, const pl_body_state *bodies)
{
    return pl_vec_sub(pl_vec_of(bodies[f->body].position), f->origin);
}

static double lift_of(const motion *m, const pl_body_state *bodies)
{
    double highest = 0;
    for (int i = 0; i < m->followed_count; ++i) {
        const followed *f = &m->followed[i];
        highest = fmax(highest, pl_vec_dot(displacement(f, bodies), f->normal));
    }
    return highest;
}

static double deviation_of(const motion *m, const pl_body_state *bodies)
{
    double farthest = 0;
    for (int i = 0; i < m->scene->travel_count; ++i) {
        const followed *f = &m->followed[i];
        pl_vec off = pl_vec_reject(displacement(f, bodies), f->along);
        farthest = fmax(farthest, pl_vec_length(pl_vec_reject(off, f->normal)));
    }
    return farthest;
}

/* ---- Drift and settling ---- */

/* Takes these poses at `time` (s) as the baseline and the first sample. */
static void begin_drift(motion *m, int since, double time, const pl_body_state *bodies)
{
    m->drifts[since] = (drift){.samples = 1, .start = time};
    for (int i = 0; i < m->followed_count; ++i) {
        followed *f = &m->followed[i];
        f->tracks[since] = (track){.baseline = pl_vec_of(bodies[f->body].position)};
    }
}

/* Takes one more sample, at a later time than the last. */
static void add_drift(motion *m, int since, double time, const pl_body_state *bodies)
{
    drift *d = &m->drifts[since];
    double t = time - d->start;
    double n = (double)++d->samples;
    double off_mean = t - d->mean_time; /* from the mean of the samples before */
    d->mean_time += off_mean / n;
    d->square_time += off_mean * (t - d->mean_time);
    for (int i = 0; i < m->followed_count; ++i) {
        followed *f = &m->followed[i];
        track *b = &f->tracks[since];
        if (f->is_again) {
            continue;
        }
        pl_vec off = pl_vec_sub(pl_vec_of(bodies[f->body].position), b->baseline);
        off = pl_vec_mad(off, -pl_vec_dot(off, f->along), f->along);
        d->largest = fmax(d->largest, pl_vec_length(off));
        b->mean = pl_vec_mad(b->mean, 1 / n, pl_vec_sub(off, b->mean));
        b->cross = pl_vec_mad(b->cross, off_mean, pl_vec_sub(off, b->mean));
    }
}

static bool all_quiet(const pl_scene *scene, const pl_body_state *bodies)
{
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static &&
            !(pl_vec_length(pl_vec_of(bodies[i].velocity)) < QUIET_SPEED &&
              pl_vec_length(pl_vec_of(bodies[i].angular_velocity)) < QUIET_SPIN)) {
            return false;
        }
    }
    return true;
}

/* Updates the quiet period. True when it begins with this step. */
static bool see_quiet(motion *m, long step, const pl_body_state *bodies)
{
    if (m->settled) {
        return false;
    }
    if (!all_quiet(m->scene, bodies)) {
        m->quiet_since = -1;
        return false;
    }
    bool begins = m->quiet_since < 0;
    if (begins) {
        m->quiet_since = step;
    }
    m->settled = step - m->quiet_since >= m->hold;
    return begins;
}

static pl_metric settle_metric(const motion *m, long steps)
{
    if (m->scene->travel_count > 0 || m->scene->value_count > 0) {
        return (pl_metric){0};
    }
    return m->settled ? pl_metric_value((double)m->quiet_since * m->scene->dt)
                      : pl_metric_failed("never below 1 mm/s and 1 mrad/s for 0.5 s in %.6g s",
                                         (double)steps * m->scene->dt);
}

static void drift_metrics(const motion *m, pl_metric *item)
{
    const int since = m->settled ? SINCE_QUIET : SINCE_FIXED;
    const drift *d = &m->drifts[since];
    if (m->followed_count == 0) {
        return;
    }
    if (since == SINCE_FIXED && m->follows_settled) {
        item[PL_METRIC_DRIFT] = pl_metric_failed("the bodies did not come to rest");
    } else if (d->samples < 2) {
        item[PL_METRIC_DRIFT] =
            pl_metric_failed("the run has no frame after step %ld", m->fixed_step);
    } else {
        item[PL_METRIC_DRIFT] = pl_metric_value(d->largest);
    }
    item[PL_METRIC_CREEP] = item[PL_METRIC_DRIFT];
    if (item[PL_METRIC_CREEP].state == PL_METRIC_VALUE) {
        double fastest = 0;
        for (int i = 0; i < m->followed_count; ++i) {
            const double cross = pl_vec_length(m->followed[i].tracks[since].cross);
            fastest = fmax(fastest, cross / d->square_time);
        }
        item[PL_METRIC_CREEP] = pl_metric_value(fastest);
    }
}

/* ---- Spread ---- */

static pl_vec centre_of(const motion *m, const pl_body_state *bodies, int body)
{
    return pl_state_centre(&m->scene->bodies[body], &bodies[body]);
}

/* Standard deviation of the last centres along `axis`, m. The mean comes first, so that nothing
 * cancels. */
static double deviation_along(const motion *m, const pl_body_state *last, pl_vec axis)
{
    double mean = 0, square = 0;
    for (int i = 0; i < m->scene->body_count; ++i) {
        if (!m->scene->bodies[i].is_static) {
            mean += pl_vec_dot(centre_of(m, last, i), axis) / m->dynamic_count;
        }
    }
    for (int i = 0; i < m->scene->body_count; ++i) {
        if (!m->scene->bodies[i].is_static) {
            const double d = pl_vec_dot(centre_of(m, last, i), axis) - mean;
            square += d * d / m->dynamic_count;
        }
    }
    return sqrt(square);
}

static double mass_height(const motion *m, const pl_body_state *last, pl_vec up)
{
    double mass = 0, moment = 0;
    for (int i = 0; i < m->scene->body_count; ++i) {
        const pl_body *body = &m->scene->bodies[i];
        if (!body->is_static) {
            mass += body->mass;
            moment += body->mass * pl_vec_dot(centre_of(m, last, i), up);
        }
    }
    return moment / mass;
}

static double run_out(motion *m, const pl_body_state *last, pl_vec up)
{
    int count = 0;
    for (int i = 0; i < m->scene->body_count; ++i) {
        if (!m->scene->bodies[i].is_static) {
            const pl_vec moved = pl_vec_sub(centre_of(m, last, i), m->start[i]);
            m->run_out[count++] = pl_vec_length(pl_vec_reject(moved, up));
        }
    }
    pl_sort_numbers(m->run_out, count);
    return pl_quantile(m->run_out, count, 0.95);
}

static void spread_metrics(motion *m, const pl_body_state *last, pl_metric *item)
{
    pl_vec g = pl_vec_of(m->scene->gravity);
    double strength = pl_vec_length(g);
    pl_vec up = strength > 0 ? pl_vec_scale(g, -1 / strength) : (pl_vec){0, 0, 0};
    if (m->dynamic_count > 1) {
        item[PL_METRIC_SPREAD_X] = pl_metric_value(deviation_along(m, last, (pl_vec){1, 0, 0}));
        item[PL_METRIC_SPREAD_Y] = pl_metric_value(deviation_along(m, last, (pl_vec){0, 1, 0}));
    }
    item[PL_METRIC_RUN_OUT_P95] = pl_metric_value(run_out(m, last, up));
    if (strength > 0) {
        item[PL_METRIC_MASS_HEIGHT] = pl_metric_value(mass_height(m, last, up));
    }
}

/* ---- All ---- */

static void see(void *state, const pl_run_view *view)
{
    motion *m = state;
    const long step = view->step.number;
    const pl_body_state *bodies = view->step.after;
    double time = (double)step * m->scene->dt;
    for (int i = 0; i < m->scene->body_count && step == 0; ++i) {
        m->start[i] = centre_of(m, bodies, i);
    }
    if (step > 0 && m->supported) {
        pl_see_value(view, PL_METRIC_LIFT, lift_of(m, bodies));
    }
    if (step > 0 && m->scene->travel_count > 0) {
        pl_see_value(view, PL_METRIC_PATH_DEVIATION, deviation_of(m, bodies));
    }
    if (see_quiet(m, step, bodies)) {
        begin_drift(m, SINCE_QUIET, time, bodies);
    } else if (m->quiet_since >= 0) {
        add_drift(m, SINCE_QUIET, time, bodies);
    }
    if (step == m->fixed_step) {
        begin_drift(m, SINCE_FIXED, time, bodies);
    } else if (step > m->fixed_step && !m->follows_settled) {
        add_drift(m, SINCE_FIXED, time, bodies);
    }
}

static void collect(void *state, const pl_run_view *view, pl_metric *item)
{
    motion *m = state;
    item[PL_METRIC_SETTLE_TIME] = settle_metric(m, view->step.number);
    drift_metrics(m, item);
    spread_metrics(m, view->last, item);
}

const pl_module pl_motion_module = {create, see, collect, .sees_start = true};
