/* Random solids, poses of pairs, and their distances. */
#include "shape_pairs.h"

#include "model/shape.h"
#include "solid_forms.h"

#include <stdlib.h>
#include <string.h>

static double log_uniform(check_random *random, double low, double high)
{
    return low * exp(check_uniform(random, 0, 1) * log(high / low));
}

static int random_index(check_random *random, int count)
{
    return (int)check_uniform(random, 0, count);
}

pe_vec3 random_direction(check_random *random)
{
    double z = check_uniform(random, -1, 1), angle = check_uniform(random, 0, 6.283185307179586);
    return pe_v3(sqrt(1 - z * z) * cos(angle), sqrt(1 - z * z) * sin(angle), z);
}

/* ---- Solids ---- */

/* Three half lengths: the largest of 0.1 to 10 m, the others shorter by the aspect. */
static pe_vec3 random_lengths(check_random *random, double most_aspect)
{
    double most = log_uniform(random, 0.1, 10);
    double aspect = check_uniform(random, 0, 1) < 0.1 ? most_aspect : pe_min(20, most_aspect);
    double e[3] = {most};
    e[1] = most / log_uniform(random, 1, aspect);
    e[2] = most / log_uniform(random, 1, aspect);
    int k = random_index(random, 3);
    return pe_v3(e[k], e[(k + 1) % 3], e[(k + 2) % 3]);
}

static bool take_arrays(solid *s, const form *f)
{
    size_t v = (size_t)f->vertex_count, t = (size_t)f->triangle_count;
    s->vertex_count = f->vertex_count;
    s->triangle_count = f->triangle_count;
    s->vertices = malloc(v * sizeof *s->vertices);
    s->triangles = malloc(t * sizeof *s->triangles);
    s->normals = malloc(t * sizeof *s->normals);
    return s->vertices != NULL && s->triangles != NULL && s->normals != NULL;
}

/* Fills the arrays from a form, in axes that lie at `centre` and are turned by `rotation`. */
static bool take_form(solid *s, const form *f, pe_vec3 centre, const pe_mat3 *rotation)
{
    if (!take_arrays(s, f)) {
        return false;
    }
    for (int i = 0; i < f->vertex_count; ++i) {
        s->vertices[i] = pe_unrotate(rotation, pe_sub(f->vertices[i], centre));
        s->reach = pe_max(s->reach, pe_length(s->vertices[i]));
    }
    for (int i = 0; i < f->triangle_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            s->triangles[i][k] = (int)f->triangles[i][k];
        }
        pe_vec3 a = s->vertices[s->triangles[i][0]];
        pe_vec3 n = pe_cross(pe_sub(s->vertices[s->triangles[i][1]], a),
                             pe_sub(s->vertices[s->triangles[i][2]], a));
        s->normals[i] = pe_scale(1 / pe_length(n), n);
    }
    return true;
}

static bool make_polyhedron(solid *s, const form *f, bool convex)
{
    pe_allocator allocator = pe_allocator_default();
    pe_error error = {PE_OK, ""};
    const pe_geometry_def def = {.vertices = f->vertices,
                                 .triangles = f->triangles,
                                 .vertex_count = f->vertex_count,
                                 .triangle_count = f->triangle_count,
                                 .convex = s->shape.kind == PE_SHAPE_HULL};
    if (pe_geometry_make(&def, &allocator, &s->geometry, &error) != PE_OK) {
        print_error("%s\n", error.message);
        return false;
    }
    s->convex = convex;
    s->shape.geometry.index = 1;
    pe_mat3 rotation = pe_matrix_of(s->geometry->frame.orientation);
    return take_form(s, f, s->geometry->frame.centre, &rotation);
}

static form hull_form(check_random *random, int index)
{
    static const int sides[] = {3, 4, 5, 6, 7, 8, 12, 16, 32, 64};
    enum { FIXED = 3, PRISMS = sizeof sides / sizeof *sides };
    if (index == 0) {
        return form_tetrahedron();
    }
    if (index == 1) {
        return form_icosahedron();
    }
    if (index == 2) {
        return form_cube();
    }
    if (index < FIXED + PRISMS) {
        return form_frustum(sides[index - FIXED], 1, 0);
    }
    if (index < FIXED + 2 * PRISMS) {
        double shift = check_uniform(random, -0.5, 0.5);
        return form_frustum(sides[index - FIXED - PRISMS], check_uniform(random, 0.3, 0.9), shift);
    }
    return form_random_hull(random, 5 + random_index(random, 16));
}

static form mesh_form(int index, bool *convex)
{
    *convex = index % 5 == 0 || index % 5 == 1;
    switch (index % 5) {
    case 0:
        return form_cube();
    case 1:
        return index % 2 == 0 ? form_icosahedron() : form_icosphere();
    case 2:
        return form_torus(1, 0.3, 12, 6);
    default:
        return form_l_shape();
    }
}

static bool make_solid(solid *s, pe_shape_kind kind, int index, check_random *random)
{
    static const pe_mat3 identity = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    pe_vec3 e = random_lengths(random, kind == PE_SHAPE_MESH ? 3 : 1000);
    bool made = true;
    s->shape.kind = kind;
    s->convex = true;
    form f;
    switch (kind) {
    case PE_SHAPE_PLANE:
        s->reach = 1;
        return true;
    case PE_SHAPE_BOX:
        s->shape.half_extents = e;
        f = form_cube();
        form_scale(&f, e);
        made = take_form(s, &f, pe_v3(0, 0, 0), &identity);
        break;
    case PE_SHAPE_HULL:
        f = hull_form(random, index);
        form_scale(&f, e);
        made = make_polyhedron(s, &f, true);
        break;
    case PE_SHAPE_MESH:
        f = mesh_form(index, &s->convex);
        form_scale(&f, e);
        made = make_polyhedron(s, &f, s->convex);
        break;
    default:
        s->shape.radius = e.x;
        s->shape.half_height = e.z;
        s->reach = pe_shape_bounding_radius(&s->shape, NULL);
        break;
    }
    s->size = made ? pe_shape_size(&s->shape, s->geometry) : 0;
    return made;
}

void solid_clear(solid *s)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_free(s->geometry, &allocator);
    free(s->vertices);
    free(s->triangles);
    free(s->normals);
    *s = (solid){.size = 0};
}

shape_pool *shape_pool_create(uint64_t seed)
{
    check_random random = {seed};
    shape_pool *pool = calloc(1, sizeof *pool);
    for (int kind = 0; pool != NULL && kind < PE_SHAPE_COUNT; ++kind) {
        for (int i = 0; i < POOL; ++i) {
            if (!make_solid(&pool->item[kind][i], (pe_shape_kind)kind, i, &random)) {
                shape_pool_destroy(pool);
                return NULL;
            }
        }
    }
    return pool;
}

void shape_pool_destroy(shape_pool *pool)
{
    for (int i = 0; pool != NULL && i < PE_SHAPE_COUNT * POOL; ++i) {
        solid_clear(&pool->item[i / POOL][i % POOL]);
    }
    free(pool);
}

/* ---- Places ---- */

void place(placed *p, pe_vec3 position, pe_quat orientation)
{
    orientation = pe_quat_unit(orientation);
    p->pose = (pe_pose){position, orientation, pe_matrix_of(orientation)};
    p->shape = p->solid->shape;
    p->shape.normal = pe_axis(&p->pose.rotation, 2);
    p->shape.offset = pe_dot(p->shape.normal, position);
}

placed placed_scaled(const placed *from, double factor, solid *larger)
{
    const solid *old = from->solid;
    solid s = {.shape = old->shape, .convex = old->convex};
    s.shape.radius *= factor;
    s.shape.half_height *= factor;
    s.shape.half_extents = pe_scale(factor, old->shape.half_extents);
    s.size = factor * old->size;
    s.reach = old->size > 0 ? factor * old->reach : 1;
    pe_vec3 position = pe_scale(factor, from->pose.position);
    pe_quat orientation = from->pose.orientation;
    if (old->geometry != NULL) {
        form f = {.vertex_count = old->vertex_count, .triangle_count = old->triangle_count};
        for (int i = 0; i < f.vertex_count; ++i) {
            f.vertices[i] = pe_scale(factor, old->vertices[i]);
        }
        for (int i = 0; i < 3 * f.triangle_count; ++i) {
            f.triangles[i / 3][i % 3] = (uint32_t)old->triangles[i / 3][i % 3];
        }
        assert_true(make_polyhedron(&s, &f, s.convex));
        const pe_geometry_frame *frame = &s.geometry->frame;
        position = pe_add(position, pe_rotate(&from->pose.rotation, frame->centre));
        orientation = pe_quat_product(orientation, frame->orientation);
    }
    *larger = s;
    placed p = {.solid = larger};
    place(&p, position, orientation);
    return p;
}

pe_placed as_placed(const placed *p)
{
    return (pe_placed){&p->shape, p->solid->geometry, &p->pose, p->solid->size};
}

double outside(const placed *p, pe_vec3 x)
{
    const pe_shape *shape = &p->shape;
    pe_vec3 local = pe_unrotate(&p->pose.rotation, pe_sub(x, p->pose.position)), out;
    double across = sqrt(local.x * local.x + local.y * local.y), most = 0;
    double over = pe_max(0, fabs(local.z) - shape->half_height);
    switch (shape->kind) {
    case PE_SHAPE_PLANE:
        return pe_max(0, pe_dot(shape->normal, x) - shape->offset);
    case PE_SHAPE_SPHERE:
        return pe_max(0, pe_length(local) - shape->radius);
    case PE_SHAPE_CAPSULE:
        return pe_max(0, sqrt(across * across + over * over) - shape->radius);
    case PE_SHAPE_CYLINDER:
        across = pe_max(0, across - shape->radius);
        return sqrt(across * across + over * over);
    case PE_SHAPE_BOX:
        out = pe_sub(pe_v3(fabs(local.x), fabs(local.y), fabs(local.z)), shape->half_extents);
        return pe_length(pe_v3(pe_max(0, out.x), pe_max(0, out.y), pe_max(0, out.z)));
    default:
        break;
    }
    for (int i = 0; i < p->solid->triangle_count; ++i) {
        pe_vec3 corner = p->solid->vertices[p->solid->triangles[i][0]];
        most = pe_max(most, pe_dot(p->solid->normals[i], pe_sub(local, corner)));
    }
    return most;
}

/* ---- Pairs ---- */

void pair_part(pair *p, double distance, pe_vec3 n)
{
    place(&p->b, pe_madd(p->b.pose.position, distance, n), p->b.pose.orientation);
}

pair pair_moved(const pair *p, pe_quat turn, pe_vec3 by)
{
    pair moved = *p;
    pe_mat3 m = pe_matrix_of(turn);
    place(&moved.a, pe_add(by, pe_rotate(&m, p->a.pose.position)),
          pe_quat_product(turn, p->a.pose.orientation));
    place(&moved.b, pe_add(by, pe_rotate(&m, p->b.pose.position)),
          pe_quat_product(turn, p->b.pose.orientation));
    return moved;
}

/* A turn that maps axes to axes. */
static pe_quat axis_turn(check_random *random)
{
    static const double half = 0.70710678118654752;
    static const pe_quat quarter[3] = {{half, half, 0, 0}, {half, 0, half, 0}, {half, 0, 0, half}};
    pe_quat q = {.w = 1};
    for (int i = 0; i < 3; ++i) {
        for (int turns = random_index(random, 4); turns > 0; --turns) {
            q = pe_quat_product(quarter[i], q);
        }
    }
    return q;
}

static pe_quat small_turn(check_random *random)
{
    pe_vec3 direction = random_direction(random);
    pe_vec3 axis = pe_scale(log_uniform(random, 1e-12, 1e-2), direction);
    return (pe_quat){1, axis.x, axis.y, axis.z};
}

/* A turn that maps axes to axes, or nearly. */
static pe_quat parallel_turn(check_random *random)
{
    pe_quat turn = axis_turn(random);
    return random_index(random, 2) == 1 ? pe_quat_product(small_turn(random), turn) : turn;
}

/* Half the box along the axes of a around one of the two, 1 each way for a plane. */
static pe_vec3 extent_in(const placed *a, const placed *p)
{
    pe_quat to_a = pe_quat_product(pe_quat_conjugate(a->pose.orientation), p->pose.orientation);
    pe_mat3 rotation = pe_matrix_of(to_a);
    return p->solid->size > 0 ? pe_shape_extent(&p->shape, p->solid->geometry, &rotation).half
                              : pe_v3(1, 1, 1);
}

/* b, turned so, next to a along one of a's axes; on the others with sides or centres in line, or
 * not. */
static void align(pair *p, pe_quat turn, check_random *random)
{
    place(&p->b, p->a.pose.position, pe_quat_product(p->a.pose.orientation, turn));
    pe_vec3 e = extent_in(&p->a, &p->a), h = extent_in(&p->a, &p->b);
    int along = p->a.solid->size > 0 ? random_index(random, 3) : 2;
    double shift[3];
    for (int k = 0; k < 3; ++k) {
        double sum = pe_component(e, k) + pe_component(h, k);
        double difference = pe_component(e, k) - pe_component(h, k);
        const double choice[] = {0, difference, sum, check_uniform(random, -sum, sum)};
        shift[k] = k == along ? 1.5 * sum : choice[random_index(random, 4)];
    }
    pe_vec3 by = pe_rotate(&p->a.pose.rotation, pe_v3(shift[0], shift[1], shift[2]));
    place(&p->b, pe_add(p->a.pose.position, by), p->b.pose.orientation);
}

static void part_to(pair *p, double separation, pair_gap *gap)
{
    pe_vec3 n;
    double distance = gap(p, &n);
    pair_part(p, separation - distance, n);
}

/* Where a shape can stand: a direction out of it, the ends and the middle of an edge or line of the
 * surface there, and its direction, all in its own axes. */
typedef struct foot {
    pe_vec3 out, first, last, middle, along;
} foot;

static foot foot_of_line(pe_vec3 out, pe_vec3 middle, double half, pe_vec3 along)
{
    return (foot){out, pe_madd(middle, -half, along), pe_madd(middle, half, along), middle, along};
}

/* Of a polyhedron: the middle is that of the triangle. */
static foot foot_of_triangle(const solid *s, int i)
{
    const int *t = s->triangles[i];
    pe_vec3 a = s->vertices[t[0]], b = s->vertices[t[1]], c = s->vertices[t[2]];
    pe_vec3 middle = pe_scale(1.0 / 3, pe_add(a, pe_add(b, c))), side = pe_sub(b, a);
    return (foot){s->normals[i], a, b, middle, pe_scale(1 / pe_length(side), side)};
}

static foot random_foot(const solid *s, check_random *random)
{
    pe_vec3 z = {0, 0, 1}, d = random_direction(random);
    double r = s->shape.radius, h = s->shape.half_height;
    pe_vec3 across = pe_scale(1 / sqrt(d.x * d.x + d.y * d.y), pe_v3(d.x, d.y, 0));
    bool stands = random_index(random, 2) == 0;
    switch (s->shape.kind) {
    case PE_SHAPE_PLANE:
        return foot_of_line(z, pe_v3(0, 0, 0), 0, across);
    case PE_SHAPE_SPHERE:
        return foot_of_line(z, pe_scale(r, z), 0, across);
    case PE_SHAPE_CAPSULE:
        return stands ? foot_of_line(z, pe_scale(h + r, z), 0, across)
                      : foot_of_line(across, pe_scale(r, across), h, z);
    case PE_SHAPE_CYLINDER:
        return stands ? foot_of_line(z, pe_scale(h, z), r, across)
                      : foot_of_line(across, pe_scale(r, across), h, z);
    default:
        return foot_of_triangle(s, random_index(random, s->triangle_count));
    }
}

/* The turn that puts face to face with edges in line: out to -out, along to -along. */
static pe_quat turn_between(const foot *from, const foot *to)
{
    pe_vec3 f[3] = {from->out, from->along, pe_cross(from->out, from->along)};
    pe_vec3 t[3] = {pe_scale(-1, to->out), pe_scale(-1, to->along), pe_cross(to->out, to->along)};
    double m[3][3] = {{0}};
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < 3; ++k) {
                m[r][c] += pe_component(t[k], r) * pe_component(f[k], c);
            }
        }
    }
    /* Shepperd 1978: from the largest of the four components. */
    double trace = m[0][0] + m[1][1] + m[2][2];
    double q2[4] = {1 + trace, 1 + 2 * m[0][0] - trace, 1 + 2 * m[1][1] - trace,
                    1 + 2 * m[2][2] - trace};
    int k = 0;
    for (int i = 1; i < 4; ++i) {
        k = q2[i] > q2[k] ? i : k;
    }
    double x = m[2][1] - m[1][2], y = m[0][2] - m[2][0], z = m[1][0] - m[0][1];
    double xy = m[0][1] + m[1][0], xz = m[0][2] + m[2][0], yz = m[1][2] + m[2][1];
    const pe_quat rows[4] = {
        {q2[0], x, y, z}, {x, q2[1], xy, xz}, {y, xy, q2[2], yz}, {z, xz, yz, q2[3]}};
    return pe_quat_unit(rows[k]);
}

void pair_rest(pair *p, check_random *random, pair_gap *gap)
{
    foot a = random_foot(p->a.solid, random), b = random_foot(p->b.solid, random);
    pe_quat turn = turn_between(&b, &a);
    pe_vec3 from = b.last, to = a.first;
    if (random_index(random, 2) == 0) { /* turned about the normal, and moved along the face */
        double spin = check_uniform(random, 0, 3), s = sin(spin);
        turn = pe_quat_product((pe_quat){cos(spin), s * a.out.x, s * a.out.y, s * a.out.z}, turn);
        from = b.middle;
        to = pe_madd(a.middle, 0.1 * p->size * check_uniform(random, 0, 1), a.along);
    }
    place(&p->b, p->b.pose.position, pe_quat_product(p->a.pose.orientation, turn));
    pe_vec3 at = pe_add(p->a.pose.position, pe_rotate(&p->a.pose.rotation, to));
    place(&p->b, pe_sub(at, pe_rotate(&p->b.pose.rotation, from)), p->b.pose.orientation);
    part_to(p, 0, gap);
}

static void make_aligned(pair *p, check_random *random, pair_gap *gap)
{
    pe_quat turn = parallel_turn(random);
    align(p, turn, random);
    const double wanted[] = {0, 0, 1e-3, -1e-3, -0.1};
    part_to(p, wanted[random_index(random, 5)] * p->size, gap);
}

/* Axes at random, parallel or nearly. */
static void make_concentric(pair *p, check_random *random)
{
    pe_quat turn = axis_turn(random), small = small_turn(random);
    int choice = random_index(random, 3);
    if (choice > 0) {
        turn = choice == 1 ? turn : pe_quat_product(small, turn);
        place(&p->b, p->b.pose.position, pe_quat_product(p->a.pose.orientation, turn));
    }
    place(&p->b, p->a.pose.position, p->b.pose.orientation);
}

/* Of either sign, or 0. */
static double little(check_random *random)
{
    const double size = log_uniform(random, 1e-12, 1), choice[] = {0, size, size, -size};
    return choice[random_index(random, 4)];
}

/* Axes parallel or nearly. b is above a along one of a's axes and next to it along another. */
static void make_ledge(pair *p, check_random *random)
{
    pe_quat turn = parallel_turn(random);
    place(&p->b, p->a.pose.position, pe_quat_product(p->a.pose.orientation, turn));
    pe_vec3 e = extent_in(&p->a, &p->a), h = extent_in(&p->a, &p->b);
    int above = p->a.solid->size > 0 ? random_index(random, 3) : 2;
    int beside = (above + 1 + random_index(random, 2)) % 3;
    double shift[3];
    for (int k = 0; k < 3; ++k) {
        double sum = pe_component(e, k) + pe_component(h, k);
        double anywhere = random_index(random, 2) * check_uniform(random, -sum, sum);
        shift[k] = k == above || k == beside ? sum + p->size * little(random) : anywhere;
    }
    pe_vec3 by = pe_rotate(&p->a.pose.rotation, pe_v3(shift[0], shift[1], shift[2]));
    place(&p->b, pe_add(p->a.pose.position, by), p->b.pose.orientation);
}

pair random_pair(const shape_pool *pool, pe_shape_kind a, pe_shape_kind b, pair_pose pose,
                 check_random *random, pair_gap *gap)
{
    pair p = {.size = 0};
    p.a.solid = &pool->item[a][random_index(random, POOL)];
    p.b.solid = &pool->item[b][random_index(random, POOL)];
    bool plane = a == PE_SHAPE_PLANE;
    p.size = plane ? p.b.solid->size : pe_min(p.a.solid->size, p.b.solid->size);
    pe_quat turn = random_turn(random);
    pe_vec3 at = pe_scale(5, random_direction(random));
    place(&p.a, at, turn);
    /* On the scale of the smaller one near a random point of the larger one's ball. */
    double reach = plane ? p.b.solid->reach : p.a.solid->reach + p.b.solid->reach;
    pe_vec3 away = random_direction(random);
    double distance = reach * check_uniform(random, 0, 1);
    if (pose == POSE_DEEP) {
        distance = p.size * check_uniform(random, 0, 1);
    } else if (pose == POSE_FAR) {
        distance = reach * log_uniform(random, 1, 100);
    } else if (b == PE_SHAPE_MESH && pose != POSE_ANY) {
        distance = reach; /* apart: from within, the way to where they touch may not be straight */
    }
    place(&p.b, pe_madd(at, distance, away), random_turn(random));
    switch (pose) {
    case POSE_SHALLOW:
        part_to(&p, -1e-3 * p.size * check_uniform(random, 0, 1), gap);
        break;
    case POSE_TOUCHING:
        part_to(&p, 0, gap);
        break;
    case POSE_CLOSE:
        part_to(&p, p.size * log_uniform(random, 1e-6, 0.1), gap);
        break;
    case POSE_ALIGNED:
        make_aligned(&p, random, gap);
        break;
    case POSE_CONCENTRIC:
        make_concentric(&p, random);
        break;
    case POSE_LEDGE:
        make_ledge(&p, random);
        break;
    default:
        break;
    }
    return p;
}

static truth_difference difference_of(const pair *p)
{
    truth_solid a = {&p->a.shape, p->a.solid->vertices, p->a.solid->vertex_count, &p->a.pose};
    truth_solid b = {&p->b.shape, p->b.solid->vertices, p->b.solid->vertex_count, &p->b.pose};
    return truth_subtract(a, b);
}

double pair_separation_along(const pair *p, pe_vec3 n)
{
    truth_difference m = difference_of(p);
    if (p->a.shape.kind != PE_SHAPE_PLANE) {
        return -truth_support(&m, n, NULL);
    }
    /* The plane goes through its pose's position. */
    pe_vec3 normal = p->a.shape.normal;
    return pe_length(pe_sub(n, normal)) <= 1e-12 ? -truth_support(&m, normal, NULL) : -HUGE_VAL;
}

truth_distance pair_truth(const pair *p, double tolerance)
{
    truth_difference m = difference_of(p);
    if (p->a.shape.kind == PE_SHAPE_PLANE) {
        double height = -truth_support(&m, p->a.shape.normal, NULL);
        return (truth_distance){height, height, p->a.shape.normal, 1};
    }
    return truth_signed_distance(&m, tolerance);
}

/* ---- Reports ---- */

static void print_one(const char *name, const placed *p)
{
    static const char *const kinds[] = {"plane",    "sphere", "box", "capsule",
                                        "cylinder", "hull",   "mesh"};
    const pe_shape *s = &p->shape;
    print_error("%s: %s radius %.17g half height %.17g half extents (%.17g, %.17g, %.17g) "
                "%d vertices, size %.3g, reach %.3g\n  at {%.17g, %.17g, %.17g} "
                "{%.17g, %.17g, %.17g, %.17g}\n",
                name, kinds[s->kind], s->radius, s->half_height, s->half_extents.x,
                s->half_extents.y, s->half_extents.z, p->solid->vertex_count, p->solid->size,
                p->solid->reach, p->pose.position.x, p->pose.position.y, p->pose.position.z,
                p->pose.orientation.w, p->pose.orientation.x, p->pose.orientation.y,
                p->pose.orientation.z);
    if (s->kind == PE_SHAPE_HULL && p->solid->vertex_count <= 24) {
        for (int i = 0; i < p->solid->vertex_count; ++i) {
            pe_vec3 v = p->solid->vertices[i];
            print_error("  {%.17g, %.17g, %.17g}\n", v.x, v.y, v.z);
        }
    }
}

void pair_print(const pair *p)
{
    print_one("a", &p->a);
    print_one("b", &p->b);
}
