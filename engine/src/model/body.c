/* Bodies: creation, destruction, state, and forces on them. */
#include "ranges.h"
#include "rest.h"
#include "shape.h"

pe_body_def pe_body_def_default(void)
{
    return (pe_body_def){
        .shape = {.kind = PE_SHAPE_SPHERE, .radius = 0.5},
        .mass = 1,
        .orientation = {.w = 1},
    };
}

static pe_status check_state(const pe_body_state *state, pe_error *error)
{
    pe_status status = pe_check_vector("position", state->position, PE_MOST_LENGTH, error);
    if (status == PE_OK) {
        status = pe_check_vector("velocity", state->velocity, PE_MOST_SPEED, error);
    }
    if (status == PE_OK) {
        status = pe_check_vector("angular_velocity", state->angular_velocity, PE_MOST_SPEED, error);
    }
    if (status != PE_OK) {
        return status;
    }
    pe_quat q = state->orientation;
    if (!(fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) <= 2e-6)) {
        return pe_fail(error, PE_BAD_ARGUMENT,
                       "orientation: expected a unit quaternion, found (%g, %g, %g, %g)", q.w, q.x,
                       q.y, q.z);
    }
    return PE_OK;
}

/* The geometry of a hull or mesh; NULL for other shapes. */
static pe_status find_geometry(const pe_world *world, const pe_shape *shape,
                               const pe_geometry **geometry, pe_error *error)
{
    *geometry = NULL;
    if (shape->kind != PE_SHAPE_HULL && shape->kind != PE_SHAPE_MESH) {
        return PE_OK;
    }
    *geometry = pe_geometry_of(world, shape->geometry);
    if (*geometry == NULL) {
        return pe_fail(error, PE_BAD_ARGUMENT, "no geometry %u in this world",
                       shape->geometry.index);
    }
    if (shape->kind == PE_SHAPE_HULL && !(*geometry)->convex) {
        return pe_fail(error, PE_BAD_ARGUMENT, "hull: its geometry was not made as a convex one");
    }
    return PE_OK;
}

static pe_status check_def(const pe_world *world, const pe_body_def *def,
                           const pe_geometry **geometry, pe_error *error)
{
    pe_status status;
    if ((status = pe_shape_check(&def->shape, error)) != PE_OK ||
        (status = find_geometry(world, &def->shape, geometry, error)) != PE_OK) {
        return status;
    }
    if (def->shape.kind == PE_SHAPE_PLANE && !def->is_static) {
        return pe_fail(error, PE_BAD_ARGUMENT, "a plane must be static");
    }
    if (def->material.index >= (uint32_t)world->material_count) {
        return pe_fail(error, PE_BAD_ARGUMENT, "no material %u in this world", def->material.index);
    }
    if (!def->is_static &&
        (status = pe_check_range("mass", def->mass, PE_LEAST_MASS, PE_MOST_MASS, error)) != PE_OK) {
        return status;
    }
    pe_vec3 i = def->inertia;
    bool given = i.x != 0 || i.y != 0 || i.z != 0;
    double least = pe_min(i.x, pe_min(i.y, i.z));
    if (given && !(pe_is_within(i, PE_MOST_INERTIA) && least >= PE_LEAST_INERTIA)) {
        return pe_fail(error, PE_BAD_ARGUMENT,
                       "inertia: expected three numbers in %g .. %g, or all 0, found (%g, %g, %g)",
                       PE_LEAST_INERTIA, PE_MOST_INERTIA, i.x, i.y, i.z);
    }
    return check_state(
        &(pe_body_state){def->position, def->orientation, def->velocity, def->angular_velocity},
        error);
}

static pe_mass mass_of(const pe_body_def *def, const pe_geometry *geometry)
{
    if (def->is_static) {
        return (pe_mass){0};
    }
    pe_vec3 i =
        def->inertia.x != 0 ? def->inertia : pe_shape_inertia(&def->shape, geometry, def->mass);
    return (pe_mass){
        .mass = def->mass,
        .inverse_mass = 1 / def->mass,
        .inertia = i,
        .spherical = i.x == i.y && i.y == i.z,
    };
}

/* The pose of the body's axes where its shape's frame is at the position and orientation. */
static pe_pose pose_of(const pe_geometry *geometry, pe_vec3 position, pe_quat orientation)
{
    pe_quat q = pe_quat_unit(orientation);
    if (geometry != NULL) {
        pe_mat3 shape = pe_matrix_of(q);
        position = pe_add(position, pe_rotate(&shape, geometry->frame.centre));
        q = pe_quat_unit(pe_quat_product(q, geometry->frame.orientation));
    }
    return (pe_pose){position, q, pe_matrix_of(q)};
}

/* The inverse of pose_of. */
static void place_of_shape(const pe_geometry *geometry, const pe_pose *pose, pe_vec3 *position,
                           pe_quat *orientation)
{
    *position = pose->position;
    *orientation = pose->orientation;
    if (geometry != NULL) {
        *orientation =
            pe_quat_product(pose->orientation, pe_quat_conjugate(geometry->frame.orientation));
        pe_mat3 shape = pe_matrix_of(*orientation);
        *position = pe_sub(pose->position, pe_rotate(&shape, geometry->frame.centre));
    }
}

/* Makes room for one slot more in every array of bodies. */
static pe_status reserve_slot(pe_world *world, pe_error *error)
{
    const struct {
        pe_array *array;
        size_t stride;
    } rows[] = {
        {&world->body_array, sizeof(pe_body)},     {&world->pose_array, sizeof(pe_pose)},
        {&world->twist_array, sizeof(pe_twist)},   {&world->mass_array, sizeof(pe_mass)},
        {&world->record_array, sizeof(pe_record)},
    };
    size_t used = (size_t)world->slot_count;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        pe_status status = pe_array_reserve(rows[i].array, &world->allocator, rows[i].stride,
                                            used + 1, used, error);
        if (status != PE_OK) {
            return status;
        }
    }
    return PE_OK;
}

pe_status pe_body_create(pe_world *world, const pe_body_def *def, pe_body_id *body, pe_error *error)
{
    *body = (pe_body_id){0};
    const pe_geometry *geometry;
    pe_status status = check_def(world, def, &geometry, error);
    if (status != PE_OK) {
        return status;
    }
    int slot = world->first_free;
    if (slot != 0) {
        world->first_free = pe_bodies(world)[slot].next_free;
    } else {
        status = reserve_slot(world, error);
        if (status != PE_OK) {
            return status;
        }
        slot = world->slot_count++;
        pe_bodies(world)[slot].generation = 0;
    }
    pe_body *made = &pe_bodies(world)[slot];
    *made = (pe_body){
        .shape = def->shape,
        .geometry = geometry,
        .bounding_radius = pe_shape_bounding_radius(&def->shape, geometry),
        .size = pe_shape_size(&def->shape, geometry),
        .material = (int)def->material.index,
        .generation = made->generation + 1,
        .alive = true,
        .is_static = def->is_static,
    };
    pe_poses(world)[slot] = pose_of(geometry, def->position, def->orientation);
    pe_twists(world)[slot] =
        def->is_static ? (pe_twist){0} : (pe_twist){def->velocity, def->angular_velocity};
    pe_masses(world)[slot] = mass_of(def, geometry);
    if (slot < world->applied_force_count) {
        ((pe_applied_force *)world->applied_force_array.items)[slot] = (pe_applied_force){0};
    }
    pe_records(world)[slot] = (pe_record){0};
    world->bodies_changed = world->rest->awake_stale = true;
    world->contacts_stale = true;
    *body = (pe_body_id){(uint32_t)slot, made->generation};
    return PE_OK;
}

static pe_status check_id(const pe_world *world, pe_body_id body, pe_error *error)
{
    if (body.index == 0 || body.index >= (uint32_t)world->slot_count ||
        !pe_bodies(world)[body.index].alive ||
        pe_bodies(world)[body.index].generation != body.generation) {
        return pe_fail(error, PE_BAD_ARGUMENT, "no living body has the id (%u, %u)", body.index,
                       body.generation);
    }
    return PE_OK;
}

/* Contacts of a destroyed body must not warm-start those of the next body in its slot. */
static void forget_contacts(pe_contacts *contacts, int slot)
{
    pe_manifold *manifolds = pe_manifolds(contacts);
    int kept = 0;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        if (manifolds[i].a != slot && manifolds[i].b != slot) {
            manifolds[kept++] = manifolds[i];
        }
    }
    contacts->manifold_count = kept;
}

static void forget_contacts_apart(pe_world *world, uint32_t slot)
{
    pe_contact *contacts = world->apart_array.items;
    int kept = 0;
    for (int i = 0; i < world->apart_count; ++i) {
        if (contacts[i].body_a.index != slot && contacts[i].body_b.index != slot) {
            contacts[kept++] = contacts[i];
        }
    }
    world->apart_count = kept;
}

pe_status pe_body_destroy(pe_world *world, pe_body_id body, pe_error *error)
{
    pe_status status = check_id(world, body, error);
    if (status != PE_OK) {
        return status;
    }
    int slot = (int)body.index;
    pe_body *gone = &pe_bodies(world)[slot];
    forget_contacts(&world->contacts, slot);
    forget_contacts(&world->solved, slot);
    forget_contacts_apart(world, body.index);
    pe_rest_forget(world, slot);
    world->bodies_changed = world->rest->awake_stale = true;
    world->contacts_stale = true;
    gone->alive = false;
    gone->next_free = world->first_free;
    world->first_free = slot;
    return PE_OK;
}

pe_status pe_body_get_state(const pe_world *world, pe_body_id body, pe_body_state *state,
                            pe_error *error)
{
    pe_status status = check_id(world, body, error);
    if (status == PE_OK) {
        const pe_twist *twist = &pe_twists(world)[body.index];
        place_of_shape(pe_bodies(world)[body.index].geometry, &pe_poses(world)[body.index],
                       &state->position, &state->orientation);
        state->velocity = twist->velocity;
        state->angular_velocity = twist->angular_velocity;
    }
    return status;
}

pe_status pe_body_set_state(pe_world *world, pe_body_id body, const pe_body_state *state,
                            pe_error *error)
{
    pe_status status = check_id(world, body, error);
    if (status == PE_OK) {
        status = check_state(state, error);
    }
    if (status == PE_OK) {
        pe_poses(world)[body.index] =
            pose_of(pe_bodies(world)[body.index].geometry, state->position, state->orientation);
        if (!pe_bodies(world)[body.index].is_static) {
            pe_twists(world)[body.index] = (pe_twist){state->velocity, state->angular_velocity};
        }
        world->contacts_stale = true;
    }
    return status;
}

pe_status pe_body_get_mass(const pe_world *world, pe_body_id body, double *mass, pe_vec3 *inertia,
                           pe_error *error)
{
    pe_status status = check_id(world, body, error);
    if (status == PE_OK) {
        *mass = pe_masses(world)[body.index].mass;
        *inertia = pe_masses(world)[body.index].inertia;
    }
    return status;
}

pe_status pe_body_get_pair(const pe_world *world, pe_body_id a, pe_body_id b, double *friction,
                           double *restitution, pe_error *error)
{
    pe_status status = check_id(world, a, error);
    if (status == PE_OK) {
        status = check_id(world, b, error);
    }
    if (status == PE_OK) {
        const pe_body *bodies = pe_bodies(world);
        const pe_material_pair *pair =
            pe_material_pair_of(world, bodies[a.index].material, bodies[b.index].material);
        *friction = pair->friction;
        *restitution = pair->restitution;
    }
    return status;
}

/* Has an item for the body in the array of applied forces. */
static pe_status make_applied_force(pe_world *world, int slot, pe_applied_force **applied,
                                    pe_error *error)
{
    const size_t used = (size_t)world->applied_force_count, slots = (size_t)world->slot_count;
    if (slot >= world->applied_force_count) {
        pe_status status = pe_array_reserve(&world->applied_force_array, &world->allocator,
                                            sizeof **applied, slots, used, error);
        if (status != PE_OK) {
            return status;
        }
        pe_applied_force *items = world->applied_force_array.items;
        memset(items + used, 0, (slots - used) * sizeof *items);
        world->applied_force_count = world->slot_count;
    }
    *applied = (pe_applied_force *)world->applied_force_array.items + slot;
    return PE_OK;
}

pe_status pe_body_apply_force(pe_world *world, pe_body_id body, pe_vec3 force, pe_vec3 offset,
                              pe_frame frame, pe_error *error)
{
    pe_status status = check_id(world, body, error);
    if (status != PE_OK) {
        return status;
    }
    if ((status = pe_check_vector("force", force, PE_MOST_MASS, error)) != PE_OK ||
        (status = pe_check_vector("offset", offset, PE_MOST_LENGTH, error)) != PE_OK) {
        return status;
    }
    pe_applied_force *applied;
    if ((status = make_applied_force(world, (int)body.index, &applied, error)) != PE_OK) {
        return status;
    }
    world->has_applied_forces = true;
    if (frame == PE_FRAME_BODY) {
        const pe_geometry *geometry = pe_bodies(world)[body.index].geometry;
        if (geometry != NULL) {
            force = pe_unrotate(&geometry->rotation, force);
            offset = pe_unrotate(&geometry->rotation, offset);
        }
        applied->body_force = pe_add(applied->body_force, force);
        applied->body_torque = pe_add(applied->body_torque, pe_cross(offset, force));
        applied->rotates = true;
    } else {
        applied->force = pe_add(applied->force, force);
        applied->torque = pe_add(applied->torque, pe_cross(offset, force));
    }
    return PE_OK;
}
