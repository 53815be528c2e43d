#include "statics.h"

#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Linear programming ---- */

/* One pivot of the tableau t (rows + 1) x width, whose last row is the sum of infeasibilities. */
static void pivot(double *t, int rows, int width, int row, int column)
{
    double *p = t + (size_t)row * (size_t)width;
    const double scale = p[column];
    for (int k = 0; k < width; ++k) {
        p[k] /= scale;
    }
    for (int i = 0; i <= rows; ++i) {
        double *r = t + (size_t)i * (size_t)width;
        const double factor = r[column];
        for (int k = 0; k < width && i != row && factor != 0; ++k) {
            r[k] -= factor * p[k];
        }
    }
}

/* The row that leaves for this column: of those that reach zero first, the one with the largest
 * pivot; -1: none. */
static int leaving_row(const double *t, int rows, int width, int column)
{
    int leaving = -1;
    double least = HUGE_VAL, largest = 0;
    for (int i = 0; i < rows; ++i) {
        const double *r = t + (size_t)i * (size_t)width;
        least = r[column] > 1e-9 ? fmin(least, fmax(r[width - 1], 0) / r[column]) : least;
    }
    for (int i = 0; i < rows; ++i) {
        const double *r = t + (size_t)i * (size_t)width;
        if (r[column] > 1e-9 && r[column] > largest &&
            fmax(r[width - 1], 0) / r[column] <= least + 1e-12) {
            largest = r[column];
            leaving = i;
        }
    }
    return leaving;
}

/* The column that lessens the infeasibility most; after many steps the first, lest they go round.
 * -1: none. */
static int entering_column(const double *sum, int columns, int step)
{
    int entering = -1;
    for (int k = 0; k < columns; ++k) {
        if (sum[k] > 1e-10 && (entering < 0 || (step < 2000 && sum[k] > sum[entering]))) {
            entering = k;
        }
    }
    return entering;
}

bool has_nonnegative_solution(const double *a, const double *b, int rows, int columns)
{
    const int width = columns + 1;
    double *t = calloc((size_t)(rows + 1) * (size_t)width, sizeof *t);
    double largest = 0;
    assert_non_null(t);
    double *sum = t + (size_t)rows * (size_t)width;
    for (int i = 0; i < rows; ++i) {
        double *r = t + (size_t)i * (size_t)width;
        const double sign = b[i] < 0 ? -1 : 1;
        for (int k = 0; k < columns; ++k) {
            r[k] = sign * a[i * columns + k];
            sum[k] += r[k];
        }
        r[columns] = sign * b[i];
        sum[columns] += r[columns];
        largest = fmax(largest, fabs(b[i]));
    }
    for (int step = 0; step < 20000; ++step) {
        const int column = entering_column(sum, columns, step);
        const int row = column < 0 ? -1 : leaving_row(t, rows, width, column);
        if (row < 0) {
            break;
        }
        pivot(t, rows, width, row, column);
    }
    const bool found = sum[columns] <= 1e-9 * largest;
    free(t);
    return found;
}

/* ---- Contacts in the plane ---- */

enum { MOST_CORNERS = 8, MOST_BODIES = 64, MOST_CONTACTS = 512 };
static const double touching = 1e-9; /* m */

/* A convex polygon, counter-clockwise; a circle about corner 0; or a half-plane below corner 0. */
typedef struct outline {
    bool is_circle, is_plane;
    double radius, normal[2];
    double corners[MOST_CORNERS][2];
    int count;
    double centre[2]; /* of mass */
} outline;

typedef struct contact {
    int a, b;
    double point[2], normal[2]; /* from a to b */
    double friction;
} contact;

typedef struct problem {
    const pl_scene *scene;
    outline outlines[MOST_BODIES];
    contact contacts[MOST_CONTACTS];
    int contact_count;
} problem;

/* A point of the body's frame, (x, z), in the world's. */
static void place(const pl_body *body, double x, double z, double out[2])
{
    const double *q = body->orientation;
    const double c = q[0] * q[0] - q[2] * q[2], s = 2 * q[0] * q[2];
    out[0] = body->position[0] + c * x + s * z;
    out[1] = body->position[2] - s * x + c * z;
}

static double turn_of(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* The corners of the hull of the points, by gift wrapping. */
static void wrap(outline *o, const double (*points)[2], int count)
{
    int first = 0;
    for (int i = 1; i < count; ++i) {
        if (points[i][0] < points[first][0] - touching ||
            (points[i][0] < points[first][0] + touching && points[i][1] < points[first][1])) {
            first = i;
        }
    }
    int at = first;
    do {
        int next = -1;
        assert_true(o->count < MOST_CORNERS);
        memcpy(o->corners[o->count++], points[at], sizeof points[at]);
        for (int i = 0; i < count; ++i) {
            const double far = hypot(points[i][0] - points[at][0], points[i][1] - points[at][1]);
            if (far > touching && (next < 0 || turn_of(points[at], points[next], points[i]) < 0)) {
                next = i;
            }
        }
        at = next;
    } while (hypot(points[at][0] - points[first][0], points[at][1] - points[first][1]) > touching);
}

static void outline_of(const pl_body *body, outline *o)
{
    double points[64][2];
    int count = 0;
    const pl_shape *s = &body->shape;
    *o = (outline){.is_plane = s->kind == PL_SHAPE_PLANE,
                   .is_circle = s->kind == PL_SHAPE_CYLINDER || s->kind == PL_SHAPE_SPHERE,
                   .radius = s->radius};
    place(body, 0, 0, o->centre);
    if (o->is_plane) {
        o->normal[0] = s->normal[0], o->normal[1] = s->normal[2];
        o->corners[0][0] = s->offset * s->normal[0], o->corners[0][1] = s->offset * s->normal[2];
    } else if (s->kind == PL_SHAPE_BOX) {
        for (int i = 0; i < 4; ++i) {
            place(body, (i & 1 ? 1 : -1) * s->half_extents[0],
                  (i & 2 ? 1 : -1) * s->half_extents[2], points[count++]);
        }
    } else if (s->kind == PL_SHAPE_HULL) {
        for (int i = 0; i < s->polyhedron->vertex_count; ++i) {
            const double *v = s->polyhedron->vertices[i];
            assert_true(count < 64);
            place(body, v[0], v[2], points[count++]);
        }
        place(body, s->polyhedron->centre[0], s->polyhedron->centre[2], o->centre);
    }
    if (count > 0) {
        wrap(o, (const double(*)[2])points, count);
    }
}

static void add_contact(problem *p, int a, int b, const double point[2], const double normal[2])
{
    const pl_body *bodies = p->scene->bodies;
    double restitution;
    assert_true(p->contact_count < MOST_CONTACTS);
    contact *c = &p->contacts[p->contact_count++];
    *c = (contact){.a = a, .b = b};
    memcpy(c->point, point, sizeof c->point);
    memcpy(c->normal, normal, sizeof c->normal);
    pl_scene_pair(p->scene, bodies[a].material, bodies[b].material, &c->friction, &restitution);
}

/* The corners of b on a face of a, from `origin` along `normal`, that has all of b before it;
 * `length` along the face, or INFINITY. */
static void add_face(problem *p, int a, int b, const double origin[2], const double normal[2],
                     double length)
{
    const outline *other = &p->outlines[b];
    double nearest = HUGE_VAL;
    for (int i = 0; i < other->count; ++i) {
        const double *v = other->corners[i];
        nearest = fmin(nearest, (v[0] - origin[0]) * normal[0] + (v[1] - origin[1]) * normal[1]);
    }
    for (int i = 0; i < other->count && fabs(nearest) < touching; ++i) {
        const double *v = other->corners[i];
        const double x = v[0] - origin[0], z = v[1] - origin[1];
        const double along = x * -normal[1] + z * normal[0];
        if (fabs(x * normal[0] + z * normal[1]) < touching && along > -touching &&
            along < length + touching) {
            add_contact(p, a, b, v, normal);
        }
    }
}

/* Faces of a that corners of b touch; in both orders all contacts of two polygons. */
static void add_corners_on_faces(problem *p, int a, int b)
{
    const outline *o = &p->outlines[a];
    for (int i = 0; i < o->count; ++i) {
        const double *from = o->corners[i], *to = o->corners[(i + 1) % o->count];
        const double length = hypot(to[0] - from[0], to[1] - from[1]);
        const double normal[2] = {(to[1] - from[1]) / length, -(to[0] - from[0]) / length};
        add_face(p, a, b, from, normal, length);
    }
}

static void add_contacts(problem *p, int a, int b)
{
    const outline *o = &p->outlines[a], *other = &p->outlines[b];
    if (o->is_plane && other->is_circle) {
        const double *c = other->centre, *n = o->normal, *at = o->corners[0];
        const double height = (c[0] - at[0]) * n[0] + (c[1] - at[1]) * n[1];
        const double point[2] = {c[0] - height * n[0], c[1] - height * n[1]};
        if (fabs(height - other->radius) < touching) {
            add_contact(p, a, b, point, n);
        }
    } else if (o->is_plane) {
        const double far[2] = {o->corners[0][0] + 1e6 * o->normal[1],
                               o->corners[0][1] - 1e6 * o->normal[0]};
        add_face(p, a, b, far, o->normal, HUGE_VAL);
    } else if (o->is_circle && other->is_circle) {
        const double x = other->centre[0] - o->centre[0], z = other->centre[1] - o->centre[1];
        const double distance = hypot(x, z), normal[2] = {x / distance, z / distance};
        const double point[2] = {o->centre[0] + o->radius * normal[0],
                                 o->centre[1] + o->radius * normal[1]};
        if (fabs(distance - o->radius - other->radius) < touching) {
            add_contact(p, a, b, point, normal);
        }
    } else {
        add_corners_on_faces(p, a, b);
        add_corners_on_faces(p, b, a);
    }
}

/* The force `f` at a point on a body, as three rows of a column. */
static void put_force(double *a, int columns, int column, int row, const outline *o,
                      const double point[2], const double f[2])
{
    const double x = point[0] - o->centre[0], z = point[1] - o->centre[1];
    a[(row + 0) * columns + column] = f[0];
    a[(row + 1) * columns + column] = f[1];
    a[(row + 2) * columns + column] = x * f[1] - z * f[0];
}

bool is_in_balance(const pl_scene *scene)
{
    problem *p = calloc(1, sizeof *p);
    int row_of[MOST_BODIES], rows = 0;
    assert_non_null(p);
    assert_true(scene->body_count <= MOST_BODIES);
    p->scene = scene;
    for (int i = 0; i < scene->body_count; ++i) {
        outline_of(&scene->bodies[i], &p->outlines[i]);
        row_of[i] = scene->bodies[i].is_static ? -1 : rows;
        rows += scene->bodies[i].is_static ? 0 : 3;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        for (int k = i + 1; k < scene->body_count; ++k) {
            if (row_of[i] >= 0 || row_of[k] >= 0) {
                add_contacts(p, i, k);
            }
        }
    }
    const int columns = 2 * p->contact_count;
    double *a = calloc((size_t)rows * (size_t)columns + 1, sizeof *a);
    double *b = calloc((size_t)rows, sizeof *b);
    assert_non_null(a);
    assert_non_null(b);
    for (int i = 0; i < columns; ++i) {
        const contact *c = &p->contacts[i / 2];
        const double side = i % 2 == 0 ? c->friction : -c->friction;
        const double f[2] = {c->normal[0] - side * c->normal[1],
                             c->normal[1] + side * c->normal[0]};
        const double back[2] = {-f[0], -f[1]};
        if (row_of[c->b] >= 0) {
            put_force(a, columns, i, row_of[c->b], &p->outlines[c->b], c->point, f);
        }
        if (row_of[c->a] >= 0) {
            put_force(a, columns, i, row_of[c->a], &p->outlines[c->a], c->point, back);
        }
    }
    for (int i = 0; i < scene->body_count; ++i) {
        if (row_of[i] >= 0) {
            b[row_of[i] + 1] = scene->bodies[i].mass * -scene->gravity[2];
        }
    }
    const bool balanced = has_nonnegative_solution(a, b, rows, columns);
    free(a);
    free(b);
    free(p);
    return balanced;
}
