/* An engine that keeps everything in floats, which it declares: after every step its state, and
 * everything that is read of it, is rounded to them. */
#include "fault_variant.h"

static void round_all(double *numbers, int count)
{
    for (int i = 0; i < count; ++i) {
        numbers[i] = (double)(float)numbers[i];
    }
}

static void round_state(pl_body_state *state)
{
    round_all(state->position, 3);
    round_all(state->orientation, 4);
    round_all(state->velocity, 3);
    round_all(state->angular_velocity, 3);
}

static void round_setup(variant_instance *v)
{
    round_all(v->scene.gravity, 3);
    for (int i = 0; i < v->scene.body_count; ++i) {
        pl_body *body = &v->scene.bodies[i];
        round_all(&body->mass, 1);
        round_all(body->inertia, 3);
        round_all(body->position, 3);
        round_all(body->velocity, 3);
        round_all(body->angular_velocity, 3);
    }
    for (int i = 0; i < v->scene.material_count * v->scene.material_count; ++i) {
        round_all(&v->pairs[i].friction, 1);
        round_all(&v->pairs[i].restitution, 1);
    }
    variant_use_pairs(v);
}

static pl_status step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    const pl_status status = variant_step(v, (double)(float)dt, stats, error);
    for (int i = 0; i < v->scene.body_count; ++i) {
        round_state(&v->states[i]);
    }
    return status != PL_OK ? status : variant_restart(v, error);
}

static void round_frame(const variant_instance *v, pl_frame *frame)
{
    (void)v;
    round_all(&frame->time, 1);
    for (int i = 0; i < frame->body_count; ++i) {
        round_state(&frame->bodies[i]);
    }
}

static int round_contacts(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    for (int i = 0; i < count; ++i) {
        round_all(contacts[i].point, 3);
        round_all(contacts[i].normal, 3);
        round_all(&contacts[i].separation, 1);
        round_all(contacts[i].impulse, 3);
    }
    return count;
}

static void round_settings(const variant_instance *v, pl_engine_settings *settings)
{
    (void)v;
    round_all(settings->gravity, 3);
    round_all(&settings->dt, 1);
    round_all(settings->mass, settings->body_count);
    for (int i = 0; i < settings->body_count; ++i) {
        round_all(settings->inertia[i], 3);
    }
}

static void round_pair(const variant_instance *v, pl_pair_coefficients *pair)
{
    (void)v;
    round_all(&pair->friction, 1);
    round_all(&pair->restitution, 1);
}

static const variant variants[] = {{.name = "default",
                                    .help = "single precision",
                                    .change_setup = round_setup,
                                    .step = step,
                                    .change_frame = round_frame,
                                    .change_contacts = round_contacts,
                                    .change_settings = round_settings,
                                    .change_pair = round_pair}};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    static pl_engine engine;
    engine = variant_engine("float", variants, 1);
    engine.precision = PL_PRECISION_FLOAT;
    return &engine;
}
