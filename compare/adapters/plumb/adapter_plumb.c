/* The built-in engine behind the engine ABI. Uses only its public interface. */
#include "adapter_plumb.h"

#include "adapters/contact_problems.h"
#include "adapters/native.h"
#include "base/array.h"
#include "plumb/contact_problem.h"
#include "plumb/contact_times.h"
#include "plumb/engine.h"
#include "plumb/scenario.h"

#include <plumb_description.h>
#include <stdlib.h>
#include <string.h>

struct pl_engine_instance {
    const pl_scene *scene;
    pe_world *world;
    pe_body_id *bodies; /* (scene->body_count) */
    int *index_of;      /* (body_count + 1): scene index by body id */
    pe_contact *contacts;
    int contact_capacity;
    double time;
    bool forces_applied; /* those of the coming step */
};

static pe_vec3 vector(const double v[3])
{
    return (pe_vec3){v[0], v[1], v[2]};
}

static void store(double to[3], pe_vec3 v)
{
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
}

static pl_status translate(pe_status status, const pe_error *from, pl_error *error)
{
    if (status == PE_OK) {
        return PL_OK;
    }
    return pl_fail(error, status == PE_NO_MEMORY ? PL_NO_MEMORY : PL_FAILED, "%s", from->message);
}

/* Makes a geometry for each polyhedron of the scene, whose arrays the engine copies: its vectors are those of
 * the engine, and no index is negative. */
static pe_status add_geometries(pl_engine_instance *instance, pe_geometry_id *ids, pe_error *error)
{
    _Static_assert(sizeof(pe_vec3) == sizeof(double[3]), "a vector is three numbers");
    const pl_scene *scene = instance->scene;
    pe_status status = PE_OK;
    for (int i = 0; i < scene->polyhedron_count && status == PE_OK; ++i) {
        const pl_polyhedron *p = scene->polyhedra[i];
        const pe_geometry_def def = {
            .vertices = (const pe_vec3 *)p->vertices,
            .triangles = (const uint32_t(*)[3])p->triangles,
            .vertex_count = p->vertex_count,
            .triangle_count = p->triangle_count,
            .convex = p->convex,
        };
        status = pe_geometry_create(instance->world, &def, &ids[i], error);
    }
    return status;
}

static pe_shape shape_of(const pl_scene *scene, const pl_shape *shape, const pe_geometry_id *ids)
{
    static const pe_shape_kind kind_of[PL_SHAPE_KIND_COUNT] = {
        [PL_SHAPE_PLANE] = PE_SHAPE_PLANE,       [PL_SHAPE_SPHERE] = PE_SHAPE_SPHERE,
        [PL_SHAPE_BOX] = PE_SHAPE_BOX,           [PL_SHAPE_CAPSULE] = PE_SHAPE_CAPSULE,
        [PL_SHAPE_CYLINDER] = PE_SHAPE_CYLINDER, [PL_SHAPE_HULL] = PE_SHAPE_HULL,
        [PL_SHAPE_MESH] = PE_SHAPE_MESH,
    };
    const int geometry = pl_polyhedron_index(scene, shape->polyhedron);
    return (pe_shape){
        .kind = kind_of[shape->kind],
        .normal = vector(shape->normal),
        .offset = shape->offset,
        .radius = shape->radius,
        .half_height = shape->half_height,
        .half_extents = vector(shape->half_extents),
        .geometry = geometry < 0 ? (pe_geometry_id){0} : ids[geometry],
    };
}

static pe_status add_materials(pl_engine_instance *instance, pe_material_id *ids, pe_error *error)
{
    const pl_scene *scene = instance->scene;
    pe_status status = PE_OK;
    for (int i = 0; i < scene->material_count && status == PE_OK; ++i) {
        const pl_material *m = &scene->materials[i];
        status = pe_material_create(instance->world, m->friction, m->restitution, &ids[i], error);
    }
    for (int i = 0; i < scene->pair_count && status == PE_OK; ++i) {
        const pl_material_pair *p = &scene->pairs[i];
        status = pe_world_set_pair(instance->world, ids[p->material_a], ids[p->material_b],
                                   p->friction, p->restitution, error);
    }
    return status;
}

static pe_status add_bodies(pl_engine_instance *instance, const pe_material_id *materials,
                            const pe_geometry_id *geometries, pe_error *error)
{
    const pl_scene *scene = instance->scene;
    pe_status status = PE_OK;
    for (int i = 0; i < scene->body_count && status == PE_OK; ++i) {
        const pl_body *body = &scene->bodies[i];
        const double *q = body->orientation;
        pe_body_def def = {
            .shape = shape_of(scene, &body->shape, geometries),
            .is_static = body->is_static,
            .material = materials[body->material],
            .mass = body->mass,
            .inertia = vector(body->inertia),
            .position = vector(body->position),
            .orientation = {q[0], q[1], q[2], q[3]},
            .velocity = vector(body->velocity),
            .angular_velocity = vector(body->angular_velocity),
        };
        status = pe_body_create(instance->world, &def, &instance->bodies[i], error);
        if (status == PE_OK) {
            instance->index_of[instance->bodies[i].index] = i;
        }
    }
    return status;
}

static void destroy(pl_engine_instance *instance)
{
    if (instance != NULL) {
        pe_world_destroy(instance->world);
        free(instance->bodies);
        free(instance->index_of);
        free(instance->contacts);
        free(instance);
    }
}

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **made, pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const double *values = setup->values;
    static const pe_profile profile_of[] = {[PROFILE_DEFAULT] = PE_PROFILE_DEFAULT,
                                            [PROFILE_ACCURATE] = PE_PROFILE_ACCURATE,
                                            [PROFILE_FAST] = PE_PROFILE_FAST};
    pe_world_def def = pe_world_def_default();
    def.profile = profile_of[setup->profile];
    def.gravity = vector(scene->gravity);
    def.tolerance = values[OPTION_TOLERANCE];
    def.max_contact_updates = values[OPTION_UPDATES];
    def.max_iterations = (int)values[OPTION_ITERATIONS];
    def.penetration_slop = values[OPTION_SLOP];
    def.impact_bodies = (int)values[OPTION_IMPACT_BODIES];
    def.threads = (int)values[OPTION_THREADS];
    def.sleep = values[OPTION_SLEEP] != 0;

    pe_error failure;
    pe_status status = PE_OK;
    size_t count = (size_t)scene->body_count;
    pe_material_id *materials = calloc((size_t)scene->material_count + 1, sizeof *materials);
    pe_geometry_id *geometries = calloc((size_t)scene->polyhedron_count + 1, sizeof *geometries);
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance != NULL) {
        instance->scene = scene;
        instance->bodies = calloc(count + 1, sizeof *instance->bodies);
        instance->index_of = calloc(count + 1, sizeof *instance->index_of);
    }
    if (materials == NULL || geometries == NULL || instance == NULL || instance->bodies == NULL ||
        instance->index_of == NULL) {
        status = PE_NO_MEMORY;
        failure = (pe_error){PE_NO_MEMORY, "no memory for the scene"};
    }
    if (status == PE_OK) {
        status = pe_world_create(&def, &instance->world, &failure);
    }
    if (status == PE_OK) {
        status = add_materials(instance, materials, &failure);
    }
    if (status == PE_OK) {
        status = add_geometries(instance, geometries, &failure);
    }
    if (status == PE_OK) {
        status = add_bodies(instance, materials, geometries, &failure);
    }
    free(materials);
    free(geometries);
    if (status != PE_OK) {
        destroy(instance);
        return translate(status, &failure, error);
    }
    *made = instance;
    return PL_OK;
}

static pl_status apply_forces(pl_engine_instance *instance, double dt, pl_error *error)
{
    const pl_scene *scene = instance->scene;
    for (int i = 0; i < scene->force_count && !instance->forces_applied; ++i) {
        const pl_force *force = &scene->forces[i];
        pe_body_id body = instance->bodies[force->body];
        if (!pl_force_acts(force, instance->time, dt)) {
            continue;
        }
        pe_error failure;
        pe_status status = pe_body_apply_force(
            instance->world, body, vector(force->force), vector(force->at),
            force->frame == PL_FRAME_BODY ? PE_FRAME_BODY : PE_FRAME_WORLD, &failure);
        if (status != PE_OK) {
            return translate(status, &failure, error);
        }
    }
    instance->forces_applied = true;
    return PL_OK;
}

static pl_status capture(pl_engine_instance *instance, double dt, pe_contact_problem ***problems,
                         int *count, pl_error *error)
{
    pe_error failure;
    pl_status status = apply_forces(instance, dt, error);
    return status != PL_OK ? status
                           : translate(pe_world_capture_problems(instance->world, dt, problems,
                                                                 count, &failure),
                                       &failure, error);
}

static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    pl_status status = apply_forces(instance, dt, error);
    if (status != PL_OK) {
        return status;
    }
    pe_step_stats did;
    pe_error failure;
    status = translate(pe_world_step(instance->world, dt, &did, &failure), &failure, error);
    if (status != PL_OK) {
        return status;
    }
    instance->time += dt;
    instance->forces_applied = false;
    /* Soft contacts have neither, and those of the other islands are not the step's. */
    if (did.islands_by_path[PE_PATH_SOFT] == 0) {
        stats->iterations = did.iterations;
        stats->residual = did.residual;
    }
    stats->contacts = did.contacts;
    stats->islands = did.islands;
    stats->time_collide = did.time_broad_phase + did.time_narrow_phase + did.time_contacts;
    stats->time_solve = did.time_solve;
    stats->time_other = did.time_islands + did.time_integrate + did.time_project;
    return PL_OK;
}

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; ++i) {
        pe_body_state s = {0};
        pe_body_get_state(instance->world, instance->bodies[i], &s, NULL);
        pl_body_state *to = &frame->bodies[i];
        store(to->position, s.position);
        store(to->velocity, s.velocity);
        store(to->angular_velocity, s.angular_velocity);
        to->orientation[0] = s.orientation.w;
        to->orientation[1] = s.orientation.x;
        to->orientation[2] = s.orientation.y;
        to->orientation[3] = s.orientation.z;
    }
}

static void read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    pe_vec3 gravity;
    pe_world_get_gravity(instance->world, &gravity);
    store(settings->gravity, gravity);
    for (int i = 0; i < settings->body_count; ++i) {
        pe_vec3 inertia = {0};
        pe_body_get_mass(instance->world, instance->bodies[i], &settings->mass[i], &inertia, NULL);
        store(settings->inertia[i], inertia);
    }
}

static void read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                      pl_pair_coefficients *found)
{
    pe_body_get_pair(instance->world, instance->bodies[body_a], instance->bodies[body_b],
                     &found->friction, &found->restitution, NULL);
}

static int read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    /* The engine's own list, in a buffer that grows to what it needs. */
    pl_engine_instance *own = (pl_engine_instance *)instance;
    int count = pe_world_get_contacts(instance->world, own->contacts, own->contact_capacity);
    if (count > own->contact_capacity) {
        if (pl_array_reserve(&own->contacts, &own->contact_capacity, count, sizeof *own->contacts,
                             NULL) != PL_OK) {
            return 0;
        }
        pe_world_get_contacts(instance->world, own->contacts, count);
    }
    for (int i = 0; i < count && i < capacity; ++i) {
        const pe_contact *c = &own->contacts[i];
        contacts[i].body_a = own->index_of[c->body_a.index];
        contacts[i].body_b = own->index_of[c->body_b.index];
        contacts[i].separation = c->separation;
        store(contacts[i].point, c->point);
        store(contacts[i].normal, c->normal);
        store(contacts[i].impulse, c->impulse);
    }
    return count;
}

static void store_place(pl_contact_place *to, const pe_contact_place *from)
{
    store(to->arm_a, from->arm_a);
    store(to->arm_b, from->arm_b);
    store(to->normal, from->normal);
}

/* read_contacts was called just before. */
static void read_contact_times(const pl_engine_instance *instance, pl_contact_time *times,
                               int count)
{
    for (int i = 0; i < count; ++i) {
        const pe_contact *c = &instance->contacts[i];
        times[i].begin = c->begin;
        times[i].end = c->end;
        times[i].order = c->order;
        store_place(&times[i].acts, &c->acts);
        store_place(&times[i].holds, &c->holds);
    }
}

static const void *extension(const char *name)
{
    static const pl_contact_problems contact_problems = {.capture = capture};
    static const pl_contact_times contact_times = {.read = read_contact_times};
    return strcmp(name, PL_CONTACT_PROBLEMS) == 0 ? (const void *)&contact_problems
           : strcmp(name, PL_CONTACT_TIMES) == 0  ? &contact_times
                                                  : NULL;
}

const pl_engine *pl_engine_plumb(void)
{
    static const pl_engine engine = {
        ENGINE_DESCRIPTION,       .create = create,
        .destroy = destroy,       .step = step,
        .read_frame = read_frame, .read_settings = read_settings,
        .read_pair = read_pair,   .read_contacts = read_contacts,
        .extension = extension,
    };
    return &engine;
}
