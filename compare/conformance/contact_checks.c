/* Contacts as they are reported: their bodies, place, normal and separation, and how many there are.
 * Every scene is of spheres without friction, whose contacts follow from their poses. */
#include "plumb/scene.h"
#include "probe.h"

#include <math.h>
#include <string.h>

static const double DT = 1.0 / 100; /* s */
static const double DEPTH = 1e-3;   /* m, of a penetration at the start */
static const pl_vec STILL = {0, 0, 0};

static void begin(pl_probe *p, bool has_gravity)
{
    pl_scene *scene = has_gravity ? pl_probe_scene(p, DT) : pl_probe_floating(p, DT);
    scene->materials[0].friction = 0;
}

static int add_ball(pl_probe *p, pl_vec position, pl_vec velocity)
{
    return pl_probe_add_ball(p, 2, position, velocity);
}

/* ---- What the poses say ---- */

/* The contact of two bodies, one of them a sphere and the other a sphere, a plane, or a slab whose top is
 * z = 0. */
typedef struct contact_truth {
    pl_vec point;  /* in the middle of the gap or the overlap */
    pl_vec normal; /* from the first to the second */
    double separation;
} contact_truth;

static bool is_ball(const pl_probe *p, int body)
{
    return p->scene.bodies[body].shape.kind == PL_SHAPE_SPHERE;
}

/* The point of the plane, or of the top of the slab, that is nearest to `from`. */
static pl_vec foot_on(const pl_probe *p, int ground, pl_vec from)
{
    const pl_shape *shape = &p->scene.bodies[ground].shape;
    const bool is_plane = shape->kind == PL_SHAPE_PLANE;
    const pl_vec normal = is_plane ? pl_vec_of(shape->normal) : (pl_vec){0, 0, 1};
    const double height = pl_vec_dot(normal, from) - (is_plane ? shape->offset : 0);
    return pl_vec_mad(from, -height, normal);
}

static contact_truth truth_of(const pl_probe *p, const pl_body_state *states, int a, int b)
{
    pl_vec from = pl_vec_of(states[a].position), to = pl_vec_of(states[b].position);
    from = is_ball(p, a) ? from : foot_on(p, a, to);
    to = is_ball(p, b) ? to : foot_on(p, b, from);
    const double reach_a = is_ball(p, a) ? PL_BALL_RADIUS : 0;
    const double reach_b = is_ball(p, b) ? PL_BALL_RADIUS : 0;
    const double length = pl_vec_length(pl_vec_sub(to, from));
    const double separation = length - reach_a - reach_b;
    const pl_vec normal = pl_vec_scale(pl_vec_sub(to, from), 1 / length);
    return (contact_truth){.point = pl_vec_mad(from, reach_a + separation / 2, normal),
                           .normal = normal,
                           .separation = separation};
}

/* ---- Bodies ---- */

/* Makes steps until there are contacts, at most three; without any by then, the check fails. */
static void step_to_contact(pl_probe *p)
{
    enum { MOST = 3 };
    for (int n = 0; n < MOST && (n == 0 || p->contact_count == 0); ++n) {
        pl_probe_steps(p, 1);
    }
    pl_probe_require(p, p->contact_count > 0,
                     "read_contacts reports the contact of two bodies that touch, within 3 steps",
                     "no contact",
                     "the engine claims contacts that read_contacts does not have: it is to read "
                     "those that the last step worked with");
}

/* The contact of that index, whose bodies are two of the scene; NULL: there is none, or the check has
 * failed. */
static const pl_contact *contact_at(pl_probe *p, int index)
{
    return index < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[index])
               ? &p->contacts[index]
               : NULL;
}

static bool is_of(const pl_contact *contact, int a, int b)
{
    return (contact->body_a == a && contact->body_b == b) ||
           (contact->body_a == b && contact->body_b == a);
}

/* One sphere of three rests on the floor, which is neither the first body nor the last. */
static void check_bodies(pl_probe *p)
{
    begin(p, true);
    add_ball(p, (pl_vec){0, 0, 20}, STILL);
    const int resting = add_ball(p, (pl_vec){3, 0, PL_BALL_RADIUS - DEPTH}, STILL);
    const int floor = pl_probe_add_floor(p);
    add_ball(p, (pl_vec){-4, 2, 25}, STILL);
    pl_probe_create(p);
    const pl_contact *contact;
    for (int n = 0; n < 10 && !p->over; ++n) {
        n == 0 ? step_to_contact(p) : pl_probe_steps(p, 1);
        for (int i = 0; (contact = contact_at(p, i)) != NULL; ++i) {
            pl_probe_require(
                p, is_of(contact, resting, floor),
                pl_probe_text(p, "contacts of bodies %d and %d, which alone touch", resting, floor),
                pl_probe_text(p, "a contact of bodies %d and %d", contact->body_a, contact->body_b),
                "the engine's number of a body or a shape is taken for the index in the scene");
        }
    }
}

/* Two spheres that do not touch, and neither touches the floor. */
static void check_apart(pl_probe *p)
{
    begin(p, false);
    pl_probe_add_floor(p);
    add_ball(p, (pl_vec){0, 0, 2}, STILL);
    add_ball(p, (pl_vec){1.5, 0, 2}, STILL);
    pl_probe_create(p);
    const bool has_impulses = (p->choice->engine->contacts & PL_CONTACTS_IMPULSES) != 0;
    const pl_contact *contact;
    for (int n = 0; n < 3 && !p->over; ++n) {
        pl_probe_steps(p, 1);
        for (int i = 0; (contact = contact_at(p, i)) != NULL; ++i) {
            const double impulse = has_impulses ? pl_vec_length(pl_vec_of(contact->impulse)) : 0;
            pl_probe_require(
                p, impulse == 0 && contact->separation > 0,
                "bodies that are 0.5 m apart have no contact, or one without impulse and with a "
                "positive separation",
                pl_probe_text(
                    p,
                    "a contact of bodies %d and %d with separation %g m and an impulse of %g N s",
                    contact->body_a, contact->body_b, contact->separation, impulse),
                "contacts of an earlier step or of another instance are left");
        }
    }
}

/* ---- Normals ---- */

static void expect_normals(pl_probe *p, int a, int b, const char *what)
{
    const contact_truth truth = truth_of(p, p->before, a, b);
    const pl_contact *contact;
    for (int i = 0; (contact = contact_at(p, i)) != NULL; ++i) {
        const pl_vec normal = pl_vec_of(contact->normal);
        const pl_vec right = pl_vec_scale(truth.normal, contact->body_a == a ? 1 : -1);
        pl_probe_expect(p, "the length of a contact's normal", pl_vec_length(normal), 1,
                        pl_probe_tolerance(p, 10),
                        "it is not made a unit vector: it is scaled by a depth or an impulse, or "
                        "not set");
        pl_probe_expect_vector(p,
                               pl_probe_text(p, "the normal of a contact of A = %d and B = %d (%s)",
                                             contact->body_a, contact->body_b, what),
                               normal, right, 1e-3,
                               pl_vec_dot(normal, right) < -0.99
                                   ? "it points from B to A; the ABI's points from A to B. Where "
                                     "the adapter swaps the "
                                     "bodies, it has to turn normal and impulse too"
                                   : "the normal is in a body's frame, or of another contact");
    }
}

/* Adds what the first sphere touches, at the origin: a plane, a box or another sphere. */
static int add_other(pl_probe *p, pl_shape_kind kind)
{
    const pl_body slab = {
        .is_static = true, .shape = pl_shape_box(5, 5, 0.5), .position = {0, 0, -0.5}};
    return kind == PL_SHAPE_PLANE ? pl_probe_add_floor(p)
           : kind == PL_SHAPE_BOX ? pl_probe_add_body(p, slab)
                                  : add_ball(p, (pl_vec){0, 0, 0}, STILL);
}

/* A sphere that comes down on the other body, which is the first of the scene or the last. */
static void expect_normals_on(pl_probe *p, pl_shape_kind kind, bool is_last)
{
    static const char *const what[] = {[PL_SHAPE_PLANE] = "a sphere on a plane",
                                       [PL_SHAPE_SPHERE] = "two spheres",
                                       [PL_SHAPE_BOX] = "a sphere on a box"};
    const bool is_sphere = kind == PL_SHAPE_SPHERE;
    const double reach = (is_sphere ? 2 : 1) * PL_BALL_RADIUS - DEPTH;
    const pl_vec along = is_sphere ? (pl_vec){1.0 / 3, 2.0 / 3, 2.0 / 3} : (pl_vec){0, 0, 1};
    begin(p, false);
    int other = is_last ? 0 : add_other(p, kind);
    const int ball = add_ball(p, pl_vec_scale(along, reach), pl_vec_scale(along, -1));
    other = is_last ? add_other(p, kind) : other;
    pl_probe_create(p);
    step_to_contact(p);
    expect_normals(p, other, ball, what[kind]);
}

static void check_normal(pl_probe *p)
{
    const uint32_t claimed = p->choice->engine->capabilities;
    static const pl_shape_kind kinds[] = {PL_SHAPE_SPHERE, PL_SHAPE_PLANE, PL_SHAPE_BOX};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i) {
        if ((claimed & (uint32_t)PL_NEEDS_PLANE << kinds[i]) != 0) {
            expect_normals_on(p, kinds[i], false);
            expect_normals_on(p, kinds[i], true);
        }
    }
}

/* ---- Points and separations ---- */

/* Far from the origin, so that a point in a body's frame is far from the right one. */
static void place_on_floor(pl_probe *p, double separation, pl_vec velocity)
{
    begin(p, false);
    pl_probe_add_floor(p);
    add_ball(p, (pl_vec){1.3, -0.7, PL_BALL_RADIUS + separation}, velocity);
    pl_probe_create(p);
}

/* On a plane that is not level and misses the origin. */
static void place_on_slope(pl_probe *p, double separation)
{
    const pl_vec normal = {0.6, 0, 0.8};
    const double offset = 0.75;
    begin(p, false);
    pl_probe_add_body(p, (pl_body){.is_static = true,
                                   .shape = pl_shape_plane(normal.x, normal.y, normal.z, offset)});
    add_ball(p, pl_vec_mad((pl_vec){0, 2, 0}, offset + PL_BALL_RADIUS + separation, normal), STILL);
    pl_probe_create(p);
}

static void place_pair(pl_probe *p, double separation)
{
    const double reach = 2 * PL_BALL_RADIUS + separation;
    const pl_vec first = {-2, 1, 3}, along = {1.0 / 3, 2.0 / 3, -2.0 / 3};
    begin(p, false);
    add_ball(p, first, STILL);
    add_ball(p, pl_vec_mad(first, reach, along), STILL);
    pl_probe_create(p);
}

static void expect_points(pl_probe *p)
{
    const pl_contact *contact;
    step_to_contact(p);
    const contact_truth truth = truth_of(p, p->before, 0, 1);
    for (int i = 0; (contact = contact_at(p, i)) != NULL; ++i) {
        const pl_vec point = pl_vec_of(contact->point);
        bool is_local = false;
        for (int body = 0; body < 2; ++body) {
            const pl_vec local = pl_vec_sub(truth.point, pl_vec_of(p->before[body].position));
            is_local = is_local || pl_vec_length(pl_vec_sub(point, local)) <= 10 * DEPTH;
        }
        pl_probe_expect_vector(p, "the point of a contact, m", point, truth.point,
                               DEPTH + 1e-3 * PL_BALL_RADIUS,
                               is_local ? "the point is relative to a body: the ABI's is in the "
                                          "world"
                                        : "the point is of another contact, or not set");
    }
}

static void check_point(pl_probe *p)
{
    place_on_slope(p, -DEPTH);
    expect_points(p);
    place_pair(p, -DEPTH);
    expect_points(p);
}

static void expect_separations(pl_probe *p, double tolerance, const char *what)
{
    const double right = truth_of(p, p->before, 0, 1).separation;
    const double after = truth_of(p, p->now, 0, 1).separation;
    const pl_contact *contact;
    for (int i = 0; (contact = contact_at(p, i)) != NULL; ++i) {
        const double found = contact->separation;
        const char *cause = "it is not the distance of the surfaces, or it is not set";
        if (fabs(found + right) <= tolerance) {
            cause = "the sign: a penetration is negative";
        } else if (fabs(found - after) <= tolerance) {
            cause = "contacts are those of the pose after the step: read those that the step "
                    "worked with";
        }
        pl_probe_expect(p, what, found, right, tolerance + pl_probe_tolerance(p, 1), cause);
    }
}

static void check_separation(pl_probe *p)
{
    const double tolerance = 1e-2 * DEPTH;
    place_on_floor(p, -DEPTH, STILL);
    step_to_contact(p);
    expect_separations(p, tolerance, "the separation of a sphere 1 mm deep in a plane, m");
    place_pair(p, -DEPTH);
    step_to_contact(p);
    expect_separations(p, tolerance, "the separation of two spheres 1 mm deep in each other, m");
    /* Contacts of bodies that do not touch yet need not be reported. */
    place_on_floor(p, 2 * DEPTH, STILL);
    pl_probe_steps(p, 1);
    expect_separations(p, tolerance, "the separation of a sphere 2 mm above a plane, m");
}

/* The poses before and after the step differ by far more than the tolerance. */
static void check_before_step(pl_probe *p)
{
    /* Along the plane: contacts that an engine keeps from step to step may be there too. */
    place_on_floor(p, -0.1 * DEPTH, (pl_vec){12, 0, 0});
    const pl_contact *contact;
    for (int n = 0; n < 3 && !p->over; ++n) {
        n == 0 ? step_to_contact(p) : pl_probe_steps(p, 1);
        const double before = p->before[1].position[0], after = p->now[1].position[0];
        double nearest = INFINITY;
        for (int i = 0; (contact = contact_at(p, i)) != NULL; ++i) {
            const double x = contact->point[0];
            nearest = fabs(x - before) < fabs(nearest - before) ? x : nearest;
        }
        if (p->contact_count > 0) {
            pl_probe_expect(
                p, "x of the contact of a sphere that slides by 0.12 m a step, m", nearest, before,
                0.01,
                nearest > before + 0.01 && nearest < after + 0.01
                    ? "it is a place after the step, or of a later sub-step: contacts are "
                      "those of the pose before the step"
                    : "it is of an earlier step, or not in the world");
        }
    }
    /* Away from the plane: a contact without an impulse need not be reported. */
    place_on_floor(p, -DEPTH, (pl_vec){0, 0, 5});
    pl_probe_steps(p, 1);
    expect_separations(p, DEPTH, "the separation, before the step, of a sphere that leaves, m");
}

/* ---- How many ---- */

static void expect_count(pl_probe *p, pl_contact *contacts, int capacity)
{
    const int found =
        p->session.loaded.table.read_contacts(p->session.instance, contacts, capacity);
    pl_probe_expect(p,
                    pl_probe_text(p, "what read_contacts returns for a capacity of %d", capacity),
                    found, p->contact_count, 0,
                    "read_contacts returns how many contacts there are, whatever its capacity, "
                    "and changes nothing");
}

/* Two spheres on the floor, so that there are more contacts than a buffer of one. */
static void check_count(pl_probe *p)
{
    begin(p, true);
    pl_probe_add_floor(p);
    add_ball(p, (pl_vec){0, 0, PL_BALL_RADIUS - DEPTH}, STILL);
    add_ball(p, (pl_vec){2, 0, PL_BALL_RADIUS - DEPTH}, STILL);
    pl_probe_create(p);
    step_to_contact(p);
    if (p->over) {
        return;
    }
    enum { UNTOUCHED = 0x5a };
    pl_contact few[3];
    memset(few, UNTOUCHED, sizeof few);
    expect_count(p, few, 1);
    bool is_untouched = true;
    for (size_t i = sizeof *few; i < sizeof few; ++i) {
        is_untouched = is_untouched && ((const unsigned char *)few)[i] == UNTOUCHED;
    }
    pl_probe_require(p, is_untouched, "read_contacts fills no more contacts than its capacity of 1",
                     "the contact after it was written",
                     "the loop over contacts does not end at the capacity");
    expect_count(p, NULL, 0);
}

enum { SMOOTH = PL_NEEDS_SPHERE | PL_NEEDS_PLANE };

const pl_check pl_contact_checks[] = {
    {"contact-bodies", "contacts are of the bodies that touch", SMOOTH, PL_CONTACTS_POINTS,
     check_bodies, 0},
    {"contact-apart", "bodies that are apart have no contact", SMOOTH, PL_CONTACTS_POINTS,
     check_apart, 0},
    {"contact-normal", "normals have unit length, from A to B", PL_NEEDS_SPHERE, PL_CONTACTS_POINTS,
     check_normal, 0},
    {"contact-point", "points are where the bodies touch", SMOOTH, PL_CONTACTS_POINTS, check_point,
     0},
    {"contact-separation", "a penetration is a negative separation", SMOOTH, PL_CONTACTS_POINTS,
     check_separation, 0},
    {"contact-before-step", "contacts are of the pose before the step", SMOOTH, PL_CONTACTS_POINTS,
     check_before_step, 0},
    {"contact-count", "read_contacts keeps to its capacity", SMOOTH, PL_CONTACTS_POINTS,
     check_count, 0},
    {0}};
