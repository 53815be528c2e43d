#include "engine_run.h"

#include "check.h"
#include "runner/run_once.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

int put_material(pl_scene *scene, const char *name, double friction, double restitution)
{
    pl_material item = {.friction = friction, .restitution = restitution};
    int index = -1;
    snprintf(item.name, sizeof item.name, "%s", name);
    assert_int_equal(pl_scene_add_material(scene, &item, &index, NULL), PL_OK);
    return index;
}

int put_body(pl_scene *scene, pl_body body)
{
    int index = -1;
    snprintf(body.name, sizeof body.name, "body %d", scene->body_count);
    assert_int_equal(pl_scene_add_body(scene, &body, &index, NULL), PL_OK);
    return index;
}

pl_body floor_body(void)
{
    pl_body body = pl_body_default();
    body.is_static = true;
    body.shape = pl_shape_plane(0, 0, 1, 0);
    return body;
}

pl_body box_body(double mass, double x, double y, double z)
{
    pl_body body = pl_body_default();
    body.mass = mass;
    body.shape = pl_shape_box(x, y, z);
    return body;
}

pl_scene scene_with_block(double friction, double mass, double half_width, double half_height)
{
    pl_scene scene = pl_scene_default();
    put_material(&scene, "stone", friction, 0);
    put_body(&scene, floor_body());
    pl_body block = box_body(mass, half_width, half_width, half_height);
    block.position[2] = half_height;
    put_body(&scene, block);
    return scene;
}

static void read_now(engine_run *r)
{
    pl_frame frame = {.body_count = r->scene->body_count, .bodies = r->now};
    pl_session_read_frame(&r->session, &frame);
    r->time = frame.time;
}

void engine_start(engine_run *r, const pl_engine_choice *choice, const pl_scene *scene)
{
    memset(r, 0, sizeof *r);
    r->choice = *choice;
    r->scene = scene;
    r->session = pl_session_begin(&r->choice);
    pl_error error = {.message = ""};
    assert_true(scene->body_count <= MOST_BODIES);
    pl_status status = pl_session_load(&r->session, &error);
    if (status == PL_OK) {
        status = pl_session_create(&r->session, scene, &error);
    }
    if (status != PL_OK) {
        print_error("%s: %s\n", choice->spec, error.message);
    }
    assert_int_equal(status, PL_OK);
    read_now(r);
}

void engine_step(engine_run *r)
{
    pl_error error = {.message = ""};
    memcpy(r->before, r->now, sizeof r->now);
    pl_status status = pl_session_step(&r->session, &r->stats, NULL, &error);
    if (status != PL_OK) {
        print_error("%s\n", error.message);
    }
    assert_int_equal(status, PL_OK);
    read_now(r);
    const pl_engine *engine = &r->session.loaded.table;
    r->contact_count = 0;
    if (engine->read_contacts != NULL) {
        r->contact_count = engine->read_contacts(r->session.instance, r->contacts, MOST_CONTACTS);
        assert_true(r->contact_count <= MOST_CONTACTS);
    }
    const pl_contact_times *table =
        engine->extension != NULL ? engine->extension(PL_CONTACT_TIMES) : NULL;
    r->has_times = table != NULL;
    if (table != NULL) {
        table->read(r->session.instance, r->times, r->contact_count);
    }
}

void engine_contact_arm(const engine_run *r, int i, int body, double arm[3])
{
    const pl_contact_place *acts = &r->times[i].acts;
    for (int k = 0; k < 3; ++k) {
        arm[k] = !r->has_times ? r->contacts[i].point[k] - r->before[body].position[k]
                 : r->contacts[i].body_b == body ? acts->arm_b[k]
                                                 : acts->arm_a[k];
    }
}

void engine_finish(engine_run *r)
{
    pl_session_end(&r->session);
}

void for_each_profile(void (*law)(const pl_engine_choice *choice))
{
    int count = 0, tried = 0;
    const pl_built_in *known = pl_built_in_engines(&count);
    for (int i = 0; i < count; ++i) {
        const pl_engine_info *engine = NULL;
        /* Engines that are not linked break some of these laws themselves: plumb check-engine finds it. */
        if (known[i].entry != NULL) {
            assert_int_equal(pl_engine_of_build(&known[i], &engine, NULL), PL_OK);
        }
        const bool has_boxes = engine != NULL && (engine->capabilities & PL_NEEDS_BOX) != 0;
        for (int p = 0; has_boxes && p < engine->profile_count; ++p) {
            pl_engine_choice choice;
            char spec[2 * PL_NAME_SIZE];
            snprintf(spec, sizeof spec, "%s:%s", known[i].name, engine->profiles[p].name);
            print_message("    %s\n", spec);
            assert_int_equal(pl_engine_choose(spec, &choice, NULL), PL_OK);
            law(&choice);
            ++tried;
        }
    }
    assert_true(tried > 0);
}

bool solves_coulomb(const pl_engine_choice *choice)
{
    return strcmp(choice->spec, "bullet:lemke") != 0;
}

static bool is_mujoco(const pl_engine_choice *choice)
{
    return strcmp(choice->engine->name, "mujoco") == 0;
}

double force_mismatch(const pl_engine_choice *choice)
{
    if (!is_mujoco(choice) || strcmp(choice->spec, "mujoco:pgs") == 0) {
        return 0;
    }
    return strcmp(choice->spec, "mujoco:cg") == 0 ? 2e-4 : 1e-8;
}

double depth_share(const pl_engine_choice *choice, pl_shape_kind a, pl_shape_kind b)
{
    return is_mujoco(choice) && a == PL_SHAPE_BOX && b == PL_SHAPE_BOX ? 0.5 : 1;
}

bool has_restitution(const pl_engine_choice *choice)
{
    return (choice->engine->capabilities & PL_NEEDS_RESTITUTION) != 0;
}

pl_scene scene_of_pairs(const pl_engine_choice *choice)
{
    const double share = has_restitution(choice) ? 1 : 0;
    pl_scene scene = pl_scene_default();
    put_material(&scene, "ice", 0.2, 0.1 * share);
    put_material(&scene, "rubber", 0.8, 0.9 * share);
    /* Not the product 0.16, the minimum, the maximum, either mean, nor a coefficient itself. */
    pl_material_pair pair = {
        .material_a = 1, .material_b = 0, .friction = 0.35, .restitution = 0.6 * share};
    assert_int_equal(pl_scene_add_pair(&scene, &pair, NULL), PL_OK);
    put_body(&scene, floor_body());
    return scene;
}
