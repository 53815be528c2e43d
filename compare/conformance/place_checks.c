/* Where bodies are: shapes that are turned or stand up, bodies that move so slowly that engines put
 * them to sleep, and the step that a frame is of. */
#include "probe.h"

#include <math.h>

/* A body that falls onto a floor. */
typedef struct fall {
    pl_body body;
    int steps;     /* of 1/100 s */
    double height; /* m: of the body's centre above the floor, at its end */
    /* Heights that known mistakes give; the last has no cause. */
    struct {
        double height;
        const char *cause;
    } mistakes[3];
} fall;

static void expect_height(pl_probe *p, const char *what, const fall *f)
{
    pl_probe_scene(p, 1.0 / 100);
    p->scene.materials[0].friction = 0;
    pl_check_add_floor(p);
    const int index = pl_probe_add_body(p, f->body);
    pl_probe_run(p, f->steps);
    const double found = p->now[index].position[2], tolerance = 0.05 * f->height;
    const char *cause = "the shape's axes, its size, or the body's orientation";
    for (int i = 0; f->mistakes[i].cause != NULL; ++i) {
        if (fabs(found - f->mistakes[i].height) <= tolerance) {
            cause = f->mistakes[i].cause;
        }
    }
    pl_probe_expect(p, what, found, f->height, tolerance, cause);
}

/* A turn by 90 degrees about x. Read as x, y, z, w the quaternion is a half turn about x + y, which
 * leaves z upright. */
static void check_turned_box(pl_probe *p)
{
    const fall f = {
        .body = {.shape = pl_shape_box(0.5, 0.4, 0.6),
                 .mass = 2,
                 .position = {0, 0, 0.65},
                 .orientation = {sqrt(0.5), sqrt(0.5), 0, 0}},
        .steps = 100,
        .height = 0.4,
        .mistakes = {{0.6,
                      "create sets no orientation, or takes it that the quaternion is x, y, z, "
                      "w: the ABI's is w, x, y, z"},
                     {0.5, "the axes of the box are exchanged"}}};
    expect_height(p, "the height at which a box rests that is turned by 90 degrees about x, m", &f);
}

/* It stands upright for a short time only: it may fall over later. */
static void check_standing_capsule(pl_probe *p)
{
    const fall f = {
        .body = {.shape = pl_shape_capsule(0.3, 0.5), .mass = 2, .position = {0, 0, 0.81}},
        .steps = 30,
        .height = 0.8,
        .mistakes = {{0.5, "half_height is taken for a length that includes the caps: it is half "
                           "the distance of their centres"},
                     {0.3, "the axis of a capsule is its z axis"}}};
    expect_height(p, "the height of the centre of a capsule that stands on a floor, m", &f);
}

/* Creates a body that moves freely along x. */
static int create_moving(pl_probe *p, double dt, double speed)
{
    pl_body body = pl_check_any_body(p);
    body.velocity[0] = speed;
    return pl_check_create_floating(p, dt, body);
}

/* Engines put a body to sleep that has been slow for about half a second or two. */
static void check_sleeping(pl_probe *p)
{
    const double speed = 0.005, dt = 1.0 / 50;
    enum { STEPS = 200 };
    const int index = create_moving(p, dt, speed);
    pl_probe_steps(p, STEPS);
    pl_probe_expect(p, "the path of a free body at 5 mm/s in 4 s, m",
                    p->now[index].position[0] - p->start[index].position[0], STEPS * dt * speed,
                    0.01 * STEPS * dt * speed,
                    "the engine puts slow bodies to sleep: switch sleeping or deactivation off");
}

static void check_frame_of_step(pl_probe *p)
{
    const double speed = 3, dt = 1.0 / 100;
    const int index = create_moving(p, dt, speed);
    for (int i = 1; i <= 2; ++i) {
        pl_probe_steps(p, 1);
        const double path = p->now[index].position[0] - p->start[index].position[0];
        const bool is_late = fabs(path - (i - 1) * speed * dt) < 0.1 * speed * dt;
        pl_probe_expect(p,
                        pl_probe_text(p, "the path of a body at 3 m/s in %d step%s of 1/100 s, m",
                                      i, i == 1 ? "" : "s"),
                        path, i * speed * dt, 0.1 * speed * dt,
                        is_late ? "read_frame gives the state before the step, such as that of a "
                                  "buffer which the engine exchanges with another"
                                : "the step, or the velocity that bodies begin with");
    }
}

const pl_check pl_place_checks[] = {
    {"turned-box", "a turned box rests on its own side", PL_NEEDS_BOX | PL_NEEDS_ROTATION, 0,
     check_turned_box, 0},
    {"capsule-stands", "a capsule stands on a cap", PL_NEEDS_CAPSULE | PL_NEEDS_ROTATION, 0,
     check_standing_capsule, 0},
    {"sleeping", "slow bodies go on moving", 0, 0, check_sleeping, 0},
    {"frame-of-step", "frames are of the state after the step", 0, 0, check_frame_of_step, 0},
    {0}};
