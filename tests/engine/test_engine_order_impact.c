/* The order of accuracy of impacts, and how dropped bodies come to rest. */
#include "check.h"
#include "motion_order.h"
#include "motion_vectors.h"

/* Height of the lowest point of a box, or of a sphere. */
static double lowest(const pe_body_state *s, const pe_shape *shape)
{
    if (shape->kind == PE_SHAPE_SPHERE) {
        return s->position.z - shape->radius;
    }
    double down = 0;
    for (int k = 0; k < 3; ++k) {
        pe_vec3 axis = turn(s->orientation, (pe_vec3){k == 0, k == 1, k == 2});
        const pe_vec3 h = shape->half_extents;
        down += (k == 0 ? h.x : k == 1 ? h.y : h.z) * fabs(axis.z);
    }
    return s->position.z - down;
}

/* What a drop came to, at the worst of all steps. */
typedef struct landing {
    double sunk, off, speed, crept; /* m below the plane ever, m from it at rest, m/s, m or rad */
} landing;

static landing drop(const char *name, pe_body_def def)
{
    static const double steps[] = {1.0 / 30, 1.0 / 60, 0.013, 1.0 / 120, 1.0 / 240, 1.0 / 480};
    landing worst = {0};
    for (int k = 0; k < 6; ++k) {
        double h = steps[k], sunk = 0, crept = 0;
        on_plane p = put_on_plane(slope_gravity(0), 0.5, 0, def);
        int settle = (int)(8 / h);
        for (int i = 0; i < settle; ++i) {
            step(p.world, h);
            pe_body_state s = state_of(p.world, p.body);
            sunk = fmax(sunk, -lowest(&s, &def.shape));
        }
        pe_body_state rest = state_of(p.world, p.body);
        double off = lowest(&rest, &def.shape);
        double speed = fmax(length(rest.velocity), length(rest.angular_velocity));
        for (int i = 0; i < 200; ++i) {
            step(p.world, h);
            pe_body_state s = state_of(p.world, p.body);
            crept = fmax(crept, distance(s.position, rest.position));
            crept = fmax(crept, angle_between(s.orientation, rest.orientation));
        }
        print_message("%s, h = 1/%.0f: sinks in by %.1e m, comes to rest at %.1e m with %.1e m/s, "
                      "then creeps by %.1e\n",
                      name, 1 / h, sunk, off, speed, crept);
        worst = (landing){fmax(worst.sunk, sunk), fmax(worst.off, fabs(off)),
                          fmax(worst.speed, speed), fmax(worst.crept, crept)};
        pe_world_destroy(p.world);
    }
    return worst;
}

/* The bound on speed is the tolerance of the solver. */
static void assert_soft_landing(landing l)
{
    assert_at_most(l.sunk, 1e-6);
    assert_at_most(l.off, 1e-6);
    assert_at_most(l.speed, 1e-8);
    assert_at_most(l.crept, 1e-10);
}

static void test_what_drops_does_not_sink_in_and_rests(void **state)
{
    (void)state;
    assert_soft_landing(drop("sphere", sphere_def(0.5, 1.7)));
    assert_soft_landing(drop("box, flat", box_def(0.5, 0.3, 0.2, (pe_vec3){0, 0, 1.3})));
}

static void test_box_dropped_on_its_corner_rests(void **state)
{
    (void)state;
    pe_body_def tilted = box_def(0.5, 0.3, 0.2, (pe_vec3){0, 0, 1.3});
    tilted.orientation = rotation_of((pe_vec3){0.4, 0.3, 0.1});
    assert_soft_landing(drop("box, on its corner", tilted));
}

/* The first apex after a fall from `height`: z + v^2/2g of the flight, the integrator being exact
 * between impacts. */
static double apex_after_bounce(double height, double restitution, double h)
{
    double radius = 0.1;
    on_plane p =
        put_on_plane(slope_gravity(0), 0, restitution, sphere_def(radius, radius + height));
    double apex = 0;
    for (int i = 0; i * h < 5; ++i) {
        step(p.world, h);
        pe_body_state s = state_of(p.world, p.body);
        if (s.velocity.z > 0) {
            apex = s.position.z - radius + s.velocity.z * s.velocity.z / (2 * GRAVITY);
            break;
        }
    }
    pe_world_destroy(p.world);
    return apex;
}

/* Where within the step the impact falls is chance: the largest error of many heights. */
static void test_the_apex_of_a_bounce_is_first_order(void **state)
{
    (void)state;
    enum { HEIGHTS = 41 };
    double error[STEP_SIZES] = {0}, e = 0.5;
    for (int k = 0; k < STEP_SIZES; ++k) {
        for (int i = 0; i < HEIGHTS; ++i) {
            double height = 1 + 0.01 * i;
            double apex = apex_after_bounce(height, e, order_step(k));
            error[k] = fmax(error[k], fabs(apex - e * e * height));
        }
    }
    assert_order("bounce with e = 0.5: apex, worst of 41", error, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_drops_does_not_sink_in_and_rests),
        cmocka_unit_test(test_box_dropped_on_its_corner_rests),
        cmocka_unit_test(test_the_apex_of_a_bounce_is_first_order),
    };
    return cmocka_run_group_tests_name("engine_order_impact", tests, NULL, NULL);
}
