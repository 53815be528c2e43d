/* Faces of hulls: laws of convex polyhedra (Euler's formula, supporting planes, the volume under
 * the faces), on solids with known faces and on random ones. */
#include "adapters/ode/hull_faces.c" /* which is not linked where ODE is absent */
#include "check.h"
#include "engine_run.h"
#include "polyhedra.h"
#include "rotation_for_tests.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static pl_hull_faces faces_of(const pl_polyhedron *hull, const double origin[3])
{
    pl_hull_faces faces;
    pl_error error = {.message = ""};
    pl_status status = pl_hull_faces_of(hull, origin, &faces, &error);
    if (status != PL_OK) {
        print_error("%s\n", error.message);
    }
    assert_int_equal(status, PL_OK);
    return faces;
}

/* Twice the area of a polygon along its normal, by the right-hand rule. */
static void area_of(const pl_polyhedron *hull, const unsigned int *polygon, double out[3])
{
    memset(out, 0, 3 * sizeof *out);
    for (unsigned int i = 1; i <= polygon[0]; ++i) {
        double part[3];
        unsigned int next = i == polygon[0] ? 1 : i + 1;
        cross(hull->vertices[polygon[i]], hull->vertices[polygon[next]], part);
        for (int k = 0; k < 3; ++k) {
            out[k] += part[k];
        }
    }
}

/* Every plane has its polygon's corners on it and all vertices below, the polygons go around
 * counter-clockwise and enclose the hull's volume, and V - E + F = 2. Returns the longest one. */
static unsigned int check_faces(const pl_polyhedron *hull, const double origin[3],
                                const pl_hull_faces *faces)
{
    double small = 1e-8 * hull->radius, volume = 0;
    unsigned int corners = 0, longest = 0;
    const unsigned int *polygon = faces->polygons;
    for (int f = 0; f < faces->count; ++f, polygon += polygon[0] + 1) {
        const double *plane = faces->planes[f];
        double area[3];
        area_of(hull, polygon, area);
        assert_close(distance(plane, (double[]){0, 0, 0}), 1, 1e-12, 0);
        assert_true(area[0] * plane[0] + area[1] * plane[1] + area[2] * plane[2] > 0);
        for (int i = 0; i < hull->vertex_count; ++i) {
            double height = -plane[3];
            for (int k = 0; k < 3; ++k) {
                height += plane[k] * (hull->vertices[i][k] - origin[k]);
            }
            assert_at_most(height, small);
            for (unsigned int c = 1; c <= polygon[0]; ++c) {
                if (polygon[c] == (unsigned int)i) {
                    assert_close(height, 0, small, 0);
                }
            }
        }
        volume += plane[3] * distance(area, (double[]){0, 0, 0}) / 6;
        corners += polygon[0];
        longest = polygon[0] > longest ? polygon[0] : longest;
    }
    assert_close(volume, hull->volume, 0, 1e-8);
    assert_int_equal(corners % 2, 0);
    assert_int_equal(hull->vertex_count - (int)corners / 2 + faces->count, 2);
    return longest;
}

static void test_rotated_prism_has_ends_and_sides_as_faces(void **state)
{
    (void)state;
    enum { SIDES = 17 };
    double points[2 * SIDES][3];
    check_random random = {4};
    double q[4];
    check_quaternion(&random, q);
    for (int i = 0; i < 2 * SIDES; ++i) {
        double angle = 2 * pi * (i % SIDES) / SIDES;
        double local[3] = {cos(angle), sin(angle), i < SIDES ? -0.4 : 0.7};
        to_world(q, local, points[i]);
        for (int k = 0; k < 3; ++k) {
            points[i][k] += 5 - k;
        }
    }
    pl_scene scene = pl_scene_default();
    const pl_polyhedron *hull = NULL;
    assert_int_equal(
        pl_scene_add_hull(&scene, "prism", (const double(*)[3])points, 2 * SIDES, &hull, NULL),
        PL_OK);
    pl_hull_faces faces = faces_of(hull, hull->centre);
    assert_int_equal(faces.count, SIDES + 2);
    assert_int_equal(check_faces(hull, hull->centre, &faces), SIDES);
    pl_hull_faces_free(&faces);
    pl_scene_free(&scene);
}

static void test_random_hull_faces_obey_convex_polyhedron_laws(void **state)
{
    (void)state;
    check_random random = {12};
    for (int n = 0; n < 60; ++n) {
        pl_scene scene = pl_scene_default();
        const pl_polyhedron *hull = random_hull(&scene, &random, 4 + 2 * n);
        const double origin[3] = {0.1, -0.2, 0.3};
        pl_hull_faces faces = faces_of(hull, n % 2 == 0 ? hull->centre : origin);
        check_faces(hull, n % 2 == 0 ? hull->centre : origin, &faces);
        pl_hull_faces_free(&faces);
        pl_scene_free(&scene);
    }
}

static void test_nonconvex_surface_is_declined_by_name(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    const double half[3] = {1, 1, 1}, middle[3] = {0, 0, 0};
    pl_polyhedron broken = *box_mesh(&scene, half, middle, 3);
    pl_hull_faces faces;
    pl_error error = {.message = ""};
    /* A whole box is one, though its faces are of many triangles: the corners inside a face go. */
    assert_int_equal(pl_hull_faces_of(&broken, middle, &faces, &error), PL_OK);
    assert_int_equal(faces.count, 6);
    pl_hull_faces_free(&faces);
    /* Without a triangle in the middle of a face that face has two borders. */
    snprintf(broken.name, sizeof broken.name, "sieve");
    int inside = -1;
    for (int i = 0; i < broken.triangle_count && inside < 0; ++i) {
        bool all_inside = true;
        for (int k = 0; k < 3; ++k) {
            const double *corner = broken.vertices[broken.triangles[i][k]];
            int at_limit = 0;
            for (int c = 0; c < 3; ++c) {
                at_limit += fabs(corner[c]) > 0.99;
            }
            all_inside = all_inside && at_limit == 1;
        }
        inside = all_inside ? i : inside;
    }
    assert_true(inside >= 0);
    --broken.triangle_count;
    memcpy(broken.triangles[inside], broken.triangles[broken.triangle_count],
           sizeof *broken.triangles);
    assert_int_equal(pl_hull_faces_of(&broken, middle, &faces, &error), PL_BAD_INPUT);
    assert_contains(error.message, "sieve");
    assert_null(faces.planes);
    assert_null(faces.polygons);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rotated_prism_has_ends_and_sides_as_faces),
        cmocka_unit_test(test_random_hull_faces_obey_convex_polyhedron_laws),
        cmocka_unit_test(test_nonconvex_surface_is_declined_by_name),
    };
    return cmocka_run_group_tests_name("adapters faces", tests, NULL, NULL);
}
