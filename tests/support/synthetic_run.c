#include "synthetic_run.h"

#include "check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void run_add_body(run *r, const char *name, pl_shape shape, bool is_static, double x, double z)
{
    pl_body body = pl_body_default();
    (void)snprintf(body.name, sizeof body.name, "%s", name);
    body.is_static = is_static;
    body.shape = shape;
    body.mass = 2;
    body.position[0] = x;
    body.position[2] = z;
    assert_int_equal(pl_scene_add_body(&r->scene, &body, NULL, NULL), PL_OK);
}

void run_prepare(run *r, double duration)
{
    memset(r, 0, sizeof *r);
    r->scene = pl_scene_default();
    r->scene.dt = H;
    r->scene.duration = duration;
    r->stats.iterations = r->stats.residual = r->stats.contacts = nan("");
    const pl_material stone = {.name = "stone", .friction = 0.5};
    assert_int_equal(pl_scene_add_material(&r->scene, &stone, NULL, NULL), PL_OK);
}

void run_expect_rest(run *r, int body)
{
    pl_expect_rest rest = {.body = body, .orientation = {1, 0, 0, 0}, .has_orientation = true};
    memcpy(rest.position, r->scene.bodies[body].position, sizeof rest.position);
    assert_int_equal(pl_scene_add_rest(&r->scene, &rest, NULL), PL_OK);
}

void run_expect_travel(run *r, int body, double distance, double discrete)
{
    pl_expect_travel travel = {
        .body = body, .direction = {1, 0, 0}, .distance = distance, .discrete = discrete};
    assert_int_equal(pl_scene_add_travel(&r->scene, &travel, NULL), PL_OK);
}

pl_frame run_frame(run *r)
{
    return (pl_frame){.body_count = r->scene.body_count, .bodies = r->state};
}

void run_begin(run *r)
{
    for (int i = 0; i < r->scene.body_count; ++i) {
        const pl_body *body = &r->scene.bodies[i];
        memcpy(r->state[i].position, body->position, sizeof body->position);
        memcpy(r->state[i].orientation, body->orientation, sizeof body->orientation);
        memcpy(r->state[i].velocity, body->velocity, sizeof body->velocity);
        memcpy(r->state[i].angular_velocity, body->angular_velocity, sizeof body->angular_velocity);
    }
    r->referee = pl_referee_create(&r->scene, 1);
    pl_frame frame = run_frame(r);
    assert_int_equal(pl_referee_start(r->referee, &r->engine, &frame), PL_ENDING_OK);
}

pl_ending run_step_with(run *r, const pl_contact *contacts, int count)
{
    return pl_referee_step(r->referee,
                           &(pl_step){.after = r->state,
                                      .stats = &r->stats,
                                      .contacts = contacts,
                                      .contact_count = count,
                                      .cpu_time = 1e-3},
                           &r->error);
}

pl_ending run_step(run *r)
{
    return run_step_with(r, NULL, -1);
}

void run_step_many(run *r, long count)
{
    for (long i = 0; i < count; ++i) {
        assert_int_equal(run_step(r), PL_ENDING_OK);
    }
}

pl_ending run_finish(run *r)
{
    return pl_referee_finish(r->referee, "m/s", &r->metrics, &r->note, &r->error);
}

void run_end(run *r)
{
    pl_referee_destroy(r->referee);
    pl_scene_free(&r->scene);
}

const pl_metric *run_metric(const run *r, pl_metric_id id)
{
    return &r->metrics.item[id];
}

double run_value(const run *r, pl_metric_id id)
{
    const pl_metric *m = run_metric(r, id);
    if (m->state != PL_METRIC_VALUE) {
        print_error("%s has no value: %s\n", pl_metric_table[id].name, m->reason);
        fail();
    }
    return m->value;
}

void run_prepare_box_on_floor(run *r, double duration)
{
    run_prepare(r, duration);
    run_add_body(r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(r, "box", pl_shape_box(0.5, 0.5, 0.5), false, 0, 0.5);
    run_expect_rest(r, 1);
    (void)snprintf(r->scene.primary_error, sizeof r->scene.primary_error, "rest_position_error");
}
