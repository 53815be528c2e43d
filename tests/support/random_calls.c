/* What random calls are made of, and whether the laws of the interface hold. */
#include "random_calls.h"

#include "model/world.h"
#include "plumb/contact_problem.h"
#include "solid_forms.h"
#include "step_laws.h"

#include <stdio.h>
#include <string.h>

enum { MOST_BODIES = 12, MOST_STEPS = 24, MOST_GEOMETRIES = 4, MOST_MATERIALS = 4, CONTACTS = 64 };

/* Of its energy that a world may gain. Where a body is farther out, or turns by more in a step, rounding
 * or the rotation within the step may be more. m, rad. */
static const double GAIN = 0.02, FAR = 1e3, RESOLVED = 0.5;

/* Penetration of bodies that do not overlap, m: pushing out more is work. */
static const double TOUCHING = 1e-5;

enum { ENOUGH_ITERATIONS = 200 };

/* No point of a body that falls asleep is faster, m/s. */
static const double SLEEP_SPEED = 0.05;

typedef struct run {
    const uint8_t *bytes;
    size_t size, at;
    pe_world *world;
    pe_vec3 gravity;
    pe_body_id ids[MOST_BODIES]; /* null: none */
    double push[MOST_BODIES];    /* N, applied for the next step */
    double mass[MOST_BODIES];
    bool twisted[MOST_BODIES], is_static[MOST_BODIES];
    pe_body_state before[MOST_BODIES], after[MOST_BODIES];
    bool overlap; /* bodies may overlap since the last step */
    bool solves;  /* the world may iterate as often as it needs to */
    pe_body_id dead;
    pe_geometry_id geometries[MOST_GEOMETRIES];
    bool convex[MOST_GEOMETRIES];
    pe_material_id materials[MOST_MATERIALS];
    int geometry_count, material_count;
    random_calls_found *found;
} run;

/* ---- Numbers from bytes ---- */

/* 0 after the last byte. */
static unsigned draw(run *r)
{
    return r->at < r->size ? r->bytes[r->at++] : 0;
}

/* In [0, 1). */
static double part(run *r)
{
    unsigned high = draw(r);
    return (256.0 * high + draw(r)) / 65536;
}

static double within(run *r, double low, double high)
{
    return low + (high - low) * part(r);
}

static double log_within(run *r, double low, double high)
{
    return low * exp(part(r) * log(high / low));
}

/* Each component is often zero, so that things line up. */
static pe_vec3 vector(run *r, double reach)
{
    pe_vec3 v = {0, 0, 0};
    unsigned which = draw(r);
    v.x = which & 1 ? within(r, -reach, reach) : 0;
    v.y = which & 2 ? within(r, -reach, reach) : 0;
    v.z = which & 4 ? within(r, -reach, reach) : 0;
    return v;
}

static pe_quat turn(run *r)
{
    pe_vec3 v = vector(r, 1);
    return pe_quat_unit((pe_quat){1, v.x, v.y, v.z});
}

/* ---- Laws ---- */

static bool holds(const run *r)
{
    return r->found->broken[0] == 0;
}

static void breaks(run *r, const char *law, int body, double found)
{
    if (holds(r)) {
        snprintf(r->found->broken, sizeof r->found->broken, "%s: step %d, body %d, found %.9g", law,
                 r->found->steps, body, found);
    }
}

/* What the interface must answer to a call. */
static bool expect(run *r, pe_status found, pe_status expected, const char *call)
{
    r->found->calls += 1;
    r->found->refused += found != PE_OK;
    if (found != expected) {
        breaks(r, call, -1, found);
    }
    return found == PE_OK && expected == PE_OK;
}

/* ---- Making things ---- */

/* One number in 32 is not in its range. */
static double maybe_bad(run *r, double good, bool *bad)
{
    static const double BAD[] = {(double)NAN, -1, 1e300, (double)INFINITY};
    const unsigned b = draw(r);
    *bad |= b < 8;
    return b < 8 ? BAD[b % 4] : good;
}

static void make_world(run *r, pe_profile profile)
{
    const pe_world_def usual = pe_world_def_default();
    pe_world_def def = usual;
    bool bad = false;
    const unsigned which = draw(r);
    def.profile = profile;
    def.threads = which & 1 ? 2 : 1;
    def.sleep = which & 2;
    def.gravity.z = which & 4 ? -9.81 : 0;
    if (which & 8) {
        def.tolerance = maybe_bad(r, log_within(r, 1e-12, 1), &bad);
        def.max_contact_updates = maybe_bad(r, log_within(r, 1, 1e7), &bad);
        def.max_iterations = (int)log_within(r, 1, 1e4);
        def.impact_bodies = (int)draw(r) % 16;
    }
    if (which & 16) {
        def.restitution_threshold = maybe_bad(r, log_within(r, 1e-6, 10), &bad);
        def.contact_margin = maybe_bad(r, log_within(r, 1e-9, 10), &bad);
        def.penetration_slop = maybe_bad(r, log_within(r, 1e-9, 1), &bad);
    }
    expect(r, pe_world_create(&def, &r->world, NULL), bad ? PE_BAD_ARGUMENT : PE_OK,
           "pe_world_create");
    if (bad && holds(r)) {
        def = usual;
        def.profile = profile;
        expect(r, pe_world_create(&def, &r->world, NULL), PE_OK, "pe_world_create");
    }
    r->gravity = def.gravity;
    r->solves = def.max_iterations >= ENOUGH_ITERATIONS && def.tolerance <= 1e-3;
}

static void make_material(run *r)
{
    if (r->material_count < MOST_MATERIALS) {
        bool bad = false;
        const double friction = maybe_bad(r, within(r, 0, 2), &bad);
        const double restitution = maybe_bad(r, within(r, 0, 1), &bad);
        pe_material_id *id = &r->materials[r->material_count];
        r->material_count +=
            expect(r, pe_material_create(r->world, friction, restitution, id, NULL),
                   bad ? PE_BAD_ARGUMENT : PE_OK, "pe_material_create");
    }
}

static void set_pair(run *r)
{
    if (r->material_count > 0) {
        bool bad = false;
        const unsigned count = (unsigned)r->material_count, a = draw(r) % count,
                       b = draw(r) % count;
        const double friction = maybe_bad(r, within(r, 0, 2), &bad);
        const double restitution = within(r, 0, 1);
        expect(r,
               pe_world_set_pair(r->world, r->materials[a], r->materials[b], friction, restitution,
                                 NULL),
               bad ? PE_BAD_ARGUMENT : PE_OK, "pe_world_set_pair");
    }
}

static void make_geometry(run *r)
{
    if (r->geometry_count == MOST_GEOMETRIES) {
        return;
    }
    const unsigned kind = draw(r) % 5;
    form f = kind == 0   ? form_tetrahedron()
             : kind == 1 ? form_frustum(3 + (int)(draw(r) % 8), within(r, 0.1, 1.5), 0)
             : kind == 2 ? form_icosahedron()
             : kind == 3 ? form_l_shape()
                         : form_torus(1, 0.4, 7, 5);
    const bool convex = kind < 3 && draw(r) % 2 == 0, open = draw(r) < 8;
    form_scale(&f, pe_v3(log_within(r, 0.05, 1), log_within(r, 0.05, 1), log_within(r, 0.05, 1)));
    const pe_geometry_def def = {.vertices = f.vertices,
                                 .triangles = (const uint32_t(*)[3])f.triangles,
                                 .vertex_count = f.vertex_count,
                                 .triangle_count = f.triangle_count - open,
                                 .convex = convex};
    r->convex[r->geometry_count] = convex;
    r->geometry_count +=
        expect(r, pe_geometry_create(r->world, &def, &r->geometries[r->geometry_count], NULL),
               open ? PE_BAD_ARGUMENT : PE_OK, "pe_geometry_create");
}

static pe_shape make_shape(run *r)
{
    pe_shape s = {.kind = (pe_shape_kind)(draw(r) % PE_SHAPE_COUNT), .normal = {0, 0, 1}};
    if (s.kind >= PE_SHAPE_HULL) {
        const unsigned i = r->geometry_count > 0 ? draw(r) % (unsigned)r->geometry_count : 0;
        s.kind = r->geometry_count == 0 ? PE_SHAPE_BOX
                 : r->convex[i]         ? PE_SHAPE_HULL
                                        : PE_SHAPE_MESH;
        s.geometry = r->geometries[i];
    }
    s.offset = s.kind == PE_SHAPE_PLANE ? within(r, -2, 0) : 0;
    s.radius = log_within(r, 0.02, 2);
    s.half_height = log_within(r, 0.02, 2);
    s.half_extents = pe_v3(s.radius, s.half_height, log_within(r, 0.02, 2));
    if (s.kind == PE_SHAPE_PLANE && draw(r) % 4 == 0) {
        const pe_mat3 rotation = pe_matrix_of(turn(r));
        s.normal = pe_axis(&rotation, 2);
    }
    return s;
}

static void read_motion(run *r, pe_body_state *s)
{
    s->position = vector(r, 2);
    s->orientation = turn(r);
    const unsigned moving = draw(r);
    if (moving & 1) {
        s->velocity = vector(r, moving < 16 ? 1e12 : log_within(r, 1e-3, 100));
        s->angular_velocity = vector(r, moving < 24 ? 1e12 : log_within(r, 1e-3, 100));
    }
}

static void make_body(run *r)
{
    int i = 0;
    while (i < MOST_BODIES && r->ids[i].index != 0) {
        ++i;
    }
    if (i == MOST_BODIES) {
        return;
    }
    pe_body_def def = pe_body_def_default();
    pe_body_state motion = {.orientation = {1, 0, 0, 0}};
    bool bad = false;
    def.shape = make_shape(r);
    const unsigned fixed = draw(r);
    def.is_static = def.shape.kind == PE_SHAPE_PLANE || fixed < 48;
    def.mass = def.is_static ? 1 : maybe_bad(r, log_within(r, 1e-6, 1e6), &bad);
    def.material.index =
        r->material_count > 0 ? r->materials[fixed % (unsigned)r->material_count].index : 0;
    read_motion(r, &motion);
    def.position = motion.position;
    def.orientation = motion.orientation;
    def.velocity = motion.velocity;
    def.angular_velocity = motion.angular_velocity;
    pe_body_id id;
    if (expect(r, pe_body_create(r->world, &def, &id, NULL), bad ? PE_BAD_ARGUMENT : PE_OK,
               "pe_body_create")) {
        r->ids[i] = id;
        r->overlap = true;
        r->push[i] = 0;
        r->mass[i] = def.mass;
        r->twisted[i] = false;
        r->is_static[i] = def.is_static;
    }
}

/* ---- Using them ---- */

/* Of a living body; -1: there is none. */
static int choose(run *r)
{
    for (unsigned first = draw(r), k = 0; k < MOST_BODIES; ++k) {
        const int i = (int)((first + k) % MOST_BODIES);
        if (r->ids[i].index != 0) {
            return i;
        }
    }
    return -1;
}

static void destroy_body(run *r)
{
    const int i = choose(r);
    if (i >= 0) {
        r->dead = r->ids[i];
        r->ids[i] = (pe_body_id){0};
        r->found->destroyed +=
            expect(r, pe_body_destroy(r->world, r->dead, NULL), PE_OK, "pe_body_destroy");
    }
}

static void use_dead_body(run *r)
{
    pe_body_state s = {.orientation = {1, 0, 0, 0}};
    const pe_vec3 zero = {0, 0, 0};
    double mass;
    pe_vec3 inertia;
    expect(r, pe_body_destroy(r->world, r->dead, NULL), PE_BAD_ARGUMENT, "pe_body_destroy, dead");
    expect(r, pe_body_get_state(r->world, r->dead, &s, NULL), PE_BAD_ARGUMENT,
           "pe_body_get_state, dead");
    expect(r, pe_body_set_state(r->world, r->dead, &s, NULL), PE_BAD_ARGUMENT,
           "pe_body_set_state, dead");
    expect(r, pe_body_get_mass(r->world, r->dead, &mass, &inertia, NULL), PE_BAD_ARGUMENT,
           "pe_body_get_mass, dead");
    expect(r, pe_body_apply_force(r->world, r->dead, zero, zero, PE_FRAME_WORLD, NULL),
           PE_BAD_ARGUMENT, "pe_body_apply_force, dead");
}

static void set_state(run *r)
{
    const int i = choose(r);
    pe_body_state s = {.orientation = {1, 0, 0, 0}};
    bool bad = false;
    read_motion(r, &s);
    const double w = maybe_bad(r, 0, &bad);
    if (bad) {
        s.orientation = (pe_quat){w, 0, 0, 1};
    }
    if (i >= 0) {
        r->overlap = true;
        expect(r, pe_body_set_state(r->world, r->ids[i], &s, NULL), bad ? PE_BAD_ARGUMENT : PE_OK,
               "pe_body_set_state");
    }
}

static void apply_force(run *r)
{
    const int i = choose(r);
    bool bad = false;
    const double size = log_within(r, 1e-6, draw(r) < 16 ? 1e30 : 1e6);
    pe_vec3 force = vector(r, size), offset = vector(r, 1);
    force.z = maybe_bad(r, force.z, &bad);
    bad = bad && force.z != -1; /* which is a force like any other */
    const pe_frame frame = draw(r) % 2 == 0 ? PE_FRAME_WORLD : PE_FRAME_BODY;
    if (i >= 0 && expect(r, pe_body_apply_force(r->world, r->ids[i], force, offset, frame, NULL),
                         bad ? PE_BAD_ARGUMENT : PE_OK, "pe_body_apply_force")) {
        r->push[i] += pe_length(force);
        r->twisted[i] = r->twisted[i] || pe_length(offset) > 0;
    }
}

/* ---- Steps ---- */

static void read_states(run *r, pe_body_state *states)
{
    for (int i = 0; i < MOST_BODIES; ++i) {
        if (r->ids[i].index != 0) {
            expect(r, pe_body_get_state(r->world, r->ids[i], &states[i], NULL), PE_OK,
                   "pe_body_get_state");
        }
    }
}

static void check_motion(run *r, int i, double dt, bool may_sleep)
{
    const pe_body_state *b = &r->before[i];
    pe_body_state end = r->after[i], *a = &end;
    if (r->is_static[i]) {
        if (memcmp(a, b, sizeof *a) != 0) {
            breaks(r, "a static body stays", i, pe_length(pe_sub(a->position, b->position)));
        }
        return;
    }
    const double acceleration = pe_length(r->gravity) + r->push[i] / r->mass[i];
    if (may_sleep && pe_length(a->velocity) == 0) {
        a->velocity.x = SLEEP_SPEED; /* at most, before it fell asleep in this step */
    }
    const unexplained_motion found =
        unexplained_motion_of(r->world, r->ids[i], b, a, dt, acceleration);
    /* What rounding of places and ways leaves, in the same units. */
    const double rounding =
        1e-12 *
        (pe_length(b->position) + pe_length(a->position) +
         dt * (pe_length(a->velocity) + pe_length(b->velocity) + dt * acceleration)) /
        pe_bodies(r->world)[r->ids[i].index].size;
    if (!(found.moved <= MOST_UNEXPLAINED + rounding)) {
        breaks(r, "a body moves by its speed and a quarter of its size", i, found.moved);
    }
    if (!r->twisted[i] && !(found.rotated <= MOST_UNEXPLAINED + rounding)) {
        breaks(r, "a body rotates by its spin and a quarter of its size", i, found.rotated);
    }
}

static void check_energy(run *r, double dt)
{
    double before = 0, after = 0, work = 0;
    for (int i = 0; i < MOST_BODIES; ++i) {
        if (r->ids[i].index == 0 || r->is_static[i]) {
            continue;
        }
        const pe_body_state *b = &r->before[i], *a = &r->after[i];
        const double spin = pe_max(pe_length(a->angular_velocity), pe_length(b->angular_velocity));
        if (r->push[i] > 0 || dt * spin > RESOLVED || pe_length(a->position) > FAR) {
            return;
        }
        const pe_vec3 way =
            pe_sub(centre_of(r->world, r->ids[i], a), centre_of(r->world, r->ids[i], b));
        before += kinetic_energy_of(r->world, r->ids[i], b);
        after += kinetic_energy_of(r->world, r->ids[i], a);
        work += pe_max(0, r->mass[i] * pe_dot(r->gravity, way));
    }
    const double gain = (after - before - work) / (before + work + 1e-9);
    if (!(gain <= GAIN)) {
        breaks(r, "energy does not grow", -1, gain);
    }
}

/* The contacts of a dynamic body are in the order of its solves. */
static void check_order(run *r, pe_body_id body, int order, int last[MOST_BODIES])
{
    for (int i = 0; i < MOST_BODIES; ++i) {
        if (r->ids[i].index == body.index && !r->is_static[i]) {
            if (order < last[i]) {
                breaks(r, "a body's contacts are in the order of its solves", i, order);
            }
            last[i] = order;
        }
    }
}

static void check_contacts(run *r, double dt)
{
    pe_contact contacts[CONTACTS];
    int last[MOST_BODIES] = {0};
    const int count = pe_world_get_contacts(r->world, contacts, CONTACTS);
    r->found->contacts += count;
    for (int i = 0; i < count && i < CONTACTS; ++i) {
        const pe_contact *c = &contacts[i];
        pe_body_state s;
        expect(r, pe_body_get_state(r->world, c->body_a, &s, NULL), PE_OK,
               "a contact's body lives");
        expect(r, pe_body_get_state(r->world, c->body_b, &s, NULL), PE_OK,
               "a contact's body lives");
        if (!(fabs(pe_length(c->normal) - 1) < 1e-6)) {
            breaks(r, "a normal is unit", i, pe_length(c->normal));
        }
        if (!pe_is_finite(c->point) || !pe_is_finite(c->impulse) || !isfinite(c->separation)) {
            breaks(r, "a contact is finite", i, c->separation);
        }
        if (!(c->begin >= 0 && c->begin <= c->end && c->end <= dt * (1 + 1e-9))) {
            breaks(r, "a contact acts within the step", i, c->begin);
        }
        check_order(r, c->body_a, c->order, last);
        check_order(r, c->body_b, c->order, last);
    }
}

static void check_problems(run *r, double dt)
{
    pe_contact_problem **problems;
    int count;
    const pe_status status = pe_world_capture_problems(r->world, dt, &problems, &count, NULL);
    r->found->calls += 1;
    for (int i = 0; status == PE_OK && i < count; ++i) {
        pe_problem_fault fault;
        if (!pe_contact_problem_is_valid(problems[i], &fault)) {
            breaks(r, fault.text, fault.index, i);
        }
    }
    if (status == PE_OK) {
        pe_contact_problems_destroy(problems, count);
    } else if (status != PE_NOT_FINITE) {
        breaks(r, "pe_world_capture_problems", -1, status);
    }
}

static void take_step(run *r)
{
    const unsigned which = draw(r);
    bool bad = false;
    double dt = which < 160 ? 1.0 / 60 : which < 250 ? log_within(r, 1e-4, 0.1) : 1e12;
    if (which < 8) {
        dt = maybe_bad(r, dt, &bad);
    }
    read_states(r, r->before);
    pe_step_stats stats;
    pe_error error = {PE_OK, ""};
    const pe_status status = pe_world_step(r->world, dt, &stats, &error);
    r->found->calls += 1;
    read_states(r, r->after);
    if (status != PE_OK) {
        bool changed = false;
        for (int i = 0; i < MOST_BODIES; ++i) {
            changed |= r->ids[i].index != 0 &&
                       memcmp(&r->before[i], &r->after[i], sizeof r->before[i]) != 0;
        }
        if (changed || error.status != status ||
            status != (bad ? PE_BAD_ARGUMENT : PE_NOT_FINITE)) {
            breaks(r, "a step that fails changes nothing", -1, status);
        }
        r->found->refused += bad;
        r->found->undone += !bad;
    } else if (bad) {
        breaks(r, "a time step out of range is refused", -1, dt);
    } else {
        r->found->steps += 1;
        r->found->slept += stats.sleeping > 0;
        r->found->overlapping += stats.overlapping > 0;
        for (int i = 0; i < MOST_BODIES && holds(r); ++i) {
            if (r->ids[i].index != 0 && !is_finite_state(&r->after[i])) {
                breaks(r, "states are finite", i, r->after[i].position.z);
            } else if (r->ids[i].index != 0) {
                check_motion(r, i, dt, stats.sleeping > 0);
            }
        }
        const bool overlap = stats.overlapping > 0 || stats.penetration > TOUCHING;
        if (!r->overlap && !overlap && r->solves) {
            check_energy(r, dt);
        }
        r->overlap = overlap;
        check_contacts(r, dt);
    }
    if (!bad) { /* forces were applied, or dropped */
        memset(r->push, 0, sizeof r->push);
        memset(r->twisted, 0, sizeof r->twisted);
    }
}

/* ---- Sequences ---- */

static void make_call(run *r)
{
    switch (draw(r) % 16) {
    case 0:
    case 1:
    case 2:
    case 3:
    case 4:
        make_body(r);
        break;
    case 5:
        destroy_body(r);
        use_dead_body(r);
        break;
    case 6:
        set_state(r);
        break;
    case 7:
        apply_force(r);
        break;
    case 8:
        make_material(r);
        set_pair(r);
        break;
    case 9:
        make_geometry(r);
        break;
    case 10:
        check_problems(r, 1.0 / 60);
        break;
    default:
        take_step(r);
    }
}

void random_calls_run(const uint8_t *bytes, size_t size, pe_profile profile,
                      random_calls_found *found)
{
    run r = {.bytes = bytes, .size = size, .found = found};
    const int steps = found->steps;
    make_world(&r, profile);
    while (holds(&r) && r.at < size && found->steps < steps + MOST_STEPS) {
        make_call(&r);
    }
    pe_world_destroy(r.world);
}
