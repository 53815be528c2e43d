#include "reported_values.h"

#include "base/diagnostic.h"

#include <float.h>
#include <math.h>

/* A normal in single precision is a unit vector to 1e-7; beyond this one it is none at all. */
static const double UNIT = 1e-3;

/* No engine counts further in a step. */
static const double MOST_COUNTED = 1e12;

pl_status pl_check_stats(const pl_step_stats *stats, long step, pl_error *error)
{
    const struct {
        const char *name;
        double value, most;
    } numbers[] = {{"iterations", stats->iterations, MOST_COUNTED},
                   {"as residual", stats->residual, DBL_MAX},
                   {"contacts", stats->contacts, MOST_COUNTED},
                   {"islands", stats->islands, MOST_COUNTED},
                   {"s as time_collide", stats->time_collide, DBL_MAX},
                   {"s as time_solve", stats->time_solve, DBL_MAX},
                   {"s as time_other", stats->time_other, DBL_MAX}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; ++i) {
        const double value = numbers[i].value;
        if (!isnan(value) && !(value >= 0 && value <= numbers[i].most)) {
            return pl_fail(error, PL_FAILED, "the engine reports %g %s at step %ld", value,
                           numbers[i].name, step);
        }
    }
    return PL_OK;
}

static bool is_finite(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* The name of the first number of a contact that is not finite, or NULL. */
static const char *infinite_part(const pl_contact *c, uint32_t reported)
{
    if (!is_finite(c->point)) {
        return "point";
    }
    if (!is_finite(c->normal)) {
        return "normal";
    }
    if (!isfinite(c->separation)) {
        return "separation";
    }
    if ((reported & PL_CONTACTS_IMPULSES) != 0 && !is_finite(c->impulse)) {
        return "impulse";
    }
    return (reported & PL_CONTACTS_TORQUES) != 0 && !is_finite(c->torque) ? "torque" : NULL;
}

static pl_status check_contact(const pl_contact *c, uint32_t reported, int body_count, long step,
                               pl_error *error)
{
    const int bodies[] = {c->body_a, c->body_b};
    for (int i = 0; i < 2; ++i) {
        if (bodies[i] < 0 || bodies[i] >= body_count) {
            return pl_fail(error, PL_FAILED,
                           "the engine reports a contact of body %d at step %ld, and the scene has "
                           "bodies 0 to %d",
                           bodies[i], step, body_count - 1);
        }
    }
    if (c->body_a == c->body_b) {
        return pl_fail(error, PL_FAILED,
                       "the engine reports a contact of body %d with itself at step %ld", c->body_a,
                       step);
    }
    const char *invalid = infinite_part(c, reported);
    if (invalid != NULL) {
        return pl_fail(error, PL_FAILED,
                       "the engine reports a contact of bodies %d and %d at step %ld whose %s is "
                       "not finite",
                       c->body_a, c->body_b, step, invalid);
    }
    const double *n = c->normal, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(fabs(length - 1) <= UNIT)) {
        return pl_fail(error, PL_FAILED,
                       "the engine reports a contact of bodies %d and %d at step %ld whose normal "
                       "has the length %g",
                       c->body_a, c->body_b, step, length);
    }
    return PL_OK;
}

pl_status pl_check_contacts(const pl_contact *contacts, int count, uint32_t reported,
                            int body_count, long step, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = check_contact(&contacts[i], reported, body_count, step, error);
    }
    return status;
}

static bool is_place(const pl_contact_place *place)
{
    const double *n = place->normal, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return is_finite(place->arm_a) && is_finite(place->arm_b) && fabs(length - 1) <= UNIT;
}

pl_status pl_check_contact_times(const pl_contact_time *times, int count, double dt, long step,
                                 pl_error *error)
{
    for (int i = 0; i < count; ++i) {
        const pl_contact_time *t = &times[i];
        if (!(t->begin >= 0 && t->begin <= t->end && t->end <= dt * (1 + UNIT))) {
            return pl_fail(error, PL_FAILED,
                           "the engine reports at step %ld, of %g s, that a contact acted from %g "
                           "to %g s",
                           step, dt, t->begin, t->end);
        }
        if (!is_place(&t->acts) || !is_place(&t->holds)) {
            return pl_fail(
                error, PL_FAILED,
                "the engine reports at step %ld a contact whose place has an arm that is "
                "not finite or a normal that is no unit vector",
                step);
        }
    }
    return PL_OK;
}
