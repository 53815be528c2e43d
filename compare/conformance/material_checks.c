/* Friction and restitution of each pair of materials, by what the bodies do. A sphere's friction is
 * the ratio of the two parts of the impulse that its motion shows, and its restitution the ratio of
 * its normal speeds: both are exact for every engine, whatever its solver, its steps inside a step
 * and its correction of positions. */
#include "plumb/scene.h"
#include "probe.h"

#include <math.h>
#include <string.h>

/* 0.1 %, for every engine: what the harness promises about friction and restitution. */
static const double SHARE = 1e-3;

static const double DT = 1.0 / 240;  /* s */
static const double SPACING = 3;     /* m, between spheres that do not meet */
static const double SPEED = 2;       /* m/s, of an impact */
static const double TOP = 40;        /* m, where the sphere that falls freely starts */
enum { PAIR_COUNT = 3, STEPS = 60 }; /* a quarter of a second */

/* The materials of these scenes. GROUND meets each of the three. With RUBBER it has coefficients of
 * its own: not the product, the least, the largest, a mean of the two, nor those of one of them. */
enum { UNUSED, GROUND, RUBBER, WOOD };
static const int PARTNERS[PAIR_COUNT] = {RUBBER, WOOD, GROUND};

/* Which of the coefficients are not zero. The scenes of one are without the other. */
typedef enum coefficient_kind { FRICTION = 1, RESTITUTION = 2 } coefficient_kind;

static void begin(pl_probe *p, int kinds, bool has_gravity)
{
    const double friction = (kinds & FRICTION) != 0, bounce = (kinds & RESTITUTION) != 0;
    pl_scene *scene = has_gravity ? pl_probe_scene(p, DT) : pl_probe_floating(p, DT);
    pl_error error = {.message = ""};
    pl_probe_add_material(p, 0.2 * friction, 0.3 * bounce);
    pl_probe_add_material(p, 0.8 * friction, 0.9 * bounce);
    pl_probe_add_material(p, 0.45 * friction, 0.4 * bounce);
    const pl_material_pair pair = {.material_a = RUBBER,
                                   .material_b = GROUND,
                                   .friction = 0.35 * friction,
                                   .restitution = 0.5 * bounce};
    pl_probe_expect_made(p, pl_scene_add_pair(scene, &pair, &error), &error);
}

/* The static ground whose top is z = 0: a plane or a wide slab. */
static int add_ground(pl_probe *p, pl_shape_kind kind)
{
    pl_body ground = {.is_static = true, .material = GROUND, .shape = pl_shape_plane(0, 0, 1, 0)};
    if (kind == PL_SHAPE_BOX) {
        ground.shape = pl_shape_box(20, 20, 0.5);
        ground.position[2] = -0.5;
    }
    return pl_probe_add_body(p, ground);
}

static pl_body ball(int material, double mass, double x, double y, double z)
{
    return (pl_body){.shape = pl_shape_sphere(PL_BALL_RADIUS),
                     .material = material,
                     .mass = mass,
                     .position = {x, y, z}};
}

/* ---- What was measured ---- */

/* One coefficient of one pair of bodies. */
typedef struct coefficient {
    const char *name; /* "friction", "restitution" */
    int body_a, body_b;
    double own_a, own_b; /* of each material by itself */
    double asked, found;
    const char *how; /* it was measured */
} coefficient;

static coefficient coefficient_of(const pl_probe *p, coefficient_kind kind, int body_a, int body_b,
                                  double found, const char *how)
{
    const pl_scene *scene = &p->scene;
    const int a = scene->bodies[body_a].material, b = scene->bodies[body_b].material;
    const pl_material *own_a = &scene->materials[a], *own_b = &scene->materials[b];
    double friction = NAN, restitution = NAN;
    pl_scene_pair(scene, a, b, &friction, &restitution);
    const bool is_friction = kind == FRICTION;
    return (coefficient){.name = is_friction ? "friction" : "restitution",
                         .body_a = body_a,
                         .body_b = body_b,
                         .own_a = is_friction ? own_a->friction : own_a->restitution,
                         .own_b = is_friction ? own_b->friction : own_b->restitution,
                         .asked = is_friction ? friction : restitution,
                         .found = found,
                         .how = how};
}

static double error_of(const coefficient *c)
{
    const double error = fabs(c->found / c->asked - 1);
    return isnan(error) ? (double)INFINITY : error;
}

static bool is_about(double found, double value)
{
    return fabs(found - value) <= 3 * SHARE * fabs(value);
}

/* What usually makes this of the coefficient that was asked for. */
static const char *cause_of(const coefficient *c)
{
    const double a = c->own_a, b = c->own_b;
    const struct {
        double value;
        const char *cause;
    } known[] = {
        {a * b, "the product of the two materials' own coefficients: take those of pl_setup_pair"},
        {fmin(a, b), "the smaller of the two materials' own coefficients, not that of "
                     "pl_setup_pair"},
        {fmax(a, b), "the larger of the two materials' own coefficients, not that of "
                     "pl_setup_pair"},
        {(a + b) / 2, "the mean of the two materials' own coefficients, not that of pl_setup_pair"},
        {sqrt(a * b), "the geometric mean of the two materials' own coefficients: the scene has "
                      "another for this pair, which pl_setup_pair gives"},
        {c->asked * sqrt(2), "a friction pyramid whose edge, not its face, has the coefficient"},
        {c->asked * sqrt(0.5), "a friction pyramid whose edge, not its face, has the coefficient"},
        {c->asked * 2, "twice the coefficient"},
        {c->asked / 2, "half the coefficient"},
        {-c->asked, "the sign of the impulse"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i) {
        if (is_about(c->found, known[i].value)) {
            return known[i].cause;
        }
    }
    if (isnan(c->found)) {
        return "contacts are not made, or bodies do not begin with the scene's velocities";
    }
    if (fabs(c->found) < SHARE) {
        return "the coefficient does not reach the engine";
    }
    return fabs(c->found / c->asked - 1) < 0.1
               ? "the coefficient is scaled on its way into the engine, or the solver stops before "
                 "it has converged"
               : "the coefficient is that of another pair, or the solver stops before it has "
                 "converged";
}

static void judge(pl_probe *p, const coefficient *c)
{
    pl_probe_require(p, error_of(c) <= SHARE,
                     pl_probe_text(p, "%s of bodies %d and %d, %s: %.6g, to 0.1 %%", c->name,
                                   c->body_a, c->body_b, c->how, c->asked),
                     isnan(c->found) ? "the two bodies do not push on each other"
                                     : pl_probe_text(p, "%.6g, which is %.4g times that", c->found,
                                                     c->found / c->asked),
                     cause_of(c));
}

/* Keeps the coefficient that is nearest to that asked for. */
static void keep_better(coefficient *best, const coefficient *found)
{
    if (best->name == NULL || error_of(found) < error_of(best)) {
        *best = *found;
    }
}

/* ---- Friction on the ground ---- */

/* Spheres that slide along an axis of the world and spin backward so fast that they do not roll within the
 * run. Another one falls freely: it measures gravity times time, so that only friction counts. The ground is
 * the first of the bodies or the last. Keeps what is nearer to what was asked. */
static void measure_slide(pl_probe *p, bool ground_is_last, int axis, coefficient best[PAIR_COUNT])
{
    const pl_shape_kind kind = (pl_shape_kind)p->check->variant;
    begin(p, FRICTION, true);
    int ground = ground_is_last ? 0 : add_ground(p, kind);
    const int first = p->scene.body_count;
    for (int i = 0; i < PAIR_COUNT; ++i) {
        pl_body body = ball(PARTNERS[i], 2, 0, 0, PL_BALL_RADIUS);
        body.position[1 - axis] = SPACING * (i - 1);
        body.velocity[axis] = 6;
        body.angular_velocity[1 - axis] = axis == 0 ? -30 : 30;
        pl_probe_add_body(p, body);
    }
    pl_body above = ball(WOOD, 2, 0, 0, TOP);
    above.velocity[axis] = 6;
    const int falling = pl_probe_add_body(p, above);
    ground = ground_is_last ? add_ground(p, kind) : ground;
    pl_probe_run(p, STEPS);
    pl_body_state from[PL_PROBE_MOST_BODIES];
    memcpy(from, p->now, sizeof from);
    pl_probe_steps(p, STEPS);
    const double fallen = p->now[falling].velocity[2] - from[falling].velocity[2];
    const double slowed = from[falling].velocity[axis] - p->now[falling].velocity[axis];
    for (int i = first; i < first + PAIR_COUNT; ++i) {
        const double normal = p->now[i].velocity[2] - from[i].velocity[2] - fallen;
        const double along = from[i].velocity[axis] - p->now[i].velocity[axis] - slowed;
        const coefficient found = coefficient_of(
            p, FRICTION, ground, i, normal > 0.1 * fabs(fallen) ? along / normal : (double)NAN,
            axis == 0 ? "sliding along x" : "sliding along y");
        keep_better(&best[i - first], &found);
    }
}

/* On ground of the shape of the check's variant. */
static void check_friction(pl_probe *p)
{
    for (int order = 0; order < 2 && !p->over; ++order) {
        coefficient best[PAIR_COUNT] = {{.name = NULL}};
        /* A pyramid whose axes are not the world's is met by one of the two. */
        for (int axis = 0; axis < 2 && !p->over; ++axis) {
            measure_slide(p, order == 1, axis, best);
        }
        for (int i = 0; i < PAIR_COUNT && !p->over; ++i) {
            judge(p, &best[i]);
        }
    }
}

/* ---- Friction of two moving spheres ---- */

/* A light sphere that spins meets a heavy one. The impulse on it, step by step, in parts along and
 * across the line of centres of the pose before the step. */
static coefficient measure_graze(pl_probe *p, const int materials[2], int across)
{
    begin(p, FRICTION, false);
    pl_body light = ball(materials[0], 1, 0, 0, 1), heavy = ball(materials[1], 3, 1, 0, 1);
    light.velocity[0] = SPEED;
    light.angular_velocity[3 - across] = across == 1 ? 30 : -30;
    pl_probe_add_body(p, light);
    pl_probe_add_body(p, heavy);
    pl_probe_create(p);
    double normal = 0, along = 0;
    for (int n = 0; n < 10; ++n) {
        pl_probe_steps(p, 1);
        const double *a = p->before[0].position, *b = p->before[1].position;
        const double x = b[0] - a[0], y = b[across] - a[across], length = hypot(x, y);
        const double change_x = p->before[0].velocity[0] - p->now[0].velocity[0];
        const double change_y = p->before[0].velocity[across] - p->now[0].velocity[across];
        normal += (change_x * x + change_y * y) / length;
        along += (change_y * x - change_x * y) / length;
    }
    return coefficient_of(p, FRICTION, 0, 1, normal > 0.1 * SPEED ? along / normal : (double)NAN,
                          "two spheres, and one of them spins");
}

static void check_friction_spheres(pl_probe *p)
{
    for (int order = 0; order < 2 && !p->over; ++order) {
        const int materials[] = {order == 0 ? GROUND : RUBBER, order == 0 ? RUBBER : GROUND};
        coefficient best = measure_graze(p, materials, 1);
        const coefficient other = measure_graze(p, materials, 2);
        keep_better(&best, &other);
        judge(p, &best);
    }
}

/* ---- Restitution ---- */

/* The speed below which impacts do not bounce: the value of that option; 0 without it. m/s. */
static double threshold_of(const pl_engine_choice *choice)
{
    const int option = pl_engine_option_index(choice->engine, "restitution_threshold");
    return option < 0 ? 0 : choice->values[option];
}

/* m/s, of an impact that bounces. */
static double speed_of(const pl_probe *p)
{
    return fmax(SPEED, 1.5 * threshold_of(p->choice));
}

/* How far a body starts from what it hits, in its ways of a step. What is nearest to that asked is kept:
 * engines whose contacts hold a body back that would touch only within the step swallow a part of the
 * bounce for some gaps, and engines without such contacts hit at any. */
static const double GAPS[] = {0, 0.3, 0.7};
enum { GAP_COUNT = sizeof GAPS / sizeof *GAPS };

/* Spheres of the first `count` partners' materials that fall on the ground at once, without gravity. */
static void measure_impacts(pl_probe *p, bool ground_is_last, int count, double speed, double gap,
                            coefficient best[])
{
    begin(p, RESTITUTION, false);
    int ground = ground_is_last ? 0 : add_ground(p, PL_SHAPE_PLANE);
    const int first = p->scene.body_count;
    for (int i = 0; i < count; ++i) {
        pl_body body = ball(PARTNERS[i], 1 + i, SPACING * i, 0, PL_BALL_RADIUS + gap * speed * DT);
        body.velocity[2] = -speed;
        pl_probe_add_body(p, body);
    }
    ground = ground_is_last ? add_ground(p, PL_SHAPE_PLANE) : ground;
    pl_probe_run(p, 20);
    for (int i = 0; i < count; ++i) {
        const coefficient found =
            coefficient_of(p, RESTITUTION, ground, first + i, p->now[first + i].velocity[2] / speed,
                           "falling on a plane");
        keep_better(&best[i], &found);
    }
}

/* Three pairs of spheres, of 1 kg that moves and 3 kg that rests. */
static void measure_collisions(pl_probe *p, bool light_is_last, double speed, double gap,
                               coefficient best[PAIR_COUNT])
{
    begin(p, RESTITUTION, false);
    for (int i = 0; i < PAIR_COUNT; ++i) {
        pl_body light = ball(GROUND, 1, -gap * speed * DT, SPACING * i, 1);
        const pl_body heavy = ball(PARTNERS[i], 3, 2 * PL_BALL_RADIUS, SPACING * i, 1);
        light.velocity[0] = speed;
        pl_probe_add_body(p, light_is_last ? heavy : light);
        pl_probe_add_body(p, light_is_last ? light : heavy);
    }
    pl_probe_run(p, 20);
    for (int i = 0; i < PAIR_COUNT; ++i) {
        const int light = 2 * i + (light_is_last ? 1 : 0), heavy = 4 * i + 1 - light;
        const double apart = p->now[heavy].velocity[0] - p->now[light].velocity[0];
        const coefficient found = coefficient_of(p, RESTITUTION, light, heavy, apart / speed,
                                                 "a sphere of 1 kg hits one of 3 kg");
        keep_better(&best[i], &found);
    }
}

/* Of two spheres where the check's variant is one, else of a sphere and a plane. */
static void check_restitution(pl_probe *p)
{
    const double speed = speed_of(p);
    for (int order = 0; order < 2 && !p->over; ++order) {
        coefficient best[PAIR_COUNT] = {{.name = NULL}};
        for (int g = 0; g < GAP_COUNT && !p->over; ++g) {
            if (p->check->variant == PL_SHAPE_SPHERE) {
                measure_collisions(p, order == 1, speed, GAPS[g], best);
            } else {
                measure_impacts(p, order == 1, PAIR_COUNT, speed, GAPS[g], best);
            }
        }
        for (int i = 0; i < PAIR_COUNT && !p->over; ++i) {
            judge(p, &best[i]);
        }
    }
}

/* The speed below which impacts do not bounce. Each impact has a scene of its own, in which nothing is
 * faster. */
static void check_restitution_threshold(pl_probe *p)
{
    const double threshold = threshold_of(p->choice);
    const double speeds[] = {fmax(1.5, 1.5 * threshold), 1.01 * threshold, 0.05, 0.3, 0.7};
    bool fast_bounces = false;
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds && !p->over; ++i) {
        if (speeds[i] <= threshold) {
            continue;
        }
        coefficient c = {.name = NULL};
        for (int g = 0; g < GAP_COUNT && !p->over; ++g) {
            measure_impacts(p, false, 1, speeds[i], GAPS[g], &c);
        }
        pl_probe_require(
            p, error_of(&c) <= SHARE,
            pl_probe_text(p,
                          "an impact at %g m/s bounces at %.6g of its speed, to 0.1 %% "
                          "(restitution_threshold is %g m/s)",
                          speeds[i], c.asked, threshold),
            pl_probe_text(p, "%.6g of its speed", c.found),
            fast_bounces ? "the engine has a threshold of restitution above that speed: set "
                           "it to 0, or make it the option restitution_threshold"
                         : cause_of(&c));
        fast_bounces = true;
    }
}

/* ---- What is read back ---- */

static void expect_pair(pl_probe *p, int a, int b)
{
    const pl_pair_coefficients found = pl_session_read_pair(&p->session, a, b);
    const coefficient_kind kinds[] = {FRICTION, RESTITUTION};
    const double values[] = {found.friction, found.restitution};
    for (int i = 0; i < 2; ++i) {
        const coefficient asked = coefficient_of(p, kinds[i], a, b, values[i], NULL);
        if (!isnan(values[i])) {
            pl_probe_expect(
                p, pl_probe_text(p, "the %s of bodies %d and %d in read_pair", asked.name, a, b),
                values[i], asked.asked, pl_probe_tolerance(p, 1),
                "read_pair is of other materials, or the engine has another value");
        }
    }
}

static void check_read_pair(pl_probe *p)
{
    if (!p->choice->engine->reads_pairs) {
        pl_probe_skip(p, "the engine does not read coefficients back");
        return;
    }
    const uint32_t claimed = p->choice->engine->capabilities;
    const bool has_friction =
        (claimed & PL_NEEDS_FRICTION) != 0 && (claimed & PL_NEEDS_ROTATION) != 0;
    begin(p,
          (has_friction ? FRICTION : 0) | ((claimed & PL_NEEDS_RESTITUTION) != 0 ? RESTITUTION : 0),
          true);
    add_ground(p, PL_SHAPE_PLANE);
    for (int i = 0; i < PAIR_COUNT; ++i) {
        pl_probe_add_body(p, ball(PARTNERS[i], 1, SPACING * i, 0, PL_BALL_RADIUS));
    }
    pl_probe_create(p);
    for (int a = 0; a <= PAIR_COUNT && !p->over; ++a) {
        for (int b = 0; b <= PAIR_COUNT && !p->over; ++b) {
            if (a != b) {
                expect_pair(p, a, b);
            }
        }
    }
}

enum {
    SMOOTH = PL_NEEDS_SPHERE | PL_NEEDS_PLANE,
    SLIDING = PL_NEEDS_SPHERE | PL_NEEDS_FRICTION | PL_NEEDS_ROTATION
};

const pl_check pl_material_checks[] = {
    {"friction", "spheres slide on a plane by their pairs' friction", SLIDING | PL_NEEDS_PLANE, 0,
     check_friction, PL_SHAPE_PLANE},
    {"friction-box", "spheres slide on a box by their pairs' friction", SLIDING | PL_NEEDS_BOX, 0,
     check_friction, PL_SHAPE_BOX},
    {"friction-spheres", "two spheres that meet have their pair's friction", SLIDING, 0,
     check_friction_spheres, 0},
    {"restitution", "spheres bounce off a plane by their pairs' restitution",
     SMOOTH | PL_NEEDS_RESTITUTION, 0, check_restitution, PL_SHAPE_PLANE},
    {"restitution-spheres", "two spheres bounce by their pair's restitution",
     PL_NEEDS_SPHERE | PL_NEEDS_RESTITUTION, 0, check_restitution, PL_SHAPE_SPHERE},
    {"restitution-threshold", "slow impacts bounce too", SMOOTH | PL_NEEDS_RESTITUTION, 0,
     check_restitution_threshold, 0},
    {"read-pair", "a pair's coefficients read back", SMOOTH, 0, check_read_pair, 0},
    {0}};
