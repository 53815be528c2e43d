/* Bodies that spin on a level floor: until friction stops them, in place and while they slide, and a
 * coin that rolls on its edge for ever. */
#include "base/trigonometry.h"
#include "catalogue.h"
#include "solids.h"

#include <math.h>
#include <string.h>

/* A box or a disc spins flat on a level floor until friction stops it.
 *
 * The box stands on its four corners, each at the distance d from the axis. However they share the
 * weight, the friction of all has the moment mu m g d; with I = m d^2 / 3
 *   w' = -3 mu g / d,
 * and by symmetry (or by pairs of opposite corners) nothing pushes it sideways. A disc of radius R
 * that presses evenly has the moment int mu p r dA = 2/3 mu m g R and I = m R^2 / 2:
 *   w' = -4/3 mu g / R.
 * An engine that holds the disc by a few points of its rim gives it 2 mu g / R. Either stops after
 * w0 / |w'| and has then turned by w0^2 / (2 |w'|); in semi-implicit Euler it turns by the sum of
 * h w_k. It keeps its place and its height, and stays flat. */

enum { SPIN_STOP_SHAPE, SPIN_STOP_SPIN, SPIN_STOP_FRICTION };
enum { BOX, DISC };

static const double half[3] = {0.5, 0.3, 0.1}; /* m, of the box */
static const double spin_stop_radius = 0.5, spin_stop_half_height = 0.1;

static const pl_param spin_stop_params[] = {
    {"shape", BOX, BOX, DISC, true, "1",
     "0 box, 1 disc: a cylinder on its cap, by its continuum of contact"},
    {"spin", 10, 0.1, 1000, false, "rad/s", "at the start, about the vertical"},
    {"friction", 0.3, 1e-3, 10, false, "1", "Coulomb coefficient"},
    PL_PARAM_TIME(1),
};

static void spin_stop_build(pl_builder *b, const double *values)
{
    const bool is_box = values[SPIN_STOP_SHAPE] == BOX;
    const double reach = is_box ? sqrt(half[0] * half[0] + half[1] * half[1]) : spin_stop_radius;
    const double braking = (is_box ? 3 : 4.0 / 3) * values[SPIN_STOP_FRICTION] * b->gravity / reach;
    const double spin = values[SPIN_STOP_SPIN], steps = b->steps;
    pl_build_floor(b);
    pl_body body = pl_body_at(is_box ? pl_shape_box(half[0], half[1], half[2])
                                     : pl_shape_cylinder(spin_stop_radius, spin_stop_half_height),
                              0, 0, is_box ? half[2] : spin_stop_half_height);
    body.angular_velocity[2] = spin;
    const int index = pl_build_body(b, &body, "block");
    const pl_answer turn = pl_braking_distance(spin, braking, b->scene->dt, steps);
    const double left = fmax(0, spin - braking * steps * b->scene->dt);
    pl_build_at_end(b, index, PL_QUANTITY_TURN, pl_axis_z, turn, turn.continuous);
    pl_build_at_end(b, index, PL_QUANTITY_SPIN, pl_axis_z, pl_exactly(left), spin);
    pl_build_none(b, index, PL_QUANTITY_POSITION, PL_ALONG_ALL, reach);
    pl_build_none(b, index, PL_QUANTITY_TURN, PL_ALONG_X | PL_ALONG_Y, turn.continuous);
}

const pl_scenario pl_scenario_spin_stop = {
    .name = "spin-stop",
    .title = "Spin that friction stops",
    .description = "A box, or a disc, spins flat on the floor until it stops: whether friction at "
                   "the corners brakes the spin as much as Coulomb's law lets it.",
    .reference = "box on its corners, d from the axis: w' = -3 friction g / d; disc that presses "
                 "evenly: w' = -4/3 friction g / R; it turns by w0^2 / (2 |w'|)",
    .expected = "ok: the body turns by the angle of the reference and stays in its place",
    .source = "Coulomb's law: the moment of friction over the contact points; for the disc over "
              "its face, as in Farkas, Bartels, Unger and Wolf 2003, Frictional coupling between "
              "sliding and spinning motion",
    .primary_error = "value_error",
    PL_ACCEPT_FRICTION,
    .validity = "the box on its four corners alone; the disc with a continuum of contact",
    PL_PARAMS(spin_stop_params),
    .build = spin_stop_build};

/* A triangular plate slides and spins on its three corners until both end, at one instant.
 *
 * Three points, unlike four, share the weight in one way only. With r_i from the axis to corner i,
 * d_i the unit slip velocity there (v + w z x r_i over its length), H half the thickness and N_i
 * the reaction, friction -mu N_i d_i and a plate that stays flat ask for
 *   sum N_i = m g,  sum N_i (r_i - mu H d_i) = 0,
 *   m v' = -mu sum N_i d_i,  I w' = -mu sum N_i (r_i x d_i),
 * solved here by the classical Runge-Kutta rule until 1e-8 of the energy is left, which is worth
 * 1e-8 of the distance. It brakes less in either motion than if the other were not there: on a disc
 * that presses evenly v / (R w) tends to 0.653 as both end, from any start (Farkas and others
 * 2003). It keeps its height and stays flat. */

enum { SLIDE_AND_SPIN_SPEED, SLIDE_AND_SPIN_SPIN, SLIDE_AND_SPIN_FRICTION };

static const double slide_and_spin_radius = 0.5, slide_and_spin_half_height = 0.05; /* m */

static const pl_param slide_and_spin_params[] = {
    {"speed", 2, 0.1, 100, false, "m/s", "at the start"},
    {"spin", 6, 0.1, 200, false, "rad/s",
     "at the start, about the vertical; the corners are 0.5 m from the axis"},
    {"friction", 0.3, 0.01, 1, false, "1", "Coulomb coefficient"},
    PL_PARAM_TIME(2),
};

/* Of a plate of 1 kg. `corner` is the unit vector from the axis to the first corner. */
enum { X, Y, TURN, VX, VY, W, CORNER_X, CORNER_Y, UNKNOWNS };

static const double inertia_over_square = 0.25; /* of 1 kg, over R^2: (2 + cos(2 pi / 3)) / 6 */

/* Cross product's z. */
static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

static void rate_of(const double *y, double friction, double g, double *rate)
{
    const double half_root_3 = 0.8660254037844386;
    static const double turn[3][2] = {{1, 0}, {-0.5, 1}, {-0.5, -1}};
    double r[3][2], slip[3][2], p[3][2], force[2] = {0, 0}, torque = 0;
    for (int i = 0; i < 3; ++i) {
        const double c = turn[i][0], s = turn[i][1] * half_root_3;
        r[i][0] = slide_and_spin_radius * (c * y[CORNER_X] - s * y[CORNER_Y]);
        r[i][1] = slide_and_spin_radius * (s * y[CORNER_X] + c * y[CORNER_Y]);
        const double u[2] = {y[VX] - y[W] * r[i][1], y[VY] + y[W] * r[i][0]};
        const double speed = sqrt(u[0] * u[0] + u[1] * u[1]);
        for (int k = 0; k < 2; ++k) {
            slip[i][k] = speed > 0 ? u[k] / speed : 0;
            p[i][k] = r[i][k] - friction * slide_and_spin_half_height * slip[i][k];
        }
    }
    /* The weights of the origin in the triangle of the p. */
    const double share[3] = {cross(p[1], p[2]), cross(p[2], p[0]), cross(p[0], p[1])};
    const double whole = share[0] + share[1] + share[2];
    for (int i = 0; i < 3; ++i) {
        const double most = friction * g * share[i] / whole;
        force[0] -= most * slip[i][0];
        force[1] -= most * slip[i][1];
        torque -= most * cross(r[i], slip[i]);
    }
    rate[X] = y[VX];
    rate[Y] = y[VY];
    rate[TURN] = y[W];
    rate[VX] = force[0];
    rate[VY] = force[1];
    rate[W] = torque / (inertia_over_square * slide_and_spin_radius * slide_and_spin_radius);
    rate[CORNER_X] = -y[W] * y[CORNER_Y];
    rate[CORNER_Y] = y[W] * y[CORNER_X];
}

static double energy_of(const double *y)
{
    const double rim = slide_and_spin_radius * y[W];
    return y[VX] * y[VX] + y[VY] * y[VY] + inertia_over_square * rim * rim;
}

/* From y on, for so long or until it stops; then the velocities are 0. */
static void solve(double *y, double time, double friction, double g)
{
    enum { STEPS = 100000 };
    static const double node[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    const double least = 1e-8 * energy_of(y);
    const double h = fmin(time, (sqrt(energy_of(y)) * 2) / (friction * g)) / STEPS;
    double left = time;
    for (int n = 0; n < 4 * STEPS && left > 0 && energy_of(y) > least; ++n) {
        const double step = fmin(h, left);
        double rate[UNKNOWNS] = {0}, sum[UNKNOWNS] = {0};
        for (int stage = 0; stage < 4; ++stage) {
            double at[UNKNOWNS];
            for (int i = 0; i < UNKNOWNS; ++i) {
                at[i] = y[i] + node[stage] * step * rate[i];
            }
            rate_of(at, friction, g, rate);
            for (int i = 0; i < UNKNOWNS; ++i) {
                sum[i] += weight[stage] * rate[i];
            }
        }
        for (int i = 0; i < UNKNOWNS; ++i) {
            y[i] += step / 6 * sum[i];
        }
        left -= step;
    }
    if (left > 0) {
        y[VX] = y[VY] = y[W] = 0;
    }
}

static void expect(pl_builder *b, int plate, const double *y, const double *values)
{
    const double distance = sqrt(y[X] * y[X] + y[Y] * y[Y]);
    pl_build_at_end(b, plate, PL_QUANTITY_POSITION, pl_axis_x, pl_continuous(y[X]), distance);
    pl_build_at_end(b, plate, PL_QUANTITY_POSITION, pl_axis_y, pl_continuous(y[Y]), distance);
    pl_build_none(b, plate, PL_QUANTITY_POSITION, PL_ALONG_Z, distance);
    pl_build_at_end(b, plate, PL_QUANTITY_TURN, pl_axis_z, pl_continuous(y[TURN]), fabs(y[TURN]));
    pl_build_none(b, plate, PL_QUANTITY_TURN, PL_ALONG_X | PL_ALONG_Y, fabs(y[TURN]));
    pl_build_at_end(b, plate, PL_QUANTITY_VELOCITY, pl_axis_x, pl_continuous(y[VX]),
                    values[SLIDE_AND_SPIN_SPEED]);
    pl_build_at_end(b, plate, PL_QUANTITY_SPIN, pl_axis_z, pl_continuous(y[W]),
                    values[SLIDE_AND_SPIN_SPIN]);
}

static void slide_and_spin_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    pl_solid solid = pl_solid_prism(3, slide_and_spin_radius, slide_and_spin_half_height);
    const pl_shape triangle = pl_build_solid(b, &solid, true, "triangle");
    if (b->status == PL_OK) {
        double y[UNKNOWNS] = {
            [VX] = values[SLIDE_AND_SPIN_SPEED], [W] = values[SLIDE_AND_SPIN_SPIN]};
        pl_circle_point(1, 6, &y[CORNER_X], &y[CORNER_Y]);
        solve(y, b->end, values[SLIDE_AND_SPIN_FRICTION], b->gravity);
        pl_body plate = pl_body_at(triangle, 0, 0, slide_and_spin_half_height);
        plate.velocity[0] = values[SLIDE_AND_SPIN_SPEED];
        plate.angular_velocity[2] = values[SLIDE_AND_SPIN_SPIN];
        expect(b, pl_build_body(b, &plate, "plate"), y, values);
    }
}

const pl_scenario pl_scenario_slide_and_spin = {
    .name = "slide-and-spin",
    .title = "Plate that slides and spins",
    .description = "A triangular plate slides and spins on its corners: friction at each against "
                   "its own slip, so that the spin carries the plate farther, and both end at one "
                   "instant.",
    .reference = "the equations of motion with Coulomb's friction at the three corners, solved to "
                 "1e-8 of the distance; no closed form",
    .expected =
        "ok: distance and turn are those of the reference; sliding and spinning end at one instant",
    .source = "Coulomb's law and statics of three points; the coupling: Farkas, Bartels, Unger and "
              "Wolf 2003, Frictional coupling between sliding and spinning motion",
    .primary_error = "value_error",
    PL_ACCEPT_FRICTION,
    .validity = "the plate stays flat, which it does while friction * 0.05 m is far below the "
                "0.25 m from its axis to its sides",
    PL_PARAMS(slide_and_spin_params),
    .build = slide_and_spin_build};

/* A coin, a short cylinder, rolls on its edge without slip, so that its axis keeps its tilt and turns
 * evenly about the vertical: Euler's disk without losses.
 *
 * Radius R, half thickness d, tilt a of the axis from the vertical, s = sin a, c = cos a. With e3
 * along the axis, e2 up the slope of the face and e1 = e2 x e3, both turning with the rate W about
 * the vertical c e3 + s e2, the spin is w = W s e2 + w3 e3. The lowest point is at r = -R e2 - d e3
 * from the centre, whose height R s + d c is constant. Without slip the centre moves at -w x r, along
 * e1, on a circle: of radius p if w3 = W (s d - p) / R. The force F on the lowest point holds the
 * weight and the centre on its circle, and r x F changes the angular momentum (A W s e2 + C w3 e3,
 * with A = m (R^2 / 4 + d^2 / 3), C = m R^2 / 2) as the frame turns it:
 *   m g (R c - d s) - m W^2 p (R s + d c) = W s (A W c - C w3), so
 *   W^2 = g (R c - d s) / (p (R s + d c) + s c A / m + s (p - s d) C / (m R)).
 * For a thin coin whose centre rests (p = 0) that is W^2 = 4 g / (R s), and friction has nothing to
 * do; else it holds the centre on the circle, with W^2 p <= friction g. Height, tilt, energy and the
 * spin about the vertical, W s^2 + w3 c, are constant. The height stands for the energy: for a thin
 * coin whose centre rests, that is 3/2 m g R s. Up to a tilt of 1.1 small deviations stay
 * small: the linear equations about the steady motion have only frequencies that are real. */

enum {
    SPINNING_COIN_TILT,
    SPINNING_COIN_PATH,
    SPINNING_COIN_RADIUS,
    SPINNING_COIN_THICKNESS,
    SPINNING_COIN_FRICTION
};

static const pl_param spinning_coin_params[] = {
    {"tilt", 0.5, 0.05, 1.1, false, "rad",
     "of the coin's axis from the vertical; small: nearly flat"},
    {"path", 0, 0, 100, false, "m", "radius of the circle of the coin's centre; 0: it rests"},
    {"radius", 0.5, 0.01, 10, false, "m", "of the coin"},
    {"thickness", 0.1, 0.002, 0.5, false, "1", "of the coin, over its radius"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

/* Steady rolling of a coin of 1 kg that leans to -x, its centre at x = path. */
typedef struct rolling {
    double height, turning; /* of the centre, m; W, rad/s */
    double spin[3];         /* at the start, rad/s */
} rolling;

static rolling steady_rolling(double g, double tilt, double path, double r, double d)
{
    const double s = pl_sine(tilt), c = pl_cosine(tilt), height = r * s + d * c;
    const double a = r * r / 4 + d * d / 3, axial = r * r / 2;
    const double turning =
        sqrt(g * (r * c - d * s) / (path * height + s * c * a + s * (path - s * d) * axial / r));
    const double w3 = turning * (s * d - path) / r, w2 = turning * s;
    return (rolling){
        .height = height, .turning = turning, .spin = {w3 * s - w2 * c, 0, w3 * c + w2 * s}};
}

static void spinning_coin_build(pl_builder *b, const double *values)
{
    const double path = values[SPINNING_COIN_PATH], radius = values[SPINNING_COIN_RADIUS];
    const double tilt = values[SPINNING_COIN_TILT], friction = values[SPINNING_COIN_FRICTION];
    const double half_height = radius * values[SPINNING_COIN_THICKNESS] / 2;
    const rolling coin = steady_rolling(b->gravity, tilt, path, radius, half_height);
    const double need = coin.turning * coin.turning * path / b->gravity;
    const double phase = coin.turning * b->end, whole = 6.283185307179586;
    if (friction < need) {
        pl_build_refuse(b,
                        "expected a friction of at least %g, which holds the coin on its path, "
                        "found %g",
                        need, friction);
    }
    pl_build_floor(b);
    pl_body body = pl_body_at(pl_shape_cylinder(radius, half_height), path, 0, coin.height);
    pl_turn_about_y(&body, tilt);
    body.velocity[1] = coin.turning * path;
    memcpy(body.angular_velocity, coin.spin, sizeof body.angular_velocity);
    const int index = pl_build_body(b, &body, "coin");
    const double along = path * phase, turned = fmod(phase, whole);
    const double scale = fmax(radius, along), rise = coin.height;
    const double x = path * (pl_cosine_of_any(turned) - 1), y = path * pl_sine_of_any(turned);
    pl_build_at_end(b, index, PL_QUANTITY_POSITION, pl_axis_z, pl_continuous(0), rise);
    pl_build_at_end(b, index, PL_QUANTITY_POSITION, pl_axis_x, pl_continuous(x), scale);
    pl_build_at_end(b, index, PL_QUANTITY_POSITION, pl_axis_y, pl_continuous(y), scale);
    pl_build_at_end(b, index, PL_QUANTITY_SPIN, pl_axis_z, pl_continuous(coin.spin[2]),
                    coin.turning);
    pl_build_at_end(b, index, PL_QUANTITY_TURN, pl_axis_z, pl_continuous(coin.spin[2] * b->end),
                    phase);
}

const pl_scenario pl_scenario_spinning_coin = {
    .name = "spinning-coin",
    .title = "Coin that rolls on its edge",
    .description = "A coin rolls round on its edge, tilted, its centre at rest or on a circle: "
                   "Euler's disk without losses, which an engine of good balance of moments keeps "
                   "up for ever.",
    .reference =
        "steady: W^2 = g (R c - d s) / (p (R s + d c) + s c A / m + s (p - s d) C / (m R)) "
        "for the turning of the axis, w3 = W (s d - p) / R for the spin about it; height "
        "R s + d c, tilt and energy stay",
    .expected = "ok: the coin keeps rolling round at the same tilt, and no energy is lost",
    .source = "rolling of a disk: Appell 1900, Sur l'integration des equations du mouvement d'un "
              "corps pesant de revolution roulant par une arete circulaire sur un plan horizontal; "
              "W^2 = 4 g / (R s): Moffatt 2000, Euler's disk and its finite-time singularity",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity = "friction holds the coin on its path: W^2 p <= friction g",
    .provokes = "a contact point that runs round the edge many times a second: gyroscopic moments "
                "taken at the wrong instant and contacts of the step's start tilt the coin, and it "
                "falls flat or rears up; a right engine keeps its height",
    PL_PARAMS(spinning_coin_params),
    .build = spinning_coin_build};
