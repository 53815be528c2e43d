/* Bodies that slide over a level floor: blocks until friction stops them, and a rod on its end. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Adds a flat block at (x, y) that starts along `direction`. Returns its index; -1: failed. */
static int slide_block(pl_builder *b, double x, double y, const double direction[3], double speed,
                       const char *name)
{
    pl_body block = pl_body_at(pl_shape_box(0.5, 0.5, 0.25), x, y, 0.25);
    for (int k = 0; k < 3; ++k) {
        block.velocity[k] = speed * direction[k];
    }
    return pl_build_body(b, &block, "%s", name);
}

/* A block that slides over a level floor until friction stops it.
 *
 * The block, of half extents (0.5, 0.5, 0.25) m, starts with the speed v0, level, at `azimuth` from
 * x towards y; its sides stay along x and y, so that its corners lead it differently at every
 * azimuth. Coulomb's friction brakes it by a = friction g along its path, whatever the azimuth and
 * however the weight is spread over its base, since all points slide the same way. With t the
 * smaller of the duration and v0 / a: continuous:           s = v0 t - a t^2 / 2, which is v0^2 /
 * (2 friction g) once it has stopped semi-implicit Euler:  v_k = v0 - k a h while that is above 0,
 * s_n = n v0 h - a h^2 n (n + 1) /
 * 2
 *
 * Valid while the block stays flat. The weight acts on the floor friction * half height ahead of
 * the centre, along the path, for the moment of the friction about the centre of mass asks that. It
 * is inside of the base, half width hb, at every azimuth iff friction * half height < hb: the range
 * of the parameter friction sees to it. Then the moment about the vertical is zero too: the path is
 * straight, and the block does not turn. */

enum { SLIDE_TO_STOP_SPEED, SLIDE_TO_STOP_AZIMUTH, SLIDE_TO_STOP_FRICTION };

static const pl_param slide_to_stop_params[] = {
    {"speed", 5, 1e-3, 100, false, "m/s", "of the block at the start"},
    {"azimuth", 30, 0, 90, false, "deg", "of its path, from x towards y"},
    {"friction", 0.5, 0, 1.9, false, "1",
     "Coulomb coefficient; below 2, where the block would tip"},
    PL_PARAM_TIME(3),
};

/* pl_braking_distance with its sum rounded in another order, which scenes already written have. */
static pl_answer stopping_distance(const pl_builder *b, double v)
{
    const double a = b->scene->materials[0].friction * b->gravity, h = b->scene->dt;
    const double t = fmin(b->end, v / a), n = fmin(b->steps, floor(v / (a * h)));
    const double discrete = n * v * h - a * h * h * n * (n + 1) / 2;
    return (pl_answer){v * t - a * t * t / 2, discrete > 0 ? discrete : (double)NAN};
}

static void slide_to_stop_build(pl_builder *b, const double *values)
{
    const double speed = values[SLIDE_TO_STOP_SPEED];
    double direction[3];
    pl_azimuth(values[SLIDE_TO_STOP_AZIMUTH], direction);
    pl_build_floor(b);
    const int block = slide_block(b, 0, 0, direction, speed, "block");
    pl_build_travel(b, block, direction, stopping_distance(b, speed));
}

const pl_scenario pl_scenario_slide_to_stop = {
    .name = "slide-to-stop",
    .title = "Block that friction stops",
    .description =
        "A block pushed off over a level floor, at any azimuth: whether friction takes the right "
        "distance to stop it, the same in all directions, along a straight path.",
    .reference = "s = v0^2 / (2 friction g) along the azimuth, while friction < half width / half "
                 "height = 2, so that it does not tip",
    .expected =
        "ok: the block stops at the distance of the reference, straight ahead and not turned",
    .source = "Coulomb's law and uniform deceleration; the condition: moments about the centre of "
              "mass",
    .primary_error = "travel_error",
    PL_ACCEPT_FRICTION,
    .validity = "speed well above friction g dt, which a step takes from it",
    PL_PARAMS(slide_to_stop_params),
    .build = slide_to_stop_build};

/* Nineteen blocks side by side, each pushed off at its own azimuth, 0 to 90 degrees by 5.
 *
 * Coulomb's friction takes friction g along each path, so that all go equally far and straight on;
 * see slide-to-stop for one of them, and for its discrete answer. Friction by a pyramid whose
 * edges lie along the world's axes would hold one at 45 degrees sqrt(2) times as well as one at 0.
 * The blocks' sides stay along x and y. They start on a line across 45 degrees and fan out. */

enum { ISOTROPY_SPEED, ISOTROPY_FRICTION };
enum { BLOCKS = 19 };

static const double spacing = 5; /* m */

static const pl_param isotropy_params[] = {
    {"speed", 5, 0.1, 100, false, "m/s", "of the blocks at the start"},
    {"friction", 0.5, 0.01, 1.9, false, "1",
     "Coulomb coefficient; below 2, where the blocks would tip"},
    PL_PARAM_TIME(3),
};

static void isotropy_build(pl_builder *b, const double *values)
{
    const double braking = values[ISOTROPY_FRICTION] * b->gravity;
    const pl_answer distance =
        pl_braking_distance(values[ISOTROPY_SPEED], braking, b->scene->dt, b->steps);
    pl_build_floor(b);
    for (int i = 0; i < BLOCKS; ++i) {
        const int place = i - (BLOCKS - 1) / 2;
        const double across = spacing * sqrt(0.5) * place;
        double direction[3];
        char name[PL_NAME_SIZE];
        pl_azimuth(5 * i, direction);
        snprintf(name, sizeof name, "block %d", 5 * i);
        const int block = slide_block(b, -across, across, direction, values[ISOTROPY_SPEED], name);
        pl_build_travel(b, block, direction, distance);
    }
}

const pl_scenario pl_scenario_isotropy = {
    .name = "isotropy",
    .title = "Friction in all directions",
    .description =
        "Blocks pushed off over a level floor at azimuths of 0 to 90 degrees, all of one "
        "size and speed: friction by a pyramid in place of a cone stops them at "
        "different distances, and off their paths.",
    .reference = "s = v0^2 / (2 friction g) along every azimuth, while friction < half width / "
                 "half height = 2, so that no block tips",
    .expected = "ok: all blocks go equally far, each straight along its azimuth",
    .source = "Coulomb's law and uniform deceleration",
    .primary_error = "travel_error",
    PL_ACCEPT_FRICTION,
    PL_PARAMS(isotropy_params),
    .build = isotropy_build};

/* A tall block slides on a level floor, its weight more on the leading edge than on the other.
 *
 * Friction mu m g acts at the floor, half the height hh below the centre of mass, so that with half
 * width hb along the path the reactions at the two edges are
 *   N_front, N_back = (m g / 2) (1 +- mu hh / hb).
 * The block stays flat iff the one behind is above 0, mu < hb / hh; then it slides as any other,
 *   s = v0 t - mu g t^2 / 2,  v = v0 - mu g t,
 * until it stops, and neither turns nor leaves its path. */

enum { REACTION_SPLIT_SPEED, REACTION_SPLIT_HEIGHT, REACTION_SPLIT_FRICTION };

static const double half_width = 0.25; /* m */

static const pl_param reaction_split_params[] = {
    {"speed", 5, 0.1, 100, false, "m/s", "of the block at the start"},
    {"height", 2, 0.1, 20, false, "1", "of the block, over its width of 0.5 m"},
    {"friction", 0.3, 1e-3, 10, false, "1",
     "Coulomb coefficient; below width / height, where the block would tip"},
    PL_PARAM_TIME(1),
};

static void reaction_split_build(pl_builder *b, const double *values)
{
    const double speed = values[REACTION_SPLIT_SPEED], friction = values[REACTION_SPLIT_FRICTION];
    if (friction * values[REACTION_SPLIT_HEIGHT] >= 1) {
        pl_build_refuse(b,
                        "expected a friction below width / height = %g, where the "
                        "block does not tip, found %g",
                        1 / values[REACTION_SPLIT_HEIGHT], friction);
        return;
    }
    const double braking = friction * b->gravity, h = b->scene->dt;
    const double steps = b->steps, half_height = half_width * values[REACTION_SPLIT_HEIGHT];
    pl_build_floor(b);
    pl_body block =
        pl_body_at(pl_shape_box(half_width, half_width, half_height), 0, 0, half_height);
    block.velocity[0] = speed;
    const int index = pl_build_body(b, &block, "block");
    const pl_answer distance = pl_braking_distance(speed, braking, h, steps);
    pl_build_displaced(b, index, pl_axis_x, distance, distance.continuous);
    pl_build_at_end(b, index, PL_QUANTITY_VELOCITY, pl_axis_x,
                    pl_exactly(fmax(0, speed - braking * steps * h)), speed);
    pl_build_none(b, index, PL_QUANTITY_TURN, PL_ALONG_ALL, 1);
}

const pl_scenario pl_scenario_reaction_split = {
    .name = "reaction-split",
    .title = "Tall block that slides",
    .description = "A tall block slides with most of its weight on the leading edge: whether the "
                   "reactions shift as they must, so that it neither digs in nor tips, and brakes "
                   "as a flat one.",
    .reference = "a = friction g without turning; front and back reactions (m g / 2) "
                 "(1 +- friction height / width)",
    .expected = "ok: the block brakes as a flat one and does not turn",
    .source = "Coulomb's law; moments about the centre of mass",
    .primary_error = "value_error",
    PL_ACCEPT_FRICTION,
    .validity = "friction < width / height, else the block tips",
    PL_PARAMS(reaction_split_params),
    .build = reaction_split_build};

/* A slender rod that slides on its end over rough ground, that end ahead, as chalk that is pushed.
 *
 * The rod has length 2 L and uniform density. It leans at an angle a to the ground, so that
 * friction, which opposes the slip, turns its end into the ground. The normal acceleration of the
 * end for a normal force N is N / m (1 + 3 cos a (cos a - friction sin a)): with friction > (1 + 3
 * cos^2 a) / (3 sin a cos a), least 4/3 at tan a = 2, a larger force presses the end further in. No
 * finite force keeps it out, and the answer is an impulse that stops the end at once. Impulses of
 * friction, and of a contact that does not rebound, take energy and never give any.
 *
 * The impulse keeps the angular momentum about the end. With R from the end's lower edge to the
 * centre, f the angle of that line from the ground and I = 4/3 m R^2 about the edge, the rod turns
 * from then on about it,
 *   f' = 3 v sin(f) / (4 R) at first,  f'' = -3 g / (4 R) cos(f),
 * as long as the ground must push, N = m (g + (R sin f)'') > 0, with friction for its reaction,
 * |m (-R cos f)''| <= friction N. The impulse itself asks for the friction above, with f for a. The
 * rod is expected where it is 0.2 s after the start, nearly upright by default; where it does not
 * turn about its end until then, energy_gain is the primary error, and no run is called accurate. */

enum { PAINLEVE_FRICTION, PAINLEVE_ANGLE, PAINLEVE_SPEED };

static const pl_param painleve_params[] = {
    {"friction", 2, 0, 10, false, "1",
     "Coulomb coefficient; above 4/3 there are angles without an answer"},
    {"angle", 63.43494882292201, 5, 85, false, "deg",
     "of the rod from the ground; tan = 2 is the worst"},
    {"speed", 2, 0, 20, false, "m/s", "of the rod along the ground at the start"},
    PL_PARAM_TIME(3),
};

static const double half_length = 0.5, half_thickness = 0.005; /* m */
static const double turning_time = 0.2;                        /* s */

/* A rod that turns about its end: how far it has turned, rad, and its rate. */
typedef struct turning {
    double radius, friction, gravity;
    double cosine, sine; /* of the angle from the ground at the start */
    double turn, rate;
} turning;

/* The cosine and the sine of the angle from the ground. */
static void direction_of(const turning *t, double *c, double *s)
{
    const double cosine = pl_cosine_of_any(fabs(t->turn));
    const double sine = copysign(pl_sine_of_any(fabs(t->turn)), t->turn);
    *c = t->cosine * cosine - t->sine * sine;
    *s = t->sine * cosine + t->cosine * sine;
}

/* Whether the ground can hold the end; and what the rod's weight does to its rate. */
static bool holds_end(const turning *t, double *acceleration)
{
    double c, s;
    direction_of(t, &c, &s);
    const double a = -0.75 * t->gravity / t->radius * c, square = t->rate * t->rate;
    const double push = t->gravity + t->radius * (c * a - s * square);
    const double friction = t->radius * (s * a + c * square);
    *acceleration = a;
    return s > 0.05 && push > 0 && fabs(friction) <= t->friction * push;
}

/* From the start of the slide on; false: it does not turn about its end all the time. */
static bool turn_on_end(turning *t, double speed)
{
    enum { STEPS = 2000 };
    const double h = turning_time / STEPS, c = t->cosine, s = t->sine;
    double acceleration = 0;
    bool holds = speed > 0 && t->friction * 3 * s * c > 1 + 3 * c * c;
    t->rate = 0.75 * speed * s / t->radius;
    holds = holds && holds_end(t, &acceleration);
    for (int i = 0; i < STEPS && holds; ++i) {
        const double middle = t->rate + h / 2 * acceleration;
        t->turn += h * middle;
        holds = holds_end(t, &acceleration);
        t->rate = middle + h / 2 * acceleration;
    }
    return holds;
}

static void expect_turned(pl_builder *b, int rod, const turning *t)
{
    const double *const axes[] = {pl_axis_x, pl_axis_y, pl_axis_z};
    double c, s;
    direction_of(t, &c, &s);
    const double way[] = {t->radius * (t->cosine - c), 0, t->radius * (s - t->sine)};
    const double turn[] = {0, t->turn, 0};
    pl_expect_value value = pl_expect_value_default(b->scene);
    value.body = rod;
    value.until = turning_time;
    for (int k = 0; k < 3; ++k) {
        memcpy(value.direction, axes[k], sizeof value.direction);
        value.quantity = PL_QUANTITY_TURN;
        value.value = turn[k];
        value.scale = fabs(t->turn);
        pl_build_value(b, &value);
        value.quantity = PL_QUANTITY_POSITION;
        value.value = way[k];
        value.scale = sqrt(way[0] * way[0] + way[2] * way[2]);
        pl_build_value(b, &value);
    }
}

static void painleve_build(pl_builder *b, const double *values)
{
    const double angle = PL_RADIANS_PER_DEGREE * values[PAINLEVE_ANGLE];
    const double s = pl_sine(angle), c = pl_cosine(angle);
    pl_build_floor(b);
    /* Its long axis is its x axis, which the turn about y points down. */
    pl_body rod = pl_body_at(pl_shape_box(half_length, 5 * half_thickness, half_thickness), 0, 0,
                             half_length * s + half_thickness * c);
    pl_turn_about_y(&rod, angle);
    rod.velocity[0] = values[PAINLEVE_SPEED];
    const int index = pl_build_body(b, &rod, "rod");
    const double radius = sqrt(half_length * half_length + half_thickness * half_thickness);
    turning t = {.radius = radius,
                 .friction = values[PAINLEVE_FRICTION],
                 .gravity = b->gravity,
                 .cosine = (half_length * c - half_thickness * s) / radius,
                 .sine = (half_length * s + half_thickness * c) / radius};
    if (turning_time <= b->end && turn_on_end(&t, values[PAINLEVE_SPEED]) && fabs(t.turn) > 0.01) {
        expect_turned(b, index, &t);
    } else {
        snprintf(b->scene->primary_error, PL_NAME_SIZE, "energy_gain");
        b->scene->acceptance = (double)INFINITY;
    }
}

const pl_scenario pl_scenario_painleve = {
    .name = "painleve",
    .title = "Rod without a finite force",
    .description = "A rod that slides on its end, that end ahead, with so much "
                   "friction that no finite force keeps it out of the ground.",
    .reference =
        "an impulse stops the end at once; the rod turns about it from 3 v sin / (4 R) on; "
        "inconsistent iff friction > (1 + 3 cos^2) / (3 sin cos) of the angle, at least 4/3",
    .expected = "ok: the sliding end stops at once and the rod turns over it; energy never grows",
    .source = "Newton's and Euler's laws with Coulomb's friction: Painleve 1895; Genot and "
              "Brogliato 1999, New results on Painleve paradoxes",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity =
        "friction above (1 + 3 cos^2) / (3 sin cos), a speed at which the end stays down for "
        "0.2 s; elsewhere no run is called accurate",
    .provokes =
        "the equations of forces have no solution: a solver of accelerations fails or finds "
        "endless forces, another throws the rod; a right engine solves for impulses, which "
        "are finite, and energy falls",
    PL_PARAMS(painleve_params),
    .build = painleve_build};
