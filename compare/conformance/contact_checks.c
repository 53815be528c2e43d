/* Contacts as they are reported: their bodies, place, normal and separation, and how many there are.
 * Every scene is of spheres without friction, whose contacts follow from their poses. */
#include "plumb/scene.h"
#include "probe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double RADIUS = 0.5;   /* m, of every sphere */
static const double DT = 1.0 / 100; /* s */
static const double DEPTH = 1e-3;   /* m, of a penetration at the start */

static void begin(pl_probe *p, bool has_gravity)
{
    pl_scene *scene = pl_probe_scene(p, DT);
    scene->materials[0].friction = 0;
    if (!has_gravity) {
        memset(scene->gravity, 0, sizeof scene->gravity);
    }
}

static int add_ball(pl_probe *p, const double position[3], const double velocity[3])
{
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(RADIUS);
    ball.mass = 2;
    memcpy(ball.position, position, sizeof ball.position);
    memcpy(ball.velocity, velocity, sizeof ball.velocity);
    return pl_probe_add_body(p, ball);
}

static int add_slab(pl_probe *p)
{
    pl_body slab = pl_body_default();
    slab.is_static = true;
    slab.shape = pl_shape_box(5, 5, 0.5);
    slab.position[2] = -0.5;
    return pl_probe_add_body(p, slab);
}

/* ---- What the poses say ---- */

/* The contact of two bodies, one of them a sphere and the other a sphere, a plane, or the slab, whose
 * top is z = 0. */
typedef struct contact_truth {
    double point[3];  /* in the middle of the gap or the overlap */
    double normal[3]; /* from the first to the second */
    double separation;
} contact_truth;

static bool is_ball(const pl_probe *p, int body)
{
    return p->scene.bodies[body].shape.kind == PL_SHAPE_SPHERE;
}

/* The point of the plane, or of the top of the slab, that is nearest to `from`. */
static void foot_on(const pl_probe *p, int ground, const double from[3], double foot[3])
{
    const pl_shape *shape = &p->scene.bodies[ground].shape;
    const bool is_plane = shape->kind == PL_SHAPE_PLANE;
    const double up[3] = {0, 0, 1}, *normal = is_plane ? shape->normal : up;
    double height = is_plane ? -shape->offset : 0;
    for (int k = 0; k < 3; ++k) {
        height += normal[k] * from[k];
    }
    for (int k = 0; k < 3; ++k) {
        foot[k] = from[k] - height * normal[k];
    }
}

static contact_truth truth_of(const pl_probe *p, const pl_body_state *states, int a, int b)
{
    contact_truth truth = {.separation = 0};
    double from[3], to[3], length = 0;
    memcpy(from, states[a].position, sizeof from);
    memcpy(to, states[b].position, sizeof to);
    double reach_a = RADIUS, reach_b = RADIUS;
    if (!is_ball(p, a)) {
        foot_on(p, a, to, from);
        reach_a = 0;
    }
    if (!is_ball(p, b)) {
        foot_on(p, b, from, to);
        reach_b = 0;
    }
    for (int k = 0; k < 3; ++k) {
        length += (to[k] - from[k]) * (to[k] - from[k]);
    }
    length = sqrt(length);
    truth.separation = length - reach_a - reach_b;
    for (int k = 0; k < 3; ++k) {
        truth.normal[k] = (to[k] - from[k]) / length;
        truth.point[k] = from[k] + truth.normal[k] * (reach_a + truth.separation / 2);
    }
    return truth;
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* ---- Bodies ---- */

/* Makes steps until there are contacts, at most so many; without any by then, the check fails. */
static void step_to_contact(pl_probe *p, int most)
{
    for (int n = 0; n < most && (n == 0 || p->contact_count == 0); ++n) {
        pl_probe_steps(p, 1);
    }
    char expected[PL_CHECK_TEXT_SIZE];
    snprintf(expected, sizeof expected,
             "read_contacts reports the contact of two bodies that touch, within %d steps", most);
    pl_probe_require(p, p->contact_count > 0, expected, "no contact",
                     "the engine claims contacts that read_contacts does not have: it is to read "
                     "those that the last step worked with");
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
    const double still[3] = {0, 0, 0};
    add_ball(p, (double[]){0, 0, 20}, still);
    const int resting = add_ball(p, (double[]){3, 0, RADIUS - DEPTH}, still);
    const int floor = pl_probe_add_floor(p);
    add_ball(p, (double[]){-4, 2, 25}, still);
    pl_probe_create(p);
    for (int n = 0; n < 10 && !p->over; ++n) {
        if (n == 0) {
            step_to_contact(p, 3);
        } else {
            pl_probe_steps(p, 1);
        }
        for (int i = 0; i < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[i]); ++i) {
            const pl_contact *contact = &p->contacts[i];
            char expected[PL_CHECK_TEXT_SIZE], found[PL_CHECK_TEXT_SIZE];
            snprintf(expected, sizeof expected, "contacts of bodies %d and %d, which alone touch",
                     resting, floor);
            snprintf(found, sizeof found, "a contact of bodies %d and %d", contact->body_a,
                     contact->body_b);
            pl_probe_require(p, is_of(contact, resting, floor), expected, found,
                             "the engine's number of a body or a shape is taken for the index in "
                             "the scene");
        }
    }
}

/* Two spheres that do not touch, and neither touches the floor. */
static void check_apart(pl_probe *p)
{
    begin(p, false);
    pl_probe_add_floor(p);
    add_ball(p, (double[]){0, 0, 2}, (double[]){0, 0, 0});
    add_ball(p, (double[]){1.5, 0, 2}, (double[]){0, 0, 0});
    pl_probe_create(p);
    const bool has_impulses = (p->choice->engine->contacts & PL_CONTACTS_IMPULSES) != 0;
    for (int n = 0; n < 3 && !p->over; ++n) {
        pl_probe_steps(p, 1);
        for (int i = 0; i < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[i]); ++i) {
            const pl_contact *contact = &p->contacts[i];
            char found[PL_CHECK_TEXT_SIZE];
            const double impulse =
                has_impulses ? distance(contact->impulse, (double[]){0, 0, 0}) : 0;
            snprintf(found, sizeof found,
                     "a contact of bodies %d and %d with separation %g m and an impulse of %g N s",
                     contact->body_a, contact->body_b, contact->separation, impulse);
            pl_probe_require(p, impulse == 0 && contact->separation > 0,
                             "bodies that are 0.5 m apart have no contact, or one without impulse "
                             "and with a positive separation",
                             found, "contacts of an earlier step or of another instance are left");
        }
    }
}

/* ---- Normals ---- */

static void expect_normals(pl_probe *p, int a, int b, const char *what)
{
    const contact_truth truth = truth_of(p, p->before, a, b);
    for (int i = 0; i < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[i]); ++i) {
        const pl_contact *contact = &p->contacts[i];
        const double *n = contact->normal, sign = contact->body_a == a ? 1 : -1;
        const double right[3] = {sign * truth.normal[0], sign * truth.normal[1],
                                 sign * truth.normal[2]};
        const double length = distance(n, (double[]){0, 0, 0});
        pl_probe_expect(p, "the length of a contact's normal", length, 1, pl_probe_tolerance(p, 10),
                        "it is not made a unit vector: it is scaled by a depth or an impulse, or "
                        "not set");
        const double dot = n[0] * right[0] + n[1] * right[1] + n[2] * right[2];
        char subject[PL_CHECK_TEXT_SIZE];
        snprintf(subject, sizeof subject, "the normal of a contact of A = %d and B = %d (%s)",
                 contact->body_a, contact->body_b, what);
        pl_probe_expect_vector(p, subject, n, right, 1e-3,
                               dot < -0.99 ? "it points from B to A; the ABI's points from A to B. "
                                             "Where the adapter swaps the bodies, it has to turn "
                                             "normal and impulse too"
                                           : "the normal is in a body's frame, or of another "
                                             "contact");
    }
}

/* Adds what the first sphere touches, at the origin: a plane, a box or another sphere. */
static int add_other(pl_probe *p, pl_shape_kind kind)
{
    return kind == PL_SHAPE_PLANE ? pl_probe_add_floor(p)
           : kind == PL_SHAPE_BOX ? add_slab(p)
                                  : add_ball(p, (double[]){0, 0, 0}, (double[]){0, 0, 0});
}

/* A sphere that comes down on the other body, which is the first of the scene or the last. */
static void expect_normals_on(pl_probe *p, pl_shape_kind kind, bool is_last)
{
    static const char *const what[] = {[PL_SHAPE_PLANE] = "a sphere on a plane",
                                       [PL_SHAPE_SPHERE] = "two spheres",
                                       [PL_SHAPE_BOX] = "a sphere on a box"};
    const double reach = kind == PL_SHAPE_SPHERE ? 2 * RADIUS - DEPTH : RADIUS - DEPTH;
    const double along[3] = {kind == PL_SHAPE_SPHERE ? 1.0 / 3 : 0,
                             kind == PL_SHAPE_SPHERE ? 2.0 / 3 : 0,
                             kind == PL_SHAPE_SPHERE ? 2.0 / 3 : 1};
    double position[3], velocity[3];
    for (int k = 0; k < 3; ++k) {
        position[k] = reach * along[k];
        velocity[k] = -along[k];
    }
    begin(p, false);
    int other = is_last ? 0 : add_other(p, kind);
    const int ball = add_ball(p, position, velocity);
    other = is_last ? add_other(p, kind) : other;
    pl_probe_create(p);
    step_to_contact(p, 3);
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
static void place_on_floor(pl_probe *p, double separation, const double velocity[3])
{
    begin(p, false);
    pl_probe_add_floor(p);
    add_ball(p, (double[]){1.3, -0.7, RADIUS + separation}, velocity);
    pl_probe_create(p);
}

/* On a plane that is not level and misses the origin. */
static void place_on_slope(pl_probe *p, double separation)
{
    const double normal[3] = {0.6, 0, 0.8}, offset = 0.75;
    pl_body slope = pl_body_default();
    double position[3] = {0, 2, 0};
    slope.is_static = true;
    slope.shape = pl_shape_plane(normal[0], normal[1], normal[2], offset);
    for (int k = 0; k < 3; ++k) {
        position[k] += (offset + RADIUS + separation) * normal[k];
    }
    begin(p, false);
    pl_probe_add_body(p, slope);
    add_ball(p, position, (double[]){0, 0, 0});
    pl_probe_create(p);
}

static void place_pair(pl_probe *p, double separation)
{
    const double reach = 2 * RADIUS + separation;
    begin(p, false);
    add_ball(p, (double[]){-2, 1, 3}, (double[]){0, 0, 0});
    add_ball(p, (double[]){-2 + reach / 3, 1 + 2 * reach / 3, 3 - 2 * reach / 3},
             (double[]){0, 0, 0});
    pl_probe_create(p);
}

static void expect_points(pl_probe *p)
{
    const contact_truth truth = truth_of(p, p->before, 0, 1);
    for (int i = 0; i < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[i]); ++i) {
        const pl_contact *contact = &p->contacts[i];
        double local[2][3];
        bool is_local = false;
        for (int body = 0; body < 2; ++body) {
            for (int k = 0; k < 3; ++k) {
                local[body][k] = truth.point[k] - p->before[body].position[k];
            }
            is_local = is_local || distance(contact->point, local[body]) <= 10 * DEPTH;
        }
        pl_probe_expect_vector(p, "the point of a contact, m", contact->point, truth.point,
                               DEPTH + 1e-3 * RADIUS,
                               is_local ? "the point is relative to a body: the ABI's is in the "
                                          "world"
                                        : "the point is of another contact, or not set");
    }
}

static void check_point(pl_probe *p)
{
    place_on_slope(p, -DEPTH);
    step_to_contact(p, 3);
    expect_points(p);
    place_pair(p, -DEPTH);
    step_to_contact(p, 3);
    expect_points(p);
}

static void expect_separations(pl_probe *p, double tolerance, const char *what)
{
    const double right = truth_of(p, p->before, 0, 1).separation;
    const double after = truth_of(p, p->now, 0, 1).separation;
    for (int i = 0; i < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[i]); ++i) {
        const double found = p->contacts[i].separation;
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
    place_on_floor(p, -DEPTH, (double[]){0, 0, 0});
    step_to_contact(p, 3);
    expect_separations(p, tolerance, "the separation of a sphere 1 mm deep in a plane, m");
    place_pair(p, -DEPTH);
    step_to_contact(p, 3);
    expect_separations(p, tolerance, "the separation of two spheres 1 mm deep in each other, m");
    /* Contacts of bodies that do not touch yet need not be reported. */
    place_on_floor(p, 2 * DEPTH, (double[]){0, 0, 0});
    pl_probe_steps(p, 1);
    expect_separations(p, tolerance, "the separation of a sphere 2 mm above a plane, m");
}

/* The poses before and after the step differ by far more than the tolerance. */
static void check_before_step(pl_probe *p)
{
    /* Along the plane: contacts that an engine keeps from step to step may be there too. */
    place_on_floor(p, -0.1 * DEPTH, (double[]){12, 0, 0});
    for (int n = 0; n < 3 && !p->over; ++n) {
        n == 0 ? step_to_contact(p, 3) : pl_probe_steps(p, 1);
        const double before = p->before[1].position[0], after = p->now[1].position[0];
        double nearest = INFINITY;
        for (int i = 0; i < p->contact_count && pl_probe_expect_bodies(p, &p->contacts[i]); ++i) {
            const double x = p->contacts[i].point[0];
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
    place_on_floor(p, -DEPTH, (double[]){0, 0, 5});
    pl_probe_steps(p, 1);
    expect_separations(p, DEPTH, "the separation, before the step, of a sphere that leaves, m");
}

/* ---- How many ---- */

static int read_again(pl_probe *p, pl_contact *contacts, int capacity)
{
    return p->session.loaded.table.read_contacts(p->session.instance, contacts, capacity);
}

static void expect_count(pl_probe *p, int found, const char *what)
{
    pl_probe_expect(p, what, found, p->contact_count, 0,
                    "read_contacts returns how many contacts there are, whatever its capacity, "
                    "and changes nothing");
}

/* Two spheres on the floor, so that there are more contacts than a buffer of one. */
static void check_count(pl_probe *p)
{
    begin(p, true);
    pl_probe_add_floor(p);
    add_ball(p, (double[]){0, 0, RADIUS - DEPTH}, (double[]){0, 0, 0});
    add_ball(p, (double[]){2, 0, RADIUS - DEPTH}, (double[]){0, 0, 0});
    pl_probe_create(p);
    step_to_contact(p, 3);
    if (p->over) {
        return;
    }
    enum { UNTOUCHED = 0x5a };
    pl_contact few[3];
    memset(few, UNTOUCHED, sizeof few);
    expect_count(p, read_again(p, few, 1), "what read_contacts returns for a capacity of 1");
    bool is_untouched = true;
    for (size_t i = sizeof *few; i < sizeof few; ++i) {
        is_untouched = is_untouched && ((const unsigned char *)few)[i] == UNTOUCHED;
    }
    pl_probe_require(p, is_untouched, "read_contacts fills no more contacts than its capacity of 1",
                     "the contact after it was written",
                     "the loop over contacts does not end at the capacity");
    expect_count(p, read_again(p, NULL, 0), "what read_contacts returns for a capacity of 0");
}

enum { SMOOTH = PL_NEEDS_SPHERE | PL_NEEDS_PLANE };

const pl_check pl_contact_checks[] = {
    {"contact-bodies", "contacts are of the bodies that touch", SMOOTH, PL_CONTACTS_POINTS,
     check_bodies},
    {"contact-apart", "bodies that are apart have no contact", SMOOTH, PL_CONTACTS_POINTS,
     check_apart},
    {"contact-normal", "normals have unit length, from A to B", PL_NEEDS_SPHERE, PL_CONTACTS_POINTS,
     check_normal},
    {"contact-point", "points are where the bodies touch", SMOOTH, PL_CONTACTS_POINTS, check_point},
    {"contact-separation", "a penetration is a negative separation", SMOOTH, PL_CONTACTS_POINTS,
     check_separation},
    {"contact-before-step", "contacts are of the pose before the step", SMOOTH, PL_CONTACTS_POINTS,
     check_before_step},
    {"contact-count", "read_contacts keeps to its capacity", SMOOTH, PL_CONTACTS_POINTS,
     check_count},
    {0}};
