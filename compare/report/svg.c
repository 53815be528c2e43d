/* Draws a scene: the ground, the expected poses, and the faces that look at the eye. */
#include "picture.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

enum { SHADES = 6 };

/* Smaller details of hulls and meshes are not drawn, so that a page with many stays small. px. */
static const double resolution = 5;

/* "M x y l dx dy ... z", counted in tenths of a pixel so that rounding never accumulates. */
static void add_polygon(const pl_pixel *corner, int count, pl_text_buffer *out)
{
    long x = 0, y = 0;
    for (int i = 0; i < count; ++i) {
        long next_x = lround(corner[i].x * 10), next_y = lround(corner[i].y * 10);
        pl_text_format(out, "%c%.9g%s%.9g", i == 0 ? 'M' : 'l', (double)(next_x - x) / 10,
                       next_y < y ? "" : " ", (double)(next_y - y) / 10);
        x = next_x;
        y = next_y;
    }
    pl_text_add(out, "z");
}

static int compare_pixels(const void *left, const void *right)
{
    const pl_pixel *a = left, *b = right;
    if (a->x != b->x) {
        return a->x < b->x ? -1 : 1;
    }
    return (a->y > b->y) - (a->y < b->y);
}

/* Finds the convex hull of n points by Andrew's monotone chain (1979), and sorts them; `out` has
 * room for 2 n. */
static int hull(pl_pixel *points, int n, pl_pixel *out)
{
    int count = 0;
    qsort(points, (size_t)n, sizeof points[0], compare_pixels);
    for (int pass = 0; pass < 2; ++pass) {
        int start = count;
        for (int i = 0; i < n; ++i) {
            pl_pixel p = points[pass == 0 ? i : n - 1 - i];
            while (count - start >= 2 && pl_pixel_turn(out[count - 2], out[count - 1], p) <= 1e-9) {
                --count;
            }
            out[count++] = p;
        }
        --count; /* it is the first of the other chain */
    }
    return count;
}

static pl_vec placed(const pl_pose *pose, const pl_axes *axes, pl_vec local)
{
    return pl_vec_add(pl_vec_of(pose->position), pl_to_world(axes, local));
}

/* Adds the convex outline of all facets. */
static void add_hull_outline(const pl_shape *shape, const pl_pose *pose, const pl_view *view,
                             pl_text_buffer *out)
{
    const pl_axes axes = pl_axes_of(pose->orientation);
    pl_facets facets = pl_facets_of(shape, resolution / view->scale);
    const int count = 4 * facets.count;
    pl_pixel *points = calloc(3 * (size_t)count + 1, sizeof *points);
    if (facets.failed || points == NULL) {
        out->failed = true;
    } else if (count > 0) {
        for (int i = 0; i < count; ++i) {
            points[i] =
                pl_view_project(view, placed(pose, &axes, facets.items[i / 4].corner[i % 4]));
        }
        add_polygon(points + count, hull(points, count, points + count), out);
    }
    free(points);
    free(facets.items);
}

static void add_outline(const pl_shape *shape, const pl_pose *pose, const pl_view *view,
                        pl_text_buffer *out)
{
    if (shape->kind == PL_SHAPE_SPHERE) {
        pl_pixel centre = pl_view_project(view, pl_vec_of(pose->position));
        double r = shape->radius * view->scale;
        pl_text_format(out, "M%.1f %.1fa%.1f %.1f 0 1 0 %.1f 0a%.1f %.1f 0 1 0 %.1f 0z",
                       centre.x - r, centre.y, r, r, 2 * r, r, r, -2 * r);
    } else if (shape->kind != PL_SHAPE_PLANE) {
        add_hull_outline(shape, pose, view, out);
    }
}

void pl_svg_expected(const pl_scene *scene, const pl_view *view, const char *id,
                     pl_text_buffer *out)
{
    int count = scene->rest_count + scene->travel_count;
    pl_pose *poses = calloc((size_t)count + 1, sizeof *poses);
    int *bodies = calloc((size_t)count + 1, sizeof *bodies);
    if (poses == NULL || bodies == NULL) {
        out->failed = true;
        goto cleanup;
    }
    pl_expected_poses(scene, poses, bodies);
    pl_text_format(out, "<svg class=\"defs\" width=\"0\" height=\"0\"><defs><g id=\"%s\">", id);
    if (scene->travel_count > 0) {
        pl_text_add(out, "<path class=\"start\" d=\"");
        for (int i = 0; i < scene->travel_count; ++i) {
            const pl_body *body = &scene->bodies[scene->travels[i].body];
            pl_pose pose = pl_pose_of(body);
            add_outline(&body->shape, &pose, view, out);
        }
        pl_text_add(out, "\"/>");
    }
    if (count > 0) {
        pl_text_add(out, "<path class=\"expected\" d=\"");
        for (int i = 0; i < count; ++i) {
            add_outline(&scene->bodies[bodies[i]].shape, &poses[i], view, out);
        }
        pl_text_add(out, "\"/>");
    }
    pl_text_add(out, "</g></defs></svg>\n");

cleanup:
    free(poses);
    free(bodies);
}

/* ---- Ground ---- */

/* A floor reaches from a level line behind all bodies of the picture to beyond its lower edge; seen
 * edge-on it is the half-space below its line. Any other plane is a square around the start. */
static void add_plane(const pl_shape *plane, const pl_view *view, pl_text_buffer *out)
{
    pl_vec n = pl_vec_of(plane->normal), centre = view->centre;
    centre = pl_vec_mad(centre, plane->offset - pl_vec_dot(n, centre), n);
    pl_vec u = pl_vec_reject(view->right, n);
    if (pl_vec_length(u) < 1e-6) {
        return;
    }
    u = pl_vec_scale(u, 1 / pl_vec_length(u));
    pl_vec v = pl_vec_cross(n, u);
    const double beyond = 4 * (view->width + view->height) / view->scale;
    double back = fmax(1.3 * view->reach, 0.4 * view->width / view->scale);
    double across = back, front = -back;
    bool edge_on = fabs(pl_vec_dot(n, view->toward)) < 1e-6;
    if (edge_on) {
        v = n;
        back = 0;
    }
    if (edge_on || pl_vec_dot(n, view->up) > 0.5) {
        across = beyond;
        front = -beyond;
    }
    const double corner[4][2] = {
        {-across, back}, {across, back}, {across, front}, {-across, front}};
    pl_pixel pixels[4];
    for (int i = 0; i < 4; ++i) {
        pixels[i] =
            pl_view_project(view, pl_vec_mad(pl_vec_mad(centre, corner[i][0], u), corner[i][1], v));
    }
    pl_text_add(out, "<path class=\"ground\" d=\"");
    add_polygon(pixels, 4, out);
    pl_text_add(out, "\"/>");
}

/* ---- Bodies ---- */

/* Returns the shade, 0 (dark) .. SHADES - 1, by the angle between a normal and light from the upper
 * left, behind the eye. */
static int shade_of(const pl_view *view, pl_vec normal)
{
    double light = -0.40 * pl_vec_dot(normal, view->right) + 0.75 * pl_vec_dot(normal, view->up) +
                   0.53 * pl_vec_dot(normal, view->toward);
    int shade = (int)floor((0.15 + 0.85 * fmax(light, 0)) * SHADES);
    return shade < SHADES ? shade : SHADES - 1;
}

/* Appends a face; false when out of memory. */
static bool push(pl_painting *painting, const pl_face *face)
{
    return pl_array_push(&painting->faces, &painting->count, face, sizeof *face, NULL) == PL_OK;
}

static bool add_sphere(pl_painting *painting, const pl_view *view, const pl_shape *shape,
                       const pl_pose *pose, char kind)
{
    const pl_vec centre = pl_vec_of(pose->position);
    const pl_face face = {.corner = {pl_view_project(view, centre)},
                          .depth = {view->scale * pl_vec_dot(centre, view->toward)},
                          .kind = kind,
                          .shade = SHADES - 2,
                          .radius = shape->radius * view->scale};
    return push(painting, &face);
}

/* Appends the faces of a body that look at the eye; false when out of memory. */
static bool add_faces(pl_painting *painting, const pl_view *view, const pl_shape *shape,
                      const pl_pose *pose, char kind)
{
    const pl_axes axes = pl_axes_of(pose->orientation);
    if (shape->kind == PL_SHAPE_SPHERE) {
        return add_sphere(painting, view, shape, pose, kind);
    }
    pl_facets facets = pl_facets_of(shape, resolution / view->scale);
    bool complete = !facets.failed;
    for (int i = 0; complete && i < facets.count; ++i) {
        const pl_facet *facet = &facets.items[i];
        pl_face face = {
            .kind = kind, .fine = shape->kind != PL_SHAPE_BOX, .triangle = facet->triangle};
        pl_vec corner[4];
        for (int k = 0; k < 4; ++k) {
            corner[k] = placed(pose, &axes, facet->corner[k]);
            face.corner[k] = pl_view_project(view, corner[k]);
            face.depth[k] = view->scale * pl_vec_dot(corner[k], view->toward);
        }
        pl_vec normal =
            pl_vec_cross(pl_vec_sub(corner[1], corner[0]), pl_vec_sub(corner[2], corner[0]));
        double length = pl_vec_length(normal);
        if (pl_vec_dot(normal, view->toward) > 1e-6 * length) {
            face.shade = shade_of(view, pl_vec_scale(normal, 1 / length));
            complete = push(painting, &face);
        }
    }
    free(facets.items);
    return complete;
}

static void add_face(const pl_face *item, pl_text_buffer *out)
{
    if (item->radius > 0) {
        double r = item->radius;
        pl_text_format(out, "<circle class=\"%c%d\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>",
                       item->kind, item->shade, item->corner[0].x, item->corner[0].y, r);
        pl_text_format(out, "<circle class=\"glint\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>",
                       item->corner[0].x - 0.35 * r, item->corner[0].y - 0.38 * r, 0.3 * r);
        return;
    }
    pl_text_format(out, "<path class=\"%c%d%s\" d=\"", item->kind, item->shade,
                   item->fine ? " fine" : "");
    add_polygon(item->corner, item->triangle ? 3 : 4, out);
    pl_text_add(out, "\"/>");
}

static bool is_finite(const pl_pose *pose)
{
    bool finite = true;
    for (int i = 0; i < 3; ++i) {
        finite &= isfinite(pose->position[i]) && fabs(pose->position[i]) < 1e9;
    }
    double norm = 0;
    for (int i = 0; i < 4; ++i) {
        norm += pose->orientation[i] * pose->orientation[i];
    }
    return finite && norm > 0.5 && norm < 2;
}

/* Marks in fallen[body_count] the bodies farther from their rest than the collapse distance. */
static void mark_fallen(const pl_scene *scene, const pl_pose *poses, bool *fallen)
{
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        pl_vec from =
            pl_vec_mad(pl_vec_of(poses[rest->body].position), -1, pl_vec_of(rest->position));
        fallen[rest->body] |= !(pl_vec_length(from) <= scene->collapse_distance);
    }
}

/* Fills the painting. Returns how many moving bodies are wholly outside; -1: out of memory. */
static int collect(const pl_scene *scene, const pl_view *view, const pl_pose *poses,
                   const bool *fallen, pl_painting *painting)
{
    int outside = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (body->shape.kind == PL_SHAPE_PLANE) {
            continue;
        }
        const int before = painting->count;
        char kind = (char)(body->is_static ? 's' : fallen[i] ? 'f' : 'd');
        if (is_finite(&poses[i]) && !add_faces(painting, view, &body->shape, &poses[i], kind)) {
            return -1;
        }
        bool inside = false;
        for (int f = before; f < painting->count; ++f) {
            inside |= pl_face_inside(&painting->faces[f], view->width, view->height);
        }
        if (!inside) {
            painting->count = before;
        }
        outside += !inside && !body->is_static;
    }
    return outside;
}

int pl_svg_picture(const pl_scene *scene, const pl_view *view, const pl_pose *poses,
                   const char *expected_id, const char *title, pl_text_buffer *out)
{
    int outside = -1;
    pl_painting painting = {0};
    bool *fallen = calloc((size_t)scene->body_count + 1, sizeof *fallen);
    if (fallen != NULL) {
        mark_fallen(scene, poses, fallen);
        outside = collect(scene, view, poses, fallen, &painting);
    }
    if (outside < 0 || !pl_painting_arrange(&painting, view->width, view->height)) {
        out->failed = true;
        goto cleanup;
    }
    pl_text_format(out,
                   "<svg viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\" role=\"img\">",
                   view->width, view->height, view->width, view->height);
    pl_text_add_element(out, "<title>", title, "</title>");
    for (int i = 0; i < scene->body_count; ++i) {
        if (scene->bodies[i].shape.kind == PL_SHAPE_PLANE) {
            add_plane(&scene->bodies[i].shape, view, out);
        }
    }
    pl_text_format(out, "<use href=\"#%s\"/>", expected_id);
    for (int i = 0; i < painting.count; ++i) {
        add_face(&painting.faces[i], out);
    }
    pl_text_add(out, "</svg>");

cleanup:
    free(painting.faces);
    free(fallen);
    return outside < 0 ? 0 : outside;
}
